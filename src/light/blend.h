#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/watch.h"
#include "light/view.h"
#include "map/layouts.h"
#include "resample/resample.h"

namespace chromeball {

/// A view and where it belongs.
struct PlacedView {
    View view;
    Rotation to_world;
    /// From the ball towards the camera, in the view's own frame, where that is known:
    /// photographers stand there.
    std::optional<V3d> camera;
};

struct BlendOptions {
    Filter filter = Filter::adaptive;
    Rotation to_output;  ///< world to the output's frame
    bool fill = true;    ///< what no view saw gets the colours around it
    bool confidence = false;
    /// Of one view alone: its photographer is looked for by what one looks like.
    bool lone_photographer = false;
};

/// Views in one map.
struct Blended {
    /// RGBA of layout.picture(size). Filled: colours everywhere, alpha 1 or 0, 0 where no view saw.
    /// Not filled: colour multiplied by alpha, alpha the part of the pixel that some view saw.
    Image map;
    Image confidence;    ///< one channel, where asked for: of the view that was taken, 0 to 1
    double covered = 0;  ///< part of the sphere that some view saw
    /// A view: what its colours were multiplied by; 1 of the first one.
    std::vector<std::array<double, 3>> gains;
};

/// Blends views of one place. Exposure and tint are matched where views overlap. Everywhere the
/// most confident view is taken, photographers left out, and the change from one to the other is
/// short in detail and wide in what is left of differences in brightness, so that neither seams nor
/// double edges show. The same bytes for any number of threads. Throws Error of kind `interrupted`.
Blended blend(const std::vector<PlacedView>& views, const Layout& layout, int size,
              const BlendOptions& options = {}, const Watch& watch = {});

/// One channel, as large as a map: the confidence of the one view that the map was made from, 0 to
/// 1, see confidence(); 0 where the map's alpha is.
Image confidence_of(const PlacedView& view, const Image& map, const Layout& layout,
                    const Rotation& to_output, const Watch& watch = {});

/// The same of a map made from one that has such a channel: that (three times, as a map of the same
/// layout), filtered as the colours were.
Image confidence_of(const Source& confidence, const Image& map, const Layout& layout,
                    const ResampleOptions& how, const Watch& watch = {});

}  // namespace chromeball
