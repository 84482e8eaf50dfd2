#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/watch.h"
#include "detect/grey.h"

namespace chromeball::detecting {

/// Where many edges point at one centre from one distance; pixels of the photo.
struct Seed {
    double x = 0;
    double y = 0;
    double radius = 0;
    double votes = 0;  ///< part of the circle that voted; about 1 for a clean full circle
};

/// Circles that may be there, best first, at all scales from 6.5 pixels of the finest level
/// searched (about 1200 pixels wide) to more than half of the picture; centres may lie outside the
/// picture. With `radii`, only those, pixels of the photo.
std::vector<Seed> find_seeds(const std::vector<Level>& levels,
                             const std::optional<std::array<double, 2>>& radii, const Watch& watch);

}  // namespace chromeball::detecting
