#pragma once

#include <vector>

#include "core/outline.h"
#include "detect/grey.h"
#include "detect/shape.h"

namespace chromeball::detecting {

/// How a rim is looked for around a first outline.
struct RimSearch {
    int rays = 96;
    double reach = 0;   ///< pixels to either side
    double step = 1;    ///< pixels between samples of a profile
    double smooth = 1;  ///< sigma of the derivative, pixels
    double loose = 0;   ///< first and last scale, pixels, at which edges count as near
    double tight = 0;
    double shade = 0;  ///< pixels: an edge this close inside of a strong one counts for less
};

/// A rim as found.
struct Rim {
    Outline outline;
    double inside_picture = 0;  ///< part of the rim that lies in the picture
    double visible = 0;         ///< part of the whole rim on which a clear edge was found
    double coverage = 0;  ///< the same of the part inside the picture, less what chance would give
    double support = 0;   ///< coverage weighted with how much the edges stand out, 0 to 1
    double significance = 0;  ///< how unlikely so many edges in line are by chance, natural log
    double longest_gap = 0;   ///< longest run of the rim in the picture without an edge, 0 to 1
    double blur = 0;          ///< sigma across the rim, pixels
    double scatter = 0;       ///< of the edges used about the outline, pixels
};

/// The rim near `start`: edges along profiles across it, those of other things (stand, hand,
/// reflections) outvoted, and an ellipse fitted that is as elliptic as the lens allows.
Rim fit_rim(const Raster<float>& picture, const Outline& start, const RimSearch& search,
            const Lens& lens);
/// The same on the photo's own pixels, as they are or in linear light.
enum class Tone { compressed, linear };
Rim fit_rim(const Grey& picture, Tone tone, const Outline& start, const RimSearch& search,
            const Lens& lens);

}  // namespace chromeball::detecting
