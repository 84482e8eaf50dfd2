#pragma once

#include <string_view>

namespace chromeball {

/// The text of data/chromeball.ocio, put into the program when it is built.
std::string_view built_in_config_text();

}  // namespace chromeball
