#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace chromeball::io {

/// Throws Error when nothing can be written there: a folder, a missing folder, no permission. Asked
/// before the work of encoding.
void check_target(const std::string& path);

/// Puts a file there whole or not at all: writes `.NAME.part` beside it, then renames. On failure
/// what was there before stays as it was, and nothing else is left behind.
void write_whole_file(const std::string& path, std::span<const std::byte> bytes);

}  // namespace chromeball::io
