#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "map/mirror_ball.h"
#include "support/directions.h"

namespace chromeball {

/// A ball `distance` radii away, its centre `off` degrees from the optical axis and turned by
/// `around` degrees from the photo's right towards its up.
inline Cone cone_at(double distance, double off = 0, double around = 0) {
    return {off_axis(radians(off), radians(around)), std::asin(1 / distance)};
}

/// A pinhole without a lens' faults.
inline Camera pinhole(double focal, V2d principal) {
    Camera camera;
    camera.focal = focal;
    camera.principal = principal;
    return camera;
}

/// A camera that sees a ball on its axis, `distance` radii away, with that radius in pixels.
inline Camera camera_for(double distance, double radius, V2d principal) {
    return pinhole(radius * std::sqrt(distance * distance - 1), principal);
}

struct NamedBall {
    std::string name;
    MirrorBall ball;
};

/// Balls in photos of some hundred pixels: distant and near, in the middle and far off it.
inline std::vector<NamedBall> balls_in_photos() {
    const V2d principal(320, 240);
    const auto near = [&](double distance, double off, double around) {
        return MirrorBall(camera_for(distance, 150, principal), cone_at(distance, off, around));
    };
    return {{"the unit square", MirrorBall()},
            {"distant circle", MirrorBall({300.3, 200.7, 150, 150, 0})},
            {"distant ellipse", MirrorBall({300.3, 200.7, 150, 120, 30})},
            {"D = 1.2 on the axis", near(1.2, 0, 0)},
            {"D = 2 off the axis", near(2, 20, 130)},
            {"D = 4 on the axis", near(4, 0, 0)},
            {"D = 6 far off the axis", near(6, 40, -70)},
            {"D = 20 off the axis", near(20, 10, 200)},
            {"D = 1000 off the axis", near(1000, 5, 45)}};
}

/// The direction that a photo position shows, by straightforward tracing of the camera's ray:
/// p = t q, t = q.C - sqrt((q.C)^2 - |C|^2 + 1), n = p - C, r = q - 2 (q.n) n.
inline std::optional<V3d> traced(const Camera& camera, const Cone& cone, V2d position) {
    const V3d q = V3d((position.x - camera.principal.x) / *camera.focal,
                      (camera.principal.y - position.y) / *camera.focal, -1)
                      .normalized();
    const V3d C = cone.axis * cone.distance();
    const double room = q.dot(C) * q.dot(C) - C.length2() + 1;
    if (room < 0 || q.dot(C) < 0) return std::nullopt;
    const V3d n = q * (q.dot(C) - std::sqrt(room)) - C;
    return q - n * (2 * q.dot(n));
}

}  // namespace chromeball
