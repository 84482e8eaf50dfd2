#pragma once

#include <vector>

#include "resample/kernel.h"
#include "resample/source.h"

namespace chromeball {

/// Pixels, next to each other, that outshine the rest of a picture: what of them exceeds the pixels
/// around, whose even light the filter keeps anyway.
struct Spot {
    /// And what the border repeats of them, by rising numbers.
    std::vector<kernel::LitPixel> pixels;
    int left = 0, top = 0, right = 0, bottom = 0;  ///< first and last of source.pixels
    V3d light{0, 0, 0};  ///< colour times the pixels' own solid angles, summed up
};

/// All of a source's, from top to bottom. A pixel belongs to one if it holds more than a part of
/// all light, in any channel, that is larger than kLeastShare and than kLeastExcess times a pixel's
/// mean.
///
/// Left out are pixels that are not shown by themselves: at a ball's rim, whose light is drawn from
/// several, beside others that must not be used and at the photo's edge; and within four pixels of
/// an angular map's edge.
std::vector<Spot> spots_of(const Source& source);

namespace spots {

/// Taps two thirds of a pixel apart see a pixel as 8/9 to 10/9 of itself in each of two directions,
/// 0.11 rms where they are that far apart everywhere, 0.03 in the mean of conversions. Of n such
/// pixels that hold all light the sum is off by a part of that, one in sqrt(n): of those that are
/// too weak to be looked at by 0.05 %. More of them would cost more: 15 microseconds each.
constexpr double kLeastShare = 1.0 / 4096;
/// In a small picture that would be most of the pixels: so few at most, one in eight.
constexpr double kLeastExcess = 8;
/// Larger spots are taken in parts.
constexpr int kMostAcross = 16;

}  // namespace spots

/// The direction that a place in source.pixels shows; of a cube, on the plane of the face whose
/// pixel (x, y) is near by. Nothing beyond a ball's rim or an angular map's edge.
std::optional<V3d> direction_at(const Source& source, int y, V2d place);

}  // namespace chromeball
