#pragma once

#include <optional>
#include <vector>

#include "core/image.h"
#include "map/affine.h"
#include "map/layouts.h"
#include "map/projections.h"
#include "resample/rgbw.h"
#include "resample/rim_strip.h"
#include "resample/row_light.h"

namespace chromeball {

/// A picture that light is taken from, prepared so that a bilinear tap needs no conditions: four
/// channels (colour multiplied by a weight, and the weight: alpha, 0 where a pixel must not be
/// used), with a border around it (around each face of a cube) that holds what lies beyond the
/// seam.
struct Source {
    AnyProjection projection;
    Image pixels;  ///< prepared; 4 channels
    int border = 1;
    /// Of a cube: the width of a face; whatever the layout was, the faces stand below each other as
    /// in `openexr` (so does the projection say), each with its border.
    int face_size = 0;
    /// Projection position -> pixel position in `pixels` (of a cube: not used).
    Affine to_pixels;
    /// Of a ball: its outline in `pixels`' coordinates. Taps there drop what is not purely ball,
    /// and a direction that the photo shows counts as shown whatever was dropped.
    std::optional<Outline> ball;
    /// Of a ball: the part of `pixels` that the photo really has.
    double left = 0, top = 0, right = 0, bottom = 0;
    RimStrip rim;  ///< of a ball: what its rim shows

    /// Of each row of `pixels`, without the border: where single pixels may outshine the rest.
    std::vector<RowLight> lights;
    /// Steradians per pixel in the mean, over what the picture shows.
    double mean_solid_angle = 0;
};

/// A ball in a photo.
///
/// pixels     the photo or a part of it, 3 or 4 channels, scene-linear, colour multiplied by alpha
/// to_pixels  from the positions that `ball` knows to those in `pixels`
/// rim_blur   standard deviation of the lens' blur, pixels: how far background leaks into the ball
Source ball_source(const Image& pixels, const MirrorBall& ball, const Affine& to_pixels,
                   double rim_blur = 0);

/// The same of a photo that comes in bands of rows, none of which stays in memory.
class BallSourceMaker {
public:
    /// size: of the pixels that ball_source() would be given
    BallSourceMaker(Size size, const MirrorBall& ball, const Affine& to_pixels,
                    double rim_blur = 0);
    /// Rows from the one numbered `first` on, each of them once; from any thread.
    void add(int first, ImageView<const float> rows);
    /// Once, when all rows have been added.
    Source finish();

private:
    Source source_;
    Size size_;
    double rim_blur_;
};

/// An environment map; its picture must have the layout's aspect: pixels.size() ==
/// layout.picture(n).
Source map_source(const Image& pixels, const Layout& layout);

/// The part of a photo that a ball's conversion needs, with a margin, cut to `available`.
Window needed_window(const Outline& outline, const Window& available);

}  // namespace chromeball
