#pragma once

#include <array>
#include <vector>

#include "light/view.h"

namespace chromeball {

using ViewSamples = std::vector<ViewPyramid::Sample>;

/// What a view shows in directions of the world, averaged over `angle` radians; one a direction.
ViewSamples sampled(const ViewPyramid& view, const std::vector<V3d>& world,
                    const Rotation& to_world, double angle);

/// What two views differ by: their median difference, and how the rest spreads; of directions that
/// both show.
struct ViewSpread {
    std::array<double, 3> offset{};
    double scale = 0;  ///< 1.4826 times the median magnitude: a Gaussian's standard deviation
};
ViewSpread spread_of(const ViewSamples& a, const ViewSamples& b);

}  // namespace chromeball
