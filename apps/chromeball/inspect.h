#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "color/color.h"
#include "report.h"

namespace chromeball {

/// Measures a map for `info`. `from` names its layout; without it that is guessed. Throws Error.
InfoReport inspect(const std::string& path, const std::optional<std::string>& from,
                   std::int64_t max_pixels, const ColorConfig& colors,
                   const std::optional<std::string>& input_space);

}  // namespace chromeball
