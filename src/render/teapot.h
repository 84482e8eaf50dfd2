#pragma once

#include <string_view>

namespace chromeball {

/// data/meshes/teapot.txt.
std::string_view teapot_patches();

}  // namespace chromeball
