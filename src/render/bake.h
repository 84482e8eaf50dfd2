#pragma once

#include <optional>

#include "core/image.h"
#include "core/watch.h"
#include "render/preview.h"

namespace chromeball {

struct BakeOptions {
    int size = 256;    ///< of a face, pixels
    int samples = 16;  ///< of a pixel
    std::optional<ClipPlane> clip = std::nullopt;
};

/// The six views of a scene from a point, along +X -X +Y -Y +Z -Z, 90 degrees each: a cube map of
/// the layout `openexr`, RGBA, alpha 1, in the world's axes. What the point stands in should be
/// hidden first. Rays are traced on, so that mirrors in the scene show it.
///
/// Throws Error of kind `interrupted`.
Image bake(const Scene& scene, const Tracer& tracer, const Environment& environment, const V3d& at,
           const BakeOptions& options = {}, const Watch& watch = {});

/// A plane that a mirror lies in.
struct Plane {
    V3d point{0, 0, 0};
    V3d normal{0, 1, 0};  ///< unit vector
};

/// The plane through three points, its normal to the side they are counter-clockwise from; nothing
/// where they are on a line.
std::optional<Plane> plane_through(const V3d& a, const V3d& b, const V3d& c);

/// The plane of an object whose triangles lie in one, to a thousandth of its size; nothing for
/// others.
std::optional<Plane> plane_of(const Object& object);

/// An eye's image in a mirror: e' = e - 2 (n.e - n.p) n. What the eye sees in the mirror is what
/// there is from e', through it: the six views from e', clipped at the plane, are the map that
/// makes a flat mirror's reflections exact, where a map from a point on the mirror does not.
V3d mirrored(const V3d& eye, const Plane& plane);

}  // namespace chromeball
