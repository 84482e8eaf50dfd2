#include "map/camera.h"

#include <Imath/ImathMatrix.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

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
    const Vec2<Dual> seen((with_derivatives(p).x - Dual(camera.principal.x)) * Dual(1 / f),
                          (with_derivatives(p).y - Dual(camera.principal.y)) * Dual(1 / f));
    const Vec2<Dual> pinhole = camera.distortion.undistorted(seen);
    const Vec3<Dual> q(pinhole.x, -pinhole.y, Dual(-1));
    const Dual depth = along(q, frame.axis);
    const Dual x = along(q, frame.e1) / depth, y = along(q, frame.e2) / depth;
    const double square = x.value * x.value + y.value * y.value;
    return {x.value, y.value, square / (1 + std::sqrt(1 + square)), V2d(x.du, x.dv),
            V2d(y.du, y.dv)};
}

V3d ray_through(V2d p, const Camera& camera) {
    const V2d pinhole = camera.distortion.undistorted((p - camera.principal) / *camera.focal);
    return V3d(pinhole.x, -pinhole.y, -1).normalized();
}

/// Solves a small system in place by elimination with row exchange; the right side becomes the
/// answer.
template <std::size_t N>
void solve(std::array<std::array<double, N>, N>& m, std::array<double, N>& right) {
    for (std::size_t i = 0; i < N; ++i) {
        std::size_t pivot = i;
        for (std::size_t j = i + 1; j < N; ++j)
            if (std::abs(m[j][i]) > std::abs(m[pivot][i])) pivot = j;
        std::swap(m[i], m[pivot]);
        std::swap(right[i], right[pivot]);
        for (std::size_t j = 0; j < N; ++j) {
            if (j == i) continue;
            const double factor = m[j][i] / m[i][i];
            for (std::size_t k = i; k < N; ++k) m[j][k] -= factor * m[i][k];
            right[j] -= factor * right[i];
        }
    }
    for (std::size_t i = 0; i < N; ++i) right[i] /= m[i][i];
}

/// The ellipse A x^2 + B x y + C y^2 + D x + E y = 1 nearest to points around it, by least squares;
/// near is an ellipse close to it, whose middle and size make the system well conditioned.
Outline ellipse_through(std::span<const V2d> points, const Outline& near) {
    std::array<std::array<double, 5>, 5> normal{};
    std::array<double, 5> conic{};
    for (const V2d& p : points) {
        const double x = (p.x - near.cx) / near.a, y = (p.y - near.cy) / near.a;
        const double row[5] = {x * x, x * y, y * y, x, y};
        for (std::size_t i = 0; i < 5; ++i) {
            for (std::size_t j = 0; j < 5; ++j) normal[i][j] += row[i] * row[j];
            conic[i] += row[i];
        }
    }
    solve(normal, conic);
    const auto [A, B, C, D, E] = conic;
    // The middle is where the gradient vanishes; about it the conic is A x^2 + B x y + C y^2 =
    // level.
    const double det = 4 * A * C - B * B;
    const double x0 = (B * E - 2 * C * D) / det, y0 = (B * D - 2 * A * E) / det;
    const double level = 1 + A * x0 * x0 + B * x0 * y0 + C * y0 * y0;
    const double mean = 0.5 * (A + C), spread = std::hypot(0.5 * (A - C), 0.5 * B);
    // The smaller eigenvalue belongs to the long axis.
    const double angle = 0.5 * std::atan2(B, A - C) * 180 / pi + 90;
    return {near.cx + near.a * x0, near.cy + near.a * y0,
            near.a * std::sqrt(level / (mean - spread)),
            near.a * std::sqrt(level / (mean + spread)), std::fmod(angle + 360, 180)};
}

/// What a lens makes of the outline that a pinhole would see: nearly an ellipse again.
Outline seen_through_lens(const Outline& pinhole, const Camera& camera) {
    std::array<V2d, 72> points;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const V2d p = rim_point(pinhole, 2 * pi * static_cast<double>(i) / points.size());
        points[i] =
            camera.distortion.distorted((p - camera.principal) / *camera.focal) * *camera.focal +
            camera.principal;
    }
    return ellipse_through(points, pinhole);
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
    return camera.distortion.none() ? outline : seen_through_lens(outline, camera);
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
        const Camera camera{std::exp(log_focal), principal, {}};
        return cone_of(outline, camera).half_angle - std::asin(1 / distance);
    };
    // The half-angle falls as the focal length grows, except for one so short that the outline is
    // seen askew: look down from well above where a ball on the axis would be, then bisect.
    constexpr double kStep = 0.25;
    const double start =
        std::log(std::sqrt(outline.a * outline.b) * std::sqrt(distance * distance - 1));
    double high = start + 3;
    if (!(miss(high) < 0)) return std::nullopt;
    while (high > start - 3 && miss(high - kStep) < 0) high -= kStep;
    double low = high - kStep;
    if (!(miss(low) >= 0)) return std::nullopt;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (miss(middle) > 0 ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
}

std::optional<double> focal_from_ellipse(double along, double across, double offset) {
    const double excess = (along - across) * (along + across) / (across * across);
    if (!(excess > 0)) return std::nullopt;
    const double square = offset * offset / excess - across * across;
    if (!(square > 0)) return std::nullopt;
    return std::sqrt(square);
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
