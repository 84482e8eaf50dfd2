#pragma once

#include <array>
#include <vector>

#include "light/ball_beside.h"
#include "light/ball_picture.h"

namespace chromeball {

/// A part of the grey ball: its normal and the mean of what it shows.
struct GreyFacet {
    V3d normal{0, 0, 0};
    std::array<double, 3> shown{};
    int pixels = 0;
};

/// Means over small squares of the grey ball's inside, 40 across it. Without its rim, and without
/// what faces the mirror ball beside it so that this hides more than 5 % of an even light.
///
/// usable   one value a pixel of grey.pixels, 0 where it must not be used
/// mirror   as it stands beside the grey ball
std::vector<GreyFacet> grey_facets(const BallPicture& grey, const std::vector<char>& usable,
                                   const BallBeside& mirror);

}  // namespace chromeball
