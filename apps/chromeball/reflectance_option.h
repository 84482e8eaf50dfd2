#pragma once

#include <array>
#include <string>

#include "light/reflectance.h"

namespace chromeball {

/// --reflectance: a number, three, a material's name, or a file that `calibrate` wrote. Throws
/// Error (usage) for what is none of them.
Reflectance parse_reflectance(const std::string& text);

/// One or three numbers, each above 0 and at most 1, of an option. Throws Error (usage).
std::array<double, 3> parse_albedo(const std::string& option, const std::string& text);

/// The option in full, a file's content too, for hashes.
std::string reflectance_words(const std::string& text);

}  // namespace chromeball
