#pragma once

#include <optional>

#include "core/image.h"
#include "core/watch.h"
#include "render/environment.h"
#include "render/sampling.h"
#include "render/scene.h"
#include "render/shader.h"
#include "render/view.h"

namespace chromeball {

/// Everything behind a plane is left out: rays begin where they come through it.
struct ClipPlane {
    V3d point{0, 0, 0};
    V3d normal{0, 1, 0};  ///< unit vector, to the side that is seen
};

struct PreviewOptions {
    Shading shading = Shading::pixel;
    int samples = 16;  ///< of a pixel in every round
    PixelFilter filter = PixelFilter::box;
    /// Rounds go on, block by block of 4 x 4 pixels, until the standard error of x / (1 + x) is
    /// below that; 0: one round.
    double noise = 0;
    int most_rounds = 64;
    bool background = false;  ///< the map behind the scene instead of nothing
    /// With Shading::pixel and vertex: what is reflected and refracted instead of the environment.
    const Environment* reflected = nullptr;
    std::optional<ClipPlane> clip = std::nullopt;
};

struct PreviewStatistics {
    std::size_t camera_rays = 0;
};

/// A picture of a scene in a light from far away: RGBA in the map's colour space, colour multiplied
/// by alpha, which is the part of a pixel that the scene covers (1 with a background).
///
/// The same bytes for any number of threads. Throws Error of kind `interrupted`.
Image preview(const Scene& scene, const Tracer& tracer, const Environment& environment,
              const View& view, const PreviewOptions& options = {},
              PreviewStatistics* statistics = nullptr, const Watch& watch = {});

/// A scene whose balls are meshes, as shading at vertices needs it.
Scene with_meshes_only(Scene scene);

}  // namespace chromeball
