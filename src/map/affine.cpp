#include "map/affine.h"

#include <cmath>
#include <numbers>

namespace chromeball {

Affine Affine::inverse() const {
    const double det = determinant();
    Affine inverse{yy / det, -xy / det, 0, -yx / det, xx / det, 0};
    inverse.x0 = -(inverse.xx * x0 + inverse.xy * y0);
    inverse.y0 = -(inverse.yx * x0 + inverse.yy * y0);
    return inverse;
}

Affine crop_of(const Outline& outline, int size) {
    const double turn = outline.angle * std::numbers::pi / 180;
    const double c = std::cos(turn), s = std::sin(turn), half = 0.5 * size;
    const double a = half / outline.a, b = half / outline.b;
    Affine crop{a * c * c + b * s * s, (a - b) * c * s,       0,
                (a - b) * c * s,       a * s * s + b * c * c, 0};
    crop.x0 = half - crop.xx * outline.cx - crop.xy * outline.cy;
    crop.y0 = half - crop.yx * outline.cx - crop.yy * outline.cy;
    return crop;
}

}  // namespace chromeball
