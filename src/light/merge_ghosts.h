#pragma once

#include <span>
#include <vector>

#include "core/watch.h"
#include "light/merge.h"

namespace chromeball {

/// How much each photo may count where something moved, on a coarse grid.
struct GhostMap {
    int cell = 8;  ///< pixels
    Size size;     ///< cells
    /// Of each photo, row by row: 1 where it may count, 0 where it contradicts the others.
    std::vector<std::vector<float>> allowed;

    /// Bilinear between the cells' middles; x, y continuous pixels.
    float at(std::size_t photo, double x, double y) const;
    /// The same for a row of pixels.
    void row(std::size_t photo, int y, std::span<float> out) const;
    /// Whether a photo counts everywhere.
    bool always(std::size_t photo) const;
};

/// Cells in which photos contradict each other by more than noise, rounding, and what a shift of a
/// fraction of a pixel makes; joined to regions. In each cell the photo that most others contradict
/// is left out, until none is; between equals the region decides. (Gallo et al.: Artifact-free High
/// Dynamic Range Imaging, 2009, by patches, without a reference chosen by hand.)
/// `photos` from the shortest exposure to the longest.
GhostMap find_ghosts(std::span<const MergePhoto> photos, const Response& response,
                     const Watch& watch = {});

}  // namespace chromeball
