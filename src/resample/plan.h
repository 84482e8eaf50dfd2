#pragma once

#include <optional>
#include <vector>

#include "resample/kernel.h"
#include "resample/resample.h"

namespace chromeball {

/// A tile, and where its cell stands in the picture.
struct PlannedTile {
    kernel::Tile tile;  ///< without its output
    int cell_x = 0, cell_y = 0;
};

/// A conversion as the vector kernels take it.
struct Plan {
    kernel::Job job;
    std::vector<PlannedTile> tiles;
};

/// Points into the source. Nothing where only the scalar reference can do it: a target that is a
/// ball in a photo, or pictures too large for 32-bit numbers of pixels.
std::optional<Plan> plan_of(const Source& source, const Layout& layout, int size,
                            const ResampleOptions& options);

}  // namespace chromeball
