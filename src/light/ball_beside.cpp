#include "light/ball_beside.h"

#include <algorithm>
#include <cmath>

namespace chromeball {

std::optional<V3d> BallBeside::met(V3d place, V3d direction) const {
    const V3d to = centre - place;
    const double along = to.dot(direction);
    if (along <= 0) return std::nullopt;
    const double room = radius * radius - (to.dot(to) - along * along);
    if (room <= 0) return std::nullopt;
    return place + direction * (along - std::sqrt(room));
}

BallBeside ball_beside(const MirrorBall& ball, const MirrorBall& other) {
    if (ball.orthographic() || other.orthographic()) {
        const Outline &here = ball.outline(), &there = other.outline();
        const double radius = std::sqrt(here.a * here.b);
        return {V3d((there.cx - here.cx) / radius, (here.cy - there.cy) / radius, 0),
                std::sqrt(there.a * there.b) / radius};
    }
    const V3d here = ball.axis() * ball.distance();
    constexpr double kAlike = 1.25;
    const double ratio = ball.distance() / other.distance();
    const double radius =
        std::max(ratio, 1 / ratio) < kAlike ? 1 : here.dot(other.axis()) / other.distance();
    return {other.axis() * (other.distance() * radius) - here, radius};
}

}  // namespace chromeball
