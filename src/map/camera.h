#pragma once

#include <Imath/ImathVec.h>

#include <optional>

#include "core/image.h"
#include "core/outline.h"
#include "map/distortion.h"

namespace chromeball {

using Imath::V2d;
using Imath::V3d;

/// The camera that took a photo: a pinhole with square pixels, or, without a focal length, one
/// infinitely far away.
///
/// The camera frame: +X the photo's right, +Y its up, +Z from the scene towards the camera, which
/// looks along -Z. The ray through the photo position (x, y) has the direction ((x - px) / f, (py -
/// y) / f, -1).
struct Camera {
    std::optional<double> focal;  ///< focal length in pixels; none: orthographic
    V2d principal{0, 0};  ///< where the optical axis meets the photo, pixels of the display window
    Distortion distortion{};  ///< of the lens; goes with a focal length

    bool orthographic() const { return !focal; }
};

/// The ball as the camera sees it: the cone that touches it. Lengths are ball radii.
struct Cone {
    V3d axis{0, 0, -1};     ///< unit vector from the camera to the ball's centre, camera frame
    double half_angle = 0;  ///< radians; sin(half_angle) = 1 / distance

    double distance() const;
    /// Half-angle, radians, of the cone straight behind the ball (around axis) whose directions no
    /// photo shows.
    double hidden_half_angle() const { return half_angle; }
};

/// Focal length in pixels from the lens and the width of the sensor that the whole picture's width
/// shows, both in mm.
double focal_from_sensor(double focal_mm, double sensor_width_mm, int picture_width);
/// Focal length in pixels from the horizontal field of view in degrees, in (0, 180).
double focal_from_hfov(double hfov_degrees, int picture_width);

/// The ellipse in which a cone is seen: with focal length 1, psi the axis' angle off the optical
/// axis and rho the half-angle, den = cos^2 psi - sin^2 rho, the semi-axes are sin rho cos rho /
/// den (radial) and sin rho / sqrt(den), the centre lies sin psi cos psi / den off. A lens
/// with distortion makes of it nearly an ellipse again: the nearest one is given. Nothing where
/// the ball reaches the camera's plane (den <= 0) or lies behind it.
std::optional<Outline> outline_of(const Cone& cone, const Camera& camera);

/// The cone whose outline fits best, by least squares of distances on the rim, in pixels. The
/// camera must have a focal length.
Cone cone_of(const Outline& outline, const Camera& camera);

/// The focal length in pixels with which the outline is that of a ball `distance` radii away;
/// distance > 1. Nothing where no focal length gives it.
std::optional<double> focal_from_distance(const Outline& outline, V2d principal, double distance);

/// The focal length in pixels that makes a ball's outline as long as it is, seen that far off the
/// optical axis: (along / across)^2 = 1 + offset^2 / (f^2 + across^2), from the semi-axes and the
/// middle that outline_of gives, both angles eliminated.
///
/// along    the semi-axis towards the principal point, pixels
/// across   the other one, pixels
/// offset   from the principal point to the outline's middle, pixels
///
/// Nothing where no focal length gives it: along <= across, or longer than any lens makes it.
std::optional<double> focal_from_ellipse(double along, double across, double offset);

/// The largest distance, in pixels, between the rims of two outlines that lie close together.
double rim_deviation(const Outline& one, const Outline& other);

/// Position on the rim; `t` runs from 0 to 2 pi (the ellipse's own parameter, not an angle at the
/// centre).
V2d rim_point(const Outline& outline, double t);

}  // namespace chromeball
