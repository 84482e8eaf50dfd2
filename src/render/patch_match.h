#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/image.h"

namespace chromeball {

/// A place of a grid.
struct GridPlace {
    int x = 0, y = 0;
    bool operator==(const GridPlace&) const = default;
};

/// A picture with a hole.
struct Holed {
    Image look;              ///< what patches are compared by; any number of channels, about 0 to 1
    std::vector<char> hole;  ///< of each pixel: whether nothing is known there

    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(look.width()) +
               static_cast<std::size_t>(x);
    }
};

/// Gives pixels of a hole what lies around it: means, the nearer the finer, without an edge.
void fill_smoothly(Holed& picture);

/// For each pixel of a hole and around it the place outside of the hole that it should look like,
/// so that every patch of 7 x 7 pixels is like one of the known ones; nothing where the question
/// does not arise, or where no whole patch is known. Coarse to fine; the same for any machine.
///
/// Wexler, Shechtman, Irani: Space-Time Completion of Video, 2007; the search after Barnes et al.:
/// PatchMatch, 2009. Costs some 20 microseconds for a pixel of the hole, less of large ones.
std::vector<std::optional<GridPlace>> likest_places(Holed picture);

}  // namespace chromeball
