#pragma once

#include "core/outline.h"
#include "detect/grey.h"
#include "detect/shape.h"
#include "map/camera.h"

namespace chromeball::detecting {

/// A ball that moved evenly while the shutter was open.
struct MotionFit {
    Outline outline;  ///< in the middle of the exposure
    V2d motion;       ///< from one end to the other, pixels of the picture; its sign is open
    /// Log-likelihood of the smeared rim over no rim at all, mean over what was looked at.
    double evidence = 0;
    double clear = 0;  ///< part of what was looked at that shows a smeared rim right there
    double known = 0;  ///< part of what was to be looked at that lies in the picture
};

/// The outline near a first one that is wrong by up to some 10 % of its radius, and the motion near
/// a first guess of it, wrong by some 10 % of its length and some 10 degrees.
///
/// level   of the picture, on which the ball's radius is 40 to 80 pixels
/// least   evidence without which the search is given up early
MotionFit fit_motion(const Grey& picture, const Level& level, const Outline& start,
                     const V2d& motion, const Lens& lens, double least);

}  // namespace chromeball::detecting
