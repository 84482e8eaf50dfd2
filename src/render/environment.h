#pragma once

#include <Imath/ImathVec.h>

#include <vector>

#include "core/image.h"
#include "map/layouts.h"
#include "resample/source.h"

namespace chromeball {

using Imath::V3d;
using Imath::V3f;

/// Light that comes from infinitely far away, made to be looked up fast and without aliasing: the
/// map and, each half as large as the one before, its means down to a few pixels.
///
/// What the map does not show (alpha 0) is filled in from around it.
class Environment {
public:
    /// pixels: 3 or 4 channels, colour multiplied by alpha, of layout.picture(n). Maps that are
    /// neither lat-long nor cube are turned into a lat-long.
    Environment(Image pixels, const Layout& layout);

    /// The mean light from the directions of a parallelogram, r + s by_x + t by_y with s and t from
    /// -1/2 to 1/2.
    ///
    /// r             unit vector
    /// by_x, by_y    perpendicular to r, radians; 0: bilinear between the map's own pixels
    V3f radiance(const V3f& r, const V3f& by_x, const V3f& by_y) const;
    V3f radiance(const V3f& r) const { return radiance(r, V3f(0), V3f(0)); }
    /// The mean over a round patch of that many steradians.
    V3f radiance(const V3f& r, float solid_angle) const;

    /// Irradiance over pi: what a white matte surface with that normal sends back. For the
    /// whole sphere from a map of some 64 lines: off by less than 1 % but for a light that touches
    /// the horizon.
    V3f matte(const V3f& normal) const;

    /// The part of the sphere, 0 to 1, that the map itself shows.
    double covered() const { return covered_; }
    /// Radians across one of the map's pixels, about.
    double pixel_angle() const { return pixel_angle_; }

private:
    struct Level {
        Image pixels;  // with a border; of a cube the faces below each other, each with its border
        int width = 0, height = 0, border = 0;  // of the picture or a face
    };
    struct Place {
        float x, y;  // in the finest level's pixels, without border; of a cube within the face
        int face;
    };

    Place place_of(const V3f& r) const;
    V3f tap(const Level& level, const Place& place, float scale) const;
    V3f trilinear(const V3f& r, float level) const;
    void make_matte(const std::vector<Image>& images, const Layout& layout);

    bool cube_ = false;
    std::vector<Level> levels_;
    Level matte_;  // a cube
    double covered_ = 1;
    double pixel_angle_ = 0;
};

}  // namespace chromeball
