#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "light/ball_picture.h"
#include "light/clipped_regions.h"

namespace chromeball {

struct GreyBallOptions {
    /// What a perfect diffuser of it gives back; known to the one who painted the ball.
    std::array<double, 3> reflectance{0.18, 0.18, 0.18};
    /// Its reflectance is found, too, from its side that the clipped regions do not light.
    bool solve_reflectance = false;
};

/// What the grey ball says that the mirror ball does not.
struct GreyBallFit {
    std::vector<ClippedRegion> regions;   ///< largest first
    std::array<double, 3> reflectance{};  ///< as given, or solved
    std::array<double, 3> irradiance{};   ///< missing light: sum of radiance times steradians
    double residual = 0;                  ///< rms of grey ball less its picture, of its mean
    double residual_before = 0;           ///< the same with no light added
    std::size_t pixels = 0;               ///< of the grey ball that were compared
};

/// Debevec, Tchou, Gardner, et al.: Estimating Surface Reflectance Properties of a Complex Scene
/// under Captured Natural Illumination, 2004, section on clipped suns, after Debevec 2003: a
/// diffuse ball beside the probe is lit by what the probe shows plus, from the directions where it
/// clips, light in unknown amounts. Its pixels are reflectance / pi times irradiance, linear in
/// those amounts: least squares, none of them negative, in as few regions as explain it, with
/// little weight for what does not fit (shadows, the stand).
///
/// Each ball stands before the other (ball_beside()): what the mirror ball hides does not light the
/// grey one, and what it throws there in its place, a part of what a perfect mirror would, is
/// solved with the rest; where that would be more than 5 % of the light, places do not count. What
/// the grey ball hides from the mirror ball is taken to be as bright as what lies around it: a sun
/// that is half behind it is found whole, in the pixels that show its other half. A region that
/// explains less than 1 % of what the grey ball shows gets nothing: paint and noise would ask for
/// as much.
///
/// mirror    reflectance undone, clipped pixels at their clipped value or what is known to be there
/// clipped   one value a pixel of mirror.pixels, not 0 where it clips
/// grey      its clipped or dark pixels do not count
/// usable    one value a pixel of grey.pixels, 0 where it must not be used
GreyBallFit solve_missing_light(const BallPicture& mirror, const std::vector<char>& clipped,
                                const BallPicture& grey, const std::vector<char>& usable,
                                const GreyBallOptions& options = {});

/// Adds the missing light to the pixels of its regions.
void add_missing_light(Image& pixels, const GreyBallFit& fit);

/// What a mirror ball says of the irradiance of a surface, reflectance 1; W / m^2 in the units of
/// its picture.
std::array<double, 3> irradiance_from(const BallPicture& mirror, V3d normal);

}  // namespace chromeball
