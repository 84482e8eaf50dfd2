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
    // Of what was looked at along the motion, on either side, means:
    double evidence = 0;  ///< log-likelihood of the smeared rim right there over no rim at all,
    double ends = 0;      ///< over a moving ball that goes on there;
    double clear = 0;     ///< part that shows a smeared rim,
    double amiss = 0;     ///< part that shows it elsewhere,
    double known = 0;     ///< part that lies in the picture
    /// Log-likelihood of the outline over the likeliest of those that are off by 2 % of the radius.
    double certain = 0;
};

/// The outline near a first one that is wrong by up to some 10 % of its radius, and the motion near
/// a first guess of it, wrong by some 10 % of its length and some 10 degrees.
///
/// level   of the picture, on which the ball's radius is 40 to 80 pixels
/// least   evidence without which the search is given up early
MotionFit fit_motion(const Grey& picture, const Level& level, const Outline& start,
                     const V2d& motion, const Lens& lens, double least);

}  // namespace chromeball::detecting
