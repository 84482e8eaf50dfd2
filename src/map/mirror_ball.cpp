#include "map/mirror_ball.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace chromeball {

MirrorBall::MirrorBall(const Outline& outline) : outline_(outline) {
    // Stretched along the ellipse's axes, not turned, so that the photo's right and up stay so.
    const double turn = outline.angle * std::numbers::pi / 180;
    const double c = std::cos(turn), s = std::sin(turn);
    const auto stretch = [&](double a, double b, double(&m)[4]) {
        m[0] = a * c * c + b * s * s;
        m[1] = (a - b) * c * s;
        m[2] = m[1];
        m[3] = a * s * s + b * c * c;
    };
    stretch(1 / outline.a, 1 / outline.b, to_disk_);
    stretch(outline.a, outline.b, from_disk_);
    // t points up, the photo's y down.
    to_disk_[2] = -to_disk_[2];
    to_disk_[3] = -to_disk_[3];
    from_disk_[1] = -from_disk_[1];
    from_disk_[3] = -from_disk_[3];
}

MirrorBall::MirrorBall(const Camera& camera, const Cone& cone)
    : orthographic_(false),
      outline_(outline_of(cone, camera).value_or(Outline{})),
      axis_(cone.axis),
      distance_(cone.distance()),
      half_angle_(cone.half_angle),
      curved_cosine_(std::min(kCos30, std::cos(cone.half_angle + 0.2))),  // 0.2: 11 degrees
      focal_(camera.focal.value()),
      principal_(camera.principal),
      distortion_(camera.distortion) {
    assert(outline_.b > 0);
}

double MirrorBall::distance() const {
    return orthographic_ ? std::numeric_limits<double>::infinity() : distance_;
}

double MirrorBall::solid_angle(V2d position) const {
    if (!to_direction(position)) return 0;
    // Of the distant ball one unit of disk area shows 4 sr, everywhere.
    if (orthographic_) return 4 / (outline_.a * outline_.b);
    return solid_angle_from_jacobian(*this, position);
}

double MirrorBall::view_ratio(double v) const {
    const double theta = 2 * std::acos(std::min(v, 1.0));
    const double sine = std::sqrt(std::max(0.0, 1 - v * v));
    if (sine < 1e-9) return 2 / (2 * distance_ - 1);
    const double f = normal_angle(theta);
    return std::sin(f) / (distance_ - std::cos(f)) / sine;
}

double MirrorBall::reflection_slope(double f) const {
    const double c = distance_ * std::cos(f);
    return 2 + (c - 1) / (distance_ * distance_ - 2 * c + 1);
}

double MirrorBall::normal_angle(double theta) const {
    const double limit = std::numbers::pi / 2 - half_angle_;
    double f = std::min(theta / 2, limit);
    for (int step = 0; step < 8; ++step) {  // Newton; at most 6 steps to 4e-16
        const double miss = 2 * f + std::atan2(std::sin(f), distance_ - std::cos(f)) - theta;
        f = std::clamp(f - miss / reflection_slope(f), 0.0, limit);
        if (std::abs(miss) < 1e-15) break;
    }
    return f;
}

}  // namespace chromeball
