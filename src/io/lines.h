#pragma once

#include <string>
#include <string_view>

namespace chromeball {

/// Adds one line, with its line end, to a file that is made if need be: in a single write at the
/// end (O_APPEND), so that a killed run leaves whole lines and at most one that is torn. A torn
/// one that an earlier run left is ended first. Throws Error naming the file.
void append_line(const std::string& path, std::string_view line);

/// All of a text file; empty where there is none. Throws Error where it cannot be read.
std::string read_text(const std::string& path);

}  // namespace chromeball
