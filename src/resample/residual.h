#pragma once

#include "core/image.h"

namespace chromeball {

/// How far a ball painted again is from the photo it came from.
struct Residual {
    double median_stops = 0;  ///< of |log2(painted / photo)| over the ball's pixels
    double p95_stops = 0;
    std::size_t pixels = 0;  ///< compared
    /// RGB to look at, 0 to 1: grey where they agree, red where the painted ball is brighter, blue
    /// where it is darker, saturated at one stop; black outside. A wrong outline or camera shows as
    /// rings.
    Image picture;
};

/// photo: the part of the photo that `painted` shows, 3 or 4 channels; painted: RGBA from
/// render_ball. Luminances below 1 % of the ball's mean count as that much, since noise has no
/// stops. Only pixels that are wholly ball are compared.
Residual residual_of(const Image& photo, const Image& painted);

}  // namespace chromeball
