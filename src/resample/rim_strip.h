#pragma once

#include <optional>
#include <vector>

#include "core/image.h"
#include "core/outline.h"
#include "resample/ellipse_rows.h"
#include "resample/rgbw.h"

namespace chromeball {

/// The light just inside a ball's rim, rolled off into a strip: along the rim, and by depth.
///
/// There a pixel along the rim turns the direction by next to nothing, a pixel towards it by
/// degrees. So the strip takes light from the usable pixels that lie as deep, over some pixels
/// along the rim: as the rim runs across rows and columns they lie at many depths, far finer than a
/// pixel apart. (On renders with known light 1.4 dB better than bilinear taps, beyond 150 degrees
/// from the camera.)
class RimStrip {
public:
    /// No strip: shows nothing.
    RimStrip() = default;
    /// pixels: four channels, the last one the weight, 0 where a pixel must not be used.
    /// first_depth: the smallest depth inside the outline, in pixels, at which pixels are usable.
    RimStrip(const Image& pixels, const Outline& outline, double first_depth);

    /// The light at a position in the pixels' coordinates; what lies outside the strip's first
    /// depth shows what is there. Nothing deeper than the strip, or where no pixel near by is
    /// usable.
    std::optional<Rgbw> tap(double x, double y) const;

    /// Where the strip ends, pixels deep; -1 of no strip.
    double last_depth() const { return last_; }
    double first_depth() const { return first_; }
    double rows_per_pixel() const;
    /// Columns along the rim, the first one once more at the end; rows by depth. Colour and weight.
    const Image& pixels() const { return strip_; }

private:
    /// A position, seen from the rim.
    struct Place {
        double depth = 0;  ///< inwards, to first order, pixels
        double turn = 0;   ///< along the rim, in columns of the strip
    };
    /// A usable pixel of the ring that the strip covers.
    struct RingPixel {
        Place place;
        const float* pixel;
    };
    std::optional<Place> place(double x, double y, double deepest) const;
    std::vector<RingPixel> ring(const Image& pixels, double deepest) const;
    void splat(const RingPixel& from, double along_sigma, int first_column, int last_column);
    int columns() const { return strip_.width() - 1; }

    Outline outline_;
    EllipseRows rows_;
    double first_ = 0, last_ = -1;
    Image strip_;  // columns along the rim, the first one again at the end; colour and weight
};

}  // namespace chromeball
