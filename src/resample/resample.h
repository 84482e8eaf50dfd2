#pragma once

#include "core/image.h"
#include "core/watch.h"
#include "map/layouts.h"
#include "map/orientation.h"
#include "resample/source.h"

namespace chromeball {

enum class Filter {
    adaptive,  ///< as many taps as the output pixel's footprint in the source needs
    fast,      ///< one bilinear tap: where the output is about as fine as the source
};

struct ResampleOptions {
    Filter filter = Filter::adaptive;
    /// Takes directions of the source's frame to those of the output's.
    Rotation rotation;
    /// Whether the adaptive filter keeps the light of single bright pixels exactly. Not for
    /// pictures of something else than light.
    bool keeps_light = true;
};

/// Light from one shape into another: RGBA, colour multiplied by alpha, of layout.picture(size).
///
/// Alpha is coverage: the part of the pixel's directions that the source shows (not hidden behind a
/// near ball, inside the picture), whatever taps the filter dropped at the rim.
///
/// The adaptive filter takes the source position and Jacobian of every output pixel. A footprint
/// shorter than 0.7 source pixels takes one monotone cubic tap, see cubic_tap(). From a larger
/// footprint follow nx x ny = clamp(ceil(1.5 footprint), 2, 64) sub-samples, each a bilinear tap
/// (at the ball's rim one that follows the rim).
/// The taps' positions follow from the Jacobian; where source or output bend (around the back of
/// the ball, the poles, seams) each one's direction is taken exactly.
///
/// Taps two thirds of a pixel apart see a single bright pixel as up to a fifth too much or too
/// little. Where it holds a large part of all light (see keep_light()) that is put right: its light
/// over the sphere is the pixel's to 0.1 %. Not at a ball's rim, 5.5 pixels deep, nor next to
/// pixels that must not be used: their light is drawn from several.
///
/// The same bytes for any number of threads. Throws Error of kind `interrupted`.
Image resample(const Source& source, const Layout& layout, int size,
               const ResampleOptions& options = {}, const Watch& watch = {});

/// The same into pixels that are there already: four channels, of layout.picture(n) for some n.
void resample(const Source& source, const Layout& layout, ImageView<float> out,
              const ResampleOptions& options = {}, const Watch& watch = {});

/// The ball of a photo painted again, lit by a map: RGBA, of region.size, alpha 0 where there is no
/// ball.
///
/// map         made by map_source
/// ball        in the photo's pixels; region is the part of them to paint
/// rotation    takes directions of the camera's frame to those of the map's
Image render_ball(const Source& map, const MirrorBall& ball, const Window& region,
                  const Rotation& rotation = {}, const Watch& watch = {});

/// The power of two from 64 to 4096 for which the layout's pixels have, in the mean, the solid
/// angle nearest to the source's.
int natural_size(const Source& source, const Layout& layout);

/// The ball cut out of a photo and normalised: a square of `size` pixels whose inscribed circle is
/// the outline, RGBA, alpha 0 outside. pixels and to_pixels as for ball_source.
Image crop_ball(const Image& pixels, const Outline& outline, const Affine& to_pixels, int size,
                const Watch& watch = {});

}  // namespace chromeball
