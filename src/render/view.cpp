#include "render/view.h"

#include <cmath>
#include <numbers>

namespace chromeball {
namespace {

/// From far enough away to be outside of everything, near enough for floats.
constexpr double kFarAway = 100;

}  // namespace

View::View(Size size, const Camera& camera, const V3d& eye, const Rotation& to_world)
    : size_(size), camera_(camera), eye_(eye), to_world_(to_world) {
    const double f = *camera.focal;
    by_x_ = to_world * V3d(1 / f, 0, 0);
    by_y_ = to_world * V3d(0, -1 / f, 0);
    start_ = to_world * V3d(-camera.principal.x / f, camera.principal.y / f, -1);
}

View View::orbit(Size size, double azimuth_degrees, double elevation_degrees, double distance,
                 double fov_degrees, const V3d& target) {
    const Rotation turn = Rotation::yaw_pitch_roll(azimuth_degrees, -elevation_degrees, 0);
    return at(size, target + turn * V3d(0, 0, distance), turn, fov_degrees);
}

View View::at(Size size, const V3d& eye, const Rotation& to_world, double fov_degrees) {
    Camera camera;
    camera.focal = focal_from_hfov(fov_degrees, size.height);
    camera.principal = V2d(0.5 * size.width, 0.5 * size.height);
    return {size, camera, eye, to_world};
}

View View::of_ball(Size size, const Camera& camera, const MirrorBall& ball,
                   const Rotation& to_world) {
    if (!ball.orthographic())
        return {size, camera, to_world * (ball.axis() * -ball.distance()), to_world};
    View view;
    view.size_ = size;
    view.camera_.principal = V2d(ball.outline().cx, ball.outline().cy);
    view.to_world_ = to_world;
    view.eye_ = to_world * V3d(0, 0, kFarAway);
    // Of the photo's offsets from the disk's, the inverse.
    const auto m = ball.from_disk();
    const double det = m[0] * m[3] - m[1] * m[2];
    view.by_x_ = to_world * V3d(m[3] / det, -m[2] / det, 0);
    view.by_y_ = to_world * V3d(-m[1] / det, m[0] / det, 0);
    view.start_ = view.eye_ - view.by_x_ * ball.outline().cx - view.by_y_ * ball.outline().cy;
    return view;
}

Beam View::beam(double x, double y, float step) const {
    Beam beam;
    if (orthographic()) {
        beam.origin = V3f(start_ + by_x_ * x + by_y_ * y);
        beam.direction = V3f(to_world_ * V3d(0, 0, -1));
        beam.origin_x = V3f(by_x_) * step;
        beam.origin_y = V3f(by_y_) * step;
        return beam;
    }
    V3d d = start_ + by_x_ * x + by_y_ * y, by_x = by_x_, by_y = by_y_;
    if (!camera_.distortion.none()) {
        const double f = *camera_.focal;
        const Vec2<Dual> q = with_derivatives(V2d(x, y));
        const Vec2<Dual> p = camera_.distortion.undistorted(
            Vec2<Dual>((q.x - Dual(camera_.principal.x)) * Dual(1 / f),
                       (q.y - Dual(camera_.principal.y)) * Dual(1 / f)));
        d = to_world_ * V3d(p.x.value, -p.y.value, -1);
        by_x = to_world_ * V3d(p.x.du, -p.y.du, 0);
        by_y = to_world_ * V3d(p.x.dv, -p.y.dv, 0);
    }
    const double scale = 1 / d.length();
    d *= scale;
    beam.origin = V3f(eye_);
    beam.direction = V3f(d);
    const double s = scale * static_cast<double>(step);
    beam.direction_x = V3f((by_x - d * d.dot(by_x)) * s);
    beam.direction_y = V3f((by_y - d * d.dot(by_y)) * s);
    return beam;
}

}  // namespace chromeball
