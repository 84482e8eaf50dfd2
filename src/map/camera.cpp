#include "map/camera.h"

#include <Imath/ImathMatrix.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace chromeball {
namespace {

using std::numbers::pi;

/// Two unit vectors that make a right-handed frame with a unit vector.
struct Frame {
    V3d e1, e2, axis;
    explicit Frame(V3d along) : axis(along) {
        const V3d other = std::abs(along.x) < 0.7 ? V3d(1, 0, 0) : V3d(0, 1, 0);
        e1 = other.cross(along).normalized();
        e2 = along.cross(e1);
    }
};

/// One point of the rim in the plane that touches the unit sphere at the frame's axis, with how
/// that plane's coordinates change per pixel.
struct RimRay {
    double x, y;    // in the tangent plane
    double excess;  // sqrt(1 + x^2 + y^2) - 1, without cancellation
    V2d dx, dy;     // by photo x and y
};

RimRay rim_ray(V2d p, const Camera& camera, const Frame& frame) {
    const double f = *camera.focal;
    const V3d q((p.x - camera.principal.x) / f, (camera.principal.y - p.y) / f, -1);
    const double depth = q.dot(frame.axis);
    RimRay ray{};
    ray.x = q.dot(frame.e1) / depth;
    ray.y = q.dot(frame.e2) / depth;
    const double square = ray.x * ray.x + ray.y * ray.y;
    ray.excess = square / (1 + std::sqrt(1 + square));
    // dq/dx = (1/f, 0, 0), dq/dy = (0, -1/f, 0)
    const double scale = 1 / (f * depth);
    ray.dx = V2d(frame.e1.x - ray.x * frame.axis.x, -(frame.e1.y - ray.x * frame.axis.y)) * scale;
    ray.dy = V2d(frame.e2.x - ray.y * frame.axis.x, -(frame.e2.y - ray.y * frame.axis.y)) * scale;
    return ray;
}

V3d ray_through(V2d p, const Camera& camera) {
    return V3d((p.x - camera.principal.x) / *camera.focal,
               (camera.principal.y - p.y) / *camera.focal, -1)
        .normalized();
}

}  // namespace

double Cone::distance() const { return 1 / std::sin(half_angle); }

double focal_from_sensor(double focal_mm, double sensor_width_mm, int picture_width) {
    return focal_mm / sensor_width_mm * picture_width;
}

double focal_from_hfov(double hfov_degrees, int picture_width) {
    return 0.5 * picture_width / std::tan(hfov_degrees * pi / 360);
}

V2d rim_point(const Outline& outline, double t) {
    const double turn = outline.angle * pi / 180;
    const double u = outline.a * std::cos(t), v = outline.b * std::sin(t);
    return {outline.cx + u * std::cos(turn) - v * std::sin(turn),
            outline.cy + u * std::sin(turn) + v * std::cos(turn)};
}

std::optional<Outline> outline_of(const Cone& cone, const Camera& camera) {
    const double side = std::hypot(cone.axis.x, cone.axis.y);
    const double psi = std::atan2(side, -cone.axis.z);
    const double sin_rho = std::sin(cone.half_angle), cos_rho = std::cos(cone.half_angle);
    const double den = std::cos(psi) * std::cos(psi) - sin_rho * sin_rho;
    if (!camera.focal || psi >= pi / 2 || !(den > 0)) return std::nullopt;

    const double away = side > 0 ? std::atan2(-cone.axis.y, cone.axis.x) : 0;  // y down
    const double offset = *camera.focal * std::sin(psi) * std::cos(psi) / den;
    Outline outline;
    outline.cx = camera.principal.x + offset * std::cos(away);
    outline.cy = camera.principal.y + offset * std::sin(away);
    outline.a = *camera.focal * sin_rho * cos_rho / den;
    outline.b = *camera.focal * sin_rho / std::sqrt(den);
    outline.a = std::max(outline.a, outline.b);  // equal on the axis, up to rounding
    outline.angle = std::fmod(away * 180 / pi + 360, 180);
    return outline;
}

Cone cone_of(const Outline& outline, const Camera& camera) {
    // A ray q lies on the cone if q.w = |q| with w = axis / cos(half_angle). In the plane that
    // touches the sphere in the ellipse's middle this is wx x + wy y + d = excess with d = wz - 1:
    // linear, and well conditioned however small the ball is.
    constexpr int kPoints = 72;
    const Frame frame(ray_through({outline.cx, outline.cy}, camera));
    RimRay rays[kPoints];
    double scale = 0;
    for (int i = 0; i < kPoints; ++i) {
        rays[i] = rim_ray(rim_point(outline, 2 * pi * i / kPoints), camera, frame);
        scale = std::max(scale, std::hypot(rays[i].x, rays[i].y));
    }
    // Distances in pixels are the equation's error over its gradient; weighted so in a few rounds.
    V3d w(0, 0, 0);
    for (int round = 0; round < 4; ++round) {
        Imath::M33d normal(0.0);
        V3d right(0, 0, 0);
        for (const RimRay& ray : rays) {
            double weight = 1;
            if (round > 0) {
                const double root = 1 + ray.excess;
                const V2d gradient = ray.dx * (w.x - ray.x / root) + ray.dy * (w.y - ray.y / root);
                weight = 1 / std::max(gradient.length2(), 1e-300);
            }
            const double row[3] = {ray.x / scale, ray.y / scale, scale};
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) normal[i][j] += weight * row[i] * row[j];
                right[i] += weight * row[i] * ray.excess;
            }
        }
        const V3d solved = right * normal.inverse();  // the matrix is symmetric
        w = V3d(solved.x / scale, solved.y / scale, solved.z * scale);
    }
    Cone cone;
    cone.axis = (frame.e1 * w.x + frame.e2 * w.y + frame.axis * (1 + w.z)).normalized();
    const double tangent2 = w.x * w.x + w.y * w.y + 2 * w.z + w.z * w.z;  // |w|^2 - 1
    cone.half_angle = std::atan(std::sqrt(std::max(tangent2, 0.0)));
    return cone;
}

std::optional<double> focal_from_distance(const Outline& outline, V2d principal, double distance) {
    if (!(distance > 1)) return std::nullopt;
    const auto miss = [&](double log_focal) {
        const Camera camera{std::exp(log_focal), principal};
        return cone_of(outline, camera).half_angle - std::asin(1 / distance);
    };
    // The half-angle falls as the focal length grows: bisect, from where a ball on the axis would
    // be.
    const double start =
        std::log(std::sqrt(outline.a * outline.b) * std::sqrt(distance * distance - 1));
    double low = start - 3, high = start + 3;
    if (!(miss(low) > 0) || !(miss(high) < 0)) return std::nullopt;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (miss(middle) > 0 ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
}

double rim_deviation(const Outline& one, const Outline& other) {
    const double turn = other.angle * pi / 180, c = std::cos(turn), s = std::sin(turn);
    double largest = 0;
    for (int i = 0; i < 72; ++i) {
        const V2d p = rim_point(one, 2 * pi * i / 72) - V2d(other.cx, other.cy);
        const double u = (p.x * c + p.y * s) / other.a, v = (p.y * c - p.x * s) / other.b;
        // First-order distance from the conic u^2 + v^2 = 1: its value over its gradient.
        const double gradient = 2 * std::hypot(u / other.a, v / other.b);
        largest = std::max(largest, std::abs(u * u + v * v - 1) / gradient);
    }
    return largest;
}

}  // namespace chromeball
