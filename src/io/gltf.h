#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chromeball {

/// The files that a glTF file keeps its points in: paths, of `text`, which is what the file at
/// `path` holds. None for other formats, whose files hold their own.
std::vector<std::string> gltf_buffers(const std::string& path, std::string_view text);

}  // namespace chromeball
