#pragma once

#include <cmath>
#include <vector>

#include "core/outline.h"

namespace chromeball::detecting {

/// What the camera says of the shape of an outline, in the pixels of the picture that is fitted.
struct Lens {
    double focal = 0;
    double principal_x = 0;
    double principal_y = 0;
    bool known = false;  ///< else focal is what is usual, and only a soft hint
    double slack = 0;    ///< ellipticity that may come on top: traces of moving balls are longer

    Lens scaled(double sx, double sy) const {
        return {focal * 0.5 * (sx + sy), principal_x * sx, principal_y * sy, known, slack};
    }
    /// The same with nothing known of it: a slack far more than ellipticities are.
    Lens forgotten() const { return {focal, principal_x, principal_y, false, 1}; }
};

/// An outline in the form that a linear step can change: (e1, e2) is the ellipticity (a-b)/(a+b)
/// times the double angle of the long axis, so that a circle is no special case.
struct Shape {
    double x, y, radius, e1, e2;
};

inline double radius(const Outline& o) { return std::sqrt(o.a * o.b); }

inline Outline scaled(const Outline& o, double sx, double sy) {
    const double s = 0.5 * (sx + sy);  // the two differ by the rounding of a level's size only
    return {o.cx * sx, o.cy * sy, o.a * s, o.b * s, o.angle};
}

Shape shape_of(const Outline& outline);
Outline outline_of(const Shape& shape);

/// A point of the rim, its outward normal and its direction from the centre as a double angle.
struct Ray {
    double x, y, nx, ny, cos2, sin2;
};

std::vector<Ray> rays_of(const Outline& outline, int count);

/// Ellipticity that the lens gives an outline there, and how far from it one may be, along the
/// line from the principal point and across it.
struct ShapePrior {
    double e1, e2, along, across, cos2, sin2;
};

ShapePrior prior_at(const Shape& shape, const Lens& lens);

}  // namespace chromeball::detecting
