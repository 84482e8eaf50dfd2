#pragma once

#include <optional>

#include "light/log_raster.h"

namespace chromeball {

/// How one photo lies on another: what the reference shows at p, the other shows at p + shift.
struct ShiftFit {
    V2d shift{0, 0};       ///< pixels
    double deviation = 0;  ///< standard deviation of the shift, pixels
    double likeness = 0;   ///< of what both show there: a correlation, -1 to 1
};

/// Lucas and Kanade: An Iterative Image Registration Technique, 1981, from coarse to fine, with
/// little weight for what does not fit. Nothing where the photos share too little.
///
/// hint     a shift known beforehand to a few pixels; none: shifts up to a sixth of the picture's
///          longer side are tried
/// factor   pixels of the photos to one of the pyramids' finest level; shifts are in the photos'
std::optional<ShiftFit> fit_shift(const LogPyramid& reference, const LogPyramid& other,
                                  std::optional<V2d> hint, int factor);

}  // namespace chromeball
