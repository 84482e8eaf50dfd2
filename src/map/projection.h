#pragma once

#include <concepts>
#include <optional>
#include <string_view>

#include "map/dual.h"

namespace chromeball {

// The conventions, once for the whole toolkit.
//
// Directions: right-handed, +Y up, away from the ball. In the camera frame +X is the photo's right,
// +Y its up, and +Z points from the scene towards the camera, which looks along -Z.
//
// Positions: of a photo in pixels of its display window, of a map in the unit square (u = x /
// width, v = y / height). (0, 0) is the top-left corner of the top-left pixel, v points down, pixel
// (i, j) has its centre at ((i + 0.5) / width, (j + 0.5) / height).
//
// Nothing is mirrored: writing in the scene reads correctly in a lat-long, and on cube faces seen
// from inside.

/// Pairs positions in an image with directions of the sphere.
///
/// For every position with a direction, to_position(to_direction(p)) == p up to rounding. A
/// position outside the picture part (the corners around a ball, the empty cells of a cross) has no
/// direction; a direction the image cannot show (hidden behind a near ball) has no position. Both
/// are answers, not errors, hence optional. Directions are unit vectors, of any length where they
/// are taken.
///
/// Both are templates over the number type, double or Dual: a Dual position gives the Jacobian too.
template <class P>
concept Projection = requires(const P p, V2d position, V3d direction, Vec2<Dual> position_with,
                              Vec3<Dual> direction_with) {
    { P::name } -> std::convertible_to<std::string_view>;
    { p.to_direction(position) } -> std::same_as<std::optional<V3d>>;
    { p.to_position(direction) } -> std::same_as<std::optional<V2d>>;
    { p.to_direction(position_with) } -> std::same_as<std::optional<Vec3<Dual>>>;
    { p.to_position(direction_with) } -> std::same_as<std::optional<Vec2<Dual>>>;
    // Steradians per unit of image area; 0 outside.
    { p.solid_angle(position) } -> std::same_as<double>;
    // Whether the image bends so strongly here that its steps cannot be taken as straight.
    { p.curved(direction) } -> std::same_as<bool>;
};

/// Steradians per unit of image area, from the Jacobian: |d(direction)/du x d(direction)/dv|.
template <class P>
double solid_angle_from_jacobian(const P& projection, V2d position) {
    const auto d = projection.to_direction(with_derivatives(position));
    if (!d) return 0;
    const V3d by_u(d->x.du, d->y.du, d->z.du), by_v(d->x.dv, d->y.dv, d->z.dv);
    return by_u.cross(by_v).length();
}

}  // namespace chromeball
