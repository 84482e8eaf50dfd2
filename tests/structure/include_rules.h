#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chromeball::structure {

/// What a file includes, in its order: names with their brackets or quotation marks.
std::vector<std::string> includes_of(std::string_view text);

/// What a file does against the architecture, a sentence each.
///
/// path   below the top folder, as "src/map/cube.cpp"; decides the folder
/// text   the file's text
std::vector<std::string> violations(const std::string& path, std::string_view text);

}  // namespace chromeball::structure
