#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/watch.h"
#include "light/response.h"

namespace chromeball {

/// A photo of a bracket and what is known of it.
struct MergePhoto {
    ExposedPhoto photo;
    double exposure = 1;  ///< in any unit, the same for all
    V2d shift{0, 0};      ///< what the merged picture shows at p lies at p + shift here
};

/// Scene-linear light of all exposures together.
struct Merged {
    /// R, G, B in the photos' own primaries, of which 1 fills the scale at exposure 1; and
    /// confidence, 0 to 1: 1 / (1 + (e / 10 %)^2) with e the relative standard deviation of the
    /// luminance; 0 where every exposure clips or is black.
    Image pixels;
    std::size_t clipped_everywhere = 0;  ///< pixels with a channel that is clipped in all
    std::size_t black_everywhere = 0;    ///< pixels that are all noise in the longest
    V2d brightest{0, 0};                 ///< the middle of the largest spot that is clipped in all
    std::size_t brightest_pixels = 0;
    /// Of each photo the part of the picture in which it was left out, since something moved.
    std::vector<double> moved;
};

/// The means of the exposures, weighted by one over the variance of light as the noise model has
/// it; Granados et al.: Optimal HDR Reconstruction with Linear Digital Cameras, 2010.
///
/// Left out, a channel at a time: what is clipped or near it; what is not clipped although the
/// shorter exposures say that it must be (JPEG's ringing and smeared colour beside lamps). Where
/// photos contradict each other, those that most of the others contradict do not count. Where all
/// clip the shortest one's number stands: at least so bright.
Merged merge(std::span<const MergePhoto> photos, const Response& response, const Watch& watch = {});

}  // namespace chromeball
