#pragma once

#include <span>
#include <vector>

#include "core/watch.h"
#include "light/view.h"

namespace chromeball {

/// Rotations that may take the frame of `free` to that of `fixed`, the likeliest first: all of
/// SO(3) is tried in steps of 5 degrees on coarse pictures, and the best ones that lie apart are
/// given.
///
/// No feature points: what two cameras around a ball both see lies near the rim of at least one of
/// them, where a pixel is drawn out many times along one direction and hardly across, so that
/// patches of the same thing do not look alike, and blank walls or a few lamps give none at all.
/// The light itself, averaged over 5 degrees, is the same in both views and enough to tell 150 000
/// rotations apart; there is no other minimum to be caught in, since all are tried, and it costs
/// less than a second. Views of different places are known by align_views()' agreement.
std::vector<Rotation> likely_rotations(const ViewPyramid& fixed, const ViewPyramid& free, int most,
                                       const Watch& watch = {});

/// Correlation of two views' samples over what both show, by weight: of their deviations from their
/// means, over the three channels, -1 to 1.
double correlation(std::span<const ViewPyramid::Sample> a, std::span<const ViewPyramid::Sample> b);

}  // namespace chromeball
