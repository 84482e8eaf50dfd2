#include "detect/deviation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chromeball::detecting {

ShapeCovariance rough_covariance(const Draft& draft) {
    // One independent edge every four pixels of the rim that shows.
    const double r = radius(draft.outline), shown = std::max(draft.rim.visible, 0.05);
    const double count = std::max(5.0, shown * 2 * std::numbers::pi * r / 4);
    const double variance = std::pow(std::max(draft.rim.scatter, 0.3), 2) / (count * shown);
    ShapeCovariance c{};
    c[0][0] = c[1][1] = 2 * variance;
    c[2][2] = variance;
    c[3][3] = c[4][4] = 2 * variance / (r * r);
    return c;
}

OutlineDeviation deviation_of(const Outline& o, const ShapeCovariance& c) {
    const double r = radius(o), e = (o.a - o.b) / (o.a + o.b);
    const double twice = 2 * o.angle * std::numbers::pi / 180;
    const double cos2 = std::cos(twice), sin2 = std::sin(twice);
    const auto deviation = [&](const std::array<double, 5>& u) {
        double sum = 0;
        for (std::size_t i = 0; i < 5; ++i)
            for (std::size_t j = 0; j < 5; ++j) sum += u[i] * c[i][j] * u[j];
        return std::sqrt(std::max(sum, 0.0));
    };
    const double across = deviation({0, 0, 0, -sin2, cos2});
    constexpr double kAnyAngle = 51.96;  // 180 / sqrt(12)
    const double angle = across < 2 * e ? 90 / std::numbers::pi * across / e : kAnyAngle;
    return {std::sqrt(c[0][0]), std::sqrt(c[1][1]), deviation({0, 0, 1 + e, r * cos2, r * sin2}),
            deviation({0, 0, 1 - e, -r * cos2, -r * sin2}), std::min(angle, kAnyAngle)};
}

}  // namespace chromeball::detecting
