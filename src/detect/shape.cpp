#include "detect/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chromeball::detecting {
namespace {

constexpr double kTau = 2 * std::numbers::pi;

}  // namespace

Shape shape_of(const Outline& o) {
    const double e = (o.a - o.b) / (o.a + o.b), twice = 2 * o.angle * std::numbers::pi / 180;
    return {o.cx, o.cy, 0.5 * (o.a + o.b), e * std::cos(twice), e * std::sin(twice)};
}

Outline outline_of(const Shape& s) {
    const double e = std::min(std::hypot(s.e1, s.e2), 0.5);
    double degrees = 90 / std::numbers::pi * std::atan2(s.e2, s.e1);
    if (degrees < 0) degrees += 180;
    if (degrees >= 180 || e == 0) degrees = 0;
    return {s.x, s.y, s.radius * (1 + e), s.radius * (1 - e), degrees};
}

std::vector<Ray> rays_of(const Outline& o, int count) {
    std::vector<Ray> rays;
    const double c = std::cos(o.angle * std::numbers::pi / 180);
    const double s = std::sin(o.angle * std::numbers::pi / 180);
    rays.reserve(static_cast<std::size_t>(std::max(count, 0)));
    // The next of equal steps around the circle is the last one turned: many times as fast as
    // sines.
    const double step = kTau / count, cs = std::cos(step), ss = std::sin(step);
    double ct = std::cos(0.5 * step), st = std::sin(0.5 * step);
    for (int i = 0; i < count; ++i) {
        const double px = c * o.a * ct - s * o.b * st, py = s * o.a * ct + c * o.b * st;
        const double nx = c * ct / o.a - s * st / o.b, ny = s * ct / o.a + c * st / o.b;
        const double n = std::sqrt(nx * nx + ny * ny), p2 = px * px + py * py;
        rays.push_back(
            {o.cx + px, o.cy + py, nx / n, ny / n, (px * px - py * py) / p2, 2 * px * py / p2});
        const double next = cs * ct - ss * st;
        st = ss * ct + cs * st;
        ct = next;
    }
    return rays;
}

/// With lengths in focal lengths, c from the principal point to the ellipse's centre and b its
/// smaller axis, a cone's outline has (a / b)^2 = 1 + c^2 / (1 + b^2), and points to the principal
/// point (from the cone's semi-axes and centre, eliminating both angles).
ShapePrior prior_at(const Shape& s, const Lens& lens) {
    const double dx = s.x - lens.principal_x, dy = s.y - lens.principal_y;
    const double c2 = (dx * dx + dy * dy) / (lens.focal * lens.focal);
    const double b = s.radius / lens.focal, ratio = std::sqrt(1 + c2 / (1 + b * b));
    const double e = (ratio - 1) / (ratio + 1);
    const double angle = 2 * std::atan2(dy, dx);
    ShapePrior prior{e * std::cos(angle), e * std::sin(angle), 0, 0,
                     std::cos(angle),     std::sin(angle)};
    // A known camera leaves rounding only. An unknown one may be longer or wider than usual, or the
    // picture cropped.
    prior.along = lens.known ? 1e-5 : 0.002 + 1.2 * e;
    prior.across = lens.known ? 1e-5 : 0.0015 + 0.06 * e;
    prior.along += lens.slack;
    prior.across += lens.slack;
    return prior;
}

}  // namespace chromeball::detecting
