#pragma once

#include <cstddef>
#include <span>

#include "core/photo.h"

namespace chromeball::io {

/// Floats as a stored type: integers from 0 to 1 rounded to the nearest, half floats to the nearest
/// or even. The values fit the type; `out` has room for all.
void store(std::span<const float> values, PixelType type, std::byte* out);

}  // namespace chromeball::io
