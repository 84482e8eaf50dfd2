#include "detect/focal.h"

#include <cmath>

#include "map/camera.h"

namespace chromeball::detecting {

std::optional<FocalEstimate> focal_of(const Shape& shape, const ShapeCovariance& covariance,
                                      const Lens& lens) {
    // What a fit can be off alike all around, in parts of the radius, whatever its scatter says.
    constexpr double kFloor = 5e-4;
    // In standard deviations: clearly an ellipse, and not clearly one that points elsewhere.
    constexpr double kClear = 4, kAskew = 3;
    const double dx = shape.x - lens.principal_x, dy = shape.y - lens.principal_y;
    const double offset = std::hypot(dx, dy), turn = 2 * std::atan2(dy, dx);
    const double c = std::cos(turn), s = std::sin(turn);
    const double along = c * shape.e1 + s * shape.e2, across = c * shape.e2 - s * shape.e1;
    const auto deviation = [&](double u, double v) {
        const double variance =
            u * u * covariance[3][3] + 2 * u * v * covariance[3][4] + v * v * covariance[4][4];
        return std::sqrt(std::max(variance, 0.0) + kFloor * kFloor);
    };
    const double sigma = deviation(c, s);
    if (!(along > kClear * sigma) || !(std::abs(across) < kAskew * deviation(-s, c)))
        return std::nullopt;
    const auto focal = [&](double e) {
        return focal_from_ellipse(shape.radius * (1 + e), shape.radius * (1 - e), offset);
    };
    const auto middle = focal(along), least = focal(along + sigma), most = focal(along - sigma);
    if (!middle || !least || !most) return std::nullopt;
    return FocalEstimate{*middle, 0.5 * (*most - *least)};
}

}  // namespace chromeball::detecting
