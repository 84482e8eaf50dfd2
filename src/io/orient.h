#pragma once

#include <optional>
#include <utility>

#include "core/photo.h"

namespace chromeball::io {

/// Turns and mirrors a photo as stored into the upright one, for the EXIF orientations 1 to 8
/// (others count as 1): pixels, window and display window.
void make_upright(Photo& photo, int orientation);

/// Whether width and height change places.
bool turns_by_90(int orientation);

/// The stored rows that hold the given rows of the upright picture; nothing (that is: all) where
/// these are stored as columns.
std::optional<std::pair<int, int>> stored_rows(const std::optional<std::pair<int, int>>& rows,
                                               int orientation, int stored_height);

}  // namespace chromeball::io
