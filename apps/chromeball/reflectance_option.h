#pragma once

#include <CLI/App.hpp>

#include <array>
#include <optional>
#include <string>

#include "core/photo.h"
#include "light/reflectance.h"

namespace chromeball {

void add_reflectance_option(CLI::App& command, std::optional<std::string>& text);

/// --reflectance: a number, three, a material's name, or a file that `calibrate` wrote. Throws
/// Error (usage) for what is none of them.
Reflectance parse_reflectance(const std::string& text);

/// Refuses, as Error (usage), to undo a mirror's reflectance in a photo of which that is done.
void check_not_undone(const Photo& photo);

/// One or three numbers, each above 0 and at most 1, of an option. Throws Error (usage).
std::array<double, 3> parse_albedo(const std::string& option, const std::string& text);

/// The option in full, a file's content too, for hashes.
std::string reflectance_words(const std::string& text);

}  // namespace chromeball
