#pragma once

#include <Imath/ImathVec.h>

#include <array>

#include "map/camera.h"
#include "map/mirror_ball.h"
#include "map/orientation.h"

namespace chromeball {

using Imath::V3f;

/// A ray with what it changes by from one sample of the picture to the next, right and down: Igehy,
/// Tracing Ray Differentials, 1999.
struct Beam {
    V3f origin{0, 0, 0}, direction{0, 0, -1};  ///< direction: unit vector
    V3f origin_x{0, 0, 0}, origin_y{0, 0, 0};
    V3f direction_x{0, 0, 0}, direction_y{0, 0, 0};
};

/// A camera somewhere in the world.
class View {
public:
    /// A pinhole (camera.focal must be there) at `eye`; to_world takes the camera's frame to the
    /// world's.
    View(Size size, const Camera& camera, const V3d& eye, const Rotation& to_world);

    /// From `distance` away at azimuth and elevation, looking at `target`. At 0, 0 it stands on +Z
    /// and looks along -Z; azimuth goes towards +X (counter-clockwise seen from above), elevation
    /// up. fov: vertical, degrees.
    static View orbit(Size size, double azimuth_degrees, double elevation_degrees, double distance,
                      double fov_degrees, const V3d& target = {0, 0, 0});

    /// At a point, looking along the -Z of a frame; fov: vertical, degrees.
    static View at(Size size, const V3d& eye, const Rotation& to_world, double fov_degrees);

    /// As a photo's camera sees its mirror ball, which is the unit sphere around the origin.
    static View of_ball(Size size, const Camera& camera, const MirrorBall& ball,
                        const Rotation& to_world);

    Size size() const { return size_; }
    const V3d& eye() const { return eye_; }
    const Rotation& to_world() const { return to_world_; }
    const Camera& camera() const { return camera_; }
    bool orthographic() const { return camera_.orthographic(); }

    /// The ray through a place of the picture, pixels; its changes are those over `step` pixels.
    Beam beam(double x, double y, float step) const;

private:
    View() = default;

    Size size_;
    Camera camera_;
    V3d eye_{0, 0, 0};
    Rotation to_world_;
    // Direction (or, if orthographic, origin) = start + x by_x + y by_y.
    V3d start_{0, 0, 0}, by_x_{0, 0, 0}, by_y_{0, 0, 0};
};

}  // namespace chromeball
