#pragma once

#include <optional>

#include "map/mirror_ball.h"

namespace chromeball {

/// A ball as another one has it beside itself: in that one's radii, from its middle, in the
/// camera's axes.
struct BallBeside {
    V3d centre{0, 0, 0};
    double radius = 0;

    /// Where a ray from a place on the unit ball (its normal) first meets it, if it does.
    std::optional<V3d> met(V3d place, V3d direction) const;
    bool hides(V3d place, V3d direction) const { return met(place, direction).has_value(); }
    /// Where a mirror there, met from outside, sends it.
    V3d reflected(V3d place, V3d direction) const {
        const V3d normal = (place - centre) / radius;
        return direction - normal * (2 * direction.dot(normal));
    }
};

/// Nobody tells how large two balls are or how far away. Such balls come in pairs of one size:
/// those that look so to within a quarter are taken as such, which tells their distances; others to
/// stand equally far from the camera, as they are put beside each other. Seen from far away they
/// always do.
BallBeside ball_beside(const MirrorBall& ball, const MirrorBall& other);

}  // namespace chromeball
