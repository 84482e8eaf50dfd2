#pragma once

#include "core/outline.h"
#include "map/dual.h"

namespace chromeball {

/// x' = xx x + xy y + x0, y' = yx x + yy y + y0: from one image's pixels to another's.
struct Affine {
    double xx = 1, xy = 0, x0 = 0;
    double yx = 0, yy = 1, y0 = 0;

    template <class T>
    Vec2<T> operator()(const Vec2<T>& p) const {
        return {T(xx) * p.x + T(xy) * p.y + T(x0), T(yx) * p.x + T(yy) * p.y + T(y0)};
    }
    Affine inverse() const;
    /// Of what a square of area 1 becomes; below 0 where it is mirrored.
    double determinant() const { return xx * yy - xy * yx; }
};

inline Affine shift(double dx, double dy) { return {1, 0, dx, 0, 1, dy}; }
inline Affine scale(double sx, double sy) { return {sx, 0, 0, 0, sy, 0}; }

/// From a photo to the ball cut out: the outline becomes the circle inscribed in a square of `size`
/// pixels, stretched along its axes without turning, so that up stays up.
Affine crop_of(const Outline& outline, int size);

}  // namespace chromeball
