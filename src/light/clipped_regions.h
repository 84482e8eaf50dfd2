#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "light/ball_picture.h"
#include "light/rays.h"

namespace chromeball {

/// One connected part of the sphere in which the mirror ball clips.
struct ClippedRegion {
    V3d direction{0, 0, 1};  ///< of its middle
    double steradians = 0;
    std::array<double, 3> missing{};  ///< radiance on top of what the pixels hold
    std::vector<std::size_t> pixels;  ///< y * width + x in the mirror ball's picture
};

/// The clipped pixels that touch each other, as regions, the largest first. A diffuse ball blurs
/// what lies closer together than 20 degrees, so such regions become one; so do all but the largest
/// six, each with the one nearest to it.
///
/// clipped   one value a pixel of mirror.pixels, not 0 where it clips
std::vector<ClippedRegion> clipped_regions(const BallPicture& mirror, std::vector<char> clipped);

/// Radiance 1 from all pixels of a region, not from its middle alone.
Rays region_rays(const BallPicture& mirror, const ClippedRegion& region);

}  // namespace chromeball
