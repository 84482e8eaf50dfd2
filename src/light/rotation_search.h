#pragma once

#include <span>
#include <vector>

#include "core/watch.h"
#include "light/view.h"

namespace chromeball {

/// Rotations that may take the frame of `free` to that of `fixed`, the likeliest first: all of
/// SO(3) is tried in steps of 5 degrees on coarse pictures, and the best ones that lie apart are
/// given.
std::vector<Rotation> likely_rotations(const ViewPyramid& fixed, const ViewPyramid& free, int most,
                                       const Watch& watch = {});

/// Correlation of two views' samples over what both show, by weight: of their deviations from their
/// means, over the three channels, -1 to 1.
double correlation(std::span<const ViewPyramid::Sample> a, std::span<const ViewPyramid::Sample> b);

}  // namespace chromeball
