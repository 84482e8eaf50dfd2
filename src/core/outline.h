#pragma once

#include <numbers>

namespace chromeball {

/// The ball's outline in a photo: an ellipse in continuous pixel coordinates of the upright display
/// window.
///
/// (0, 0) is the top-left corner of the top-left pixel, y points down. a >= b are the semi-axes;
/// angle is the direction of the long one in degrees from +x towards +y (down), in [0, 180). A
/// circle has a == b and angle 0.
struct Outline {
    double cx = 0;
    double cy = 0;
    double a = 0;
    double b = 0;
    double angle = 0;

    bool operator==(const Outline&) const = default;
};

/// The outline's area, square pixels.
inline double area(const Outline& outline) { return std::numbers::pi * outline.a * outline.b; }

}  // namespace chromeball
