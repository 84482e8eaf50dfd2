#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/image.h"
#include "core/metadata.h"
#include "map/camera.h"
#include "map/layouts.h"
#include "map/mirror_ball.h"
#include "map/orientation.h"

// Pictures that the tests paint, and what the program must make of them.

namespace chromeball::test {

/// The synthetic world: (d + 1) / 2, so that a colour tells its direction.
V3d world_color(V3d direction);

/// A photo of a mirror ball in that world, linear RGB, over grey; 3 x 3 samples a pixel.
Image ball_photo(Size size, const MirrorBall& ball, double background = 0.18);

/// A ball seen from far away: circle of radius r around (cx, cy).
MirrorBall distant_ball(double cx, double cy, double r);
/// A ball `distance` radii away in the direction `axis`, through a lens of `focal` pixels.
MirrorBall near_ball(Size photo, V3d axis, double distance, double focal);

/// 32-bit EXR.
void write_exr(const std::string& path, const Image& image, const Metadata& metadata = {});
/// 32-bit EXR with whatever values, NaN and infinities too.
void write_unrepaired_exr(const std::string& path, const Image& image);
/// 32-bit EXR of the channels Y and A: an image's first and fourth.
void write_grey_alpha(const std::string& path, const Image& image);
/// 8-bit sRGB of a linear image, PNG or JPEG.
void write_picture(const std::string& path, const Image& image);
/// 8-bit picture of values that are encoded already.
void write_encoded(const std::string& path, const Image& encoded);
/// Means of factor x factor pixels.
Image shrunk(const Image& image, int factor);

/// The world as a map of a layout, exact at the pixels' centres; alpha 1 where there are
/// directions.
Image world_map(const Layout& layout, int size);

/// The first part of a file as floats, 1 to 4 channels; integers as 0 to 1, alpha associated only
/// where the file has it so.
Image read_floats(const std::string& path);

/// How far a map is from the world seen after a rotation (camera to output).
struct Difference {
    double worst = 0;    ///< largest absolute difference of a colour, where alpha is above 0.99
    double covered = 0;  ///< mean alpha of the pixels that have directions
    std::size_t compared = 0;
};
/// Directions of the camera frame below lowest_z do not count: a small ball shows them too
/// coarsely.
Difference difference(const Image& map, const Layout& layout, const Rotation& camera_to_output = {},
                      double lowest_z = -2);
/// Largest absolute difference of two images of one size; infinite where the sizes differ.
double largest_difference(const Image& a, const Image& b);

}  // namespace chromeball::test
