#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "color/color.h"
#include "core/photo.h"
#include "map/layouts.h"
#include "report.h"

namespace chromeball {

/// The layout that a picture probably has.
struct LayoutGuess {
    const Layout* layout = nullptr;  ///< nullptr: none, or not known
    std::string sureness;
};
/// From what the file says of itself and its shape; crosses and disks only where there are pixels
/// to look at.
LayoutGuess guess_layout(const Photo& photo, const Image* pixels);

/// Measures a map for `info`. `from` names its layout; without it that is guessed. Throws Error.
InfoReport inspect(const std::string& path, const std::optional<std::string>& from,
                   std::int64_t max_pixels, const ColorConfig& colors,
                   const std::optional<std::string>& input_space);

}  // namespace chromeball
