#pragma once

#include <cstdint>
#include <vector>

#include "render/environment.h"
#include "render/scene.h"
#include "render/tracer.h"
#include "render/view.h"

namespace chromeball {

/// How light gets from a surface to the eye.
enum class Shading {
    pixel,     ///< the map is looked up at every point: what graphics processors do
    vertex,    ///< ... at every vertex, colours between them are interpolated
    raytrace,  ///< rays go on, so that things see themselves and each other
};

/// Which sample of which pixel is being shaded: what its random numbers depend on.
struct SampleNumber {
    std::uint32_t seed = 0;   ///< of the pixel
    std::uint32_t index = 0;  ///< of the sample within it
    int count = 1;            ///< samples of the pixel
};

/// The light that comes from a scene along rays. Safe to use from many threads; all it is made of
/// must outlive it.
class Shader {
public:
    /// reflected: what mirrors, metals and glass show of the world instead of the environment,
    /// where it is not nullptr; for Shading::pixel and vertex.
    Shader(const Scene& scene, const Tracer& tracer, const Environment& environment,
           Shading shading, const Environment* reflected = nullptr);

    /// What is seen where a ray from the eye hits something.
    V3f seen(const Beam& beam, const Hit& hit, const SampleNumber& sample) const;

    /// Colours at the vertices for Shading::vertex, seen from an eye. To be called before seen().
    void shade_vertices(const View& view);

private:
    struct Surface;
    struct Path;
    Surface surface_at(const Beam& beam, const Hit& hit) const;
    V3f shaded(const Beam& beam, const Surface& surface, const Path& path) const;
    V3f along(const Beam& beam, const Surface& from, const Path& path) const;
    V3f polished(const Beam& beam, const Surface& surface, const Path& path) const;
    V3f rough(const Beam& beam, const Surface& surface, const Path& path) const;
    V3f matte(const Beam& beam, const Surface& surface, const Path& path) const;
    V3f glass(const Beam& beam, const Surface& surface, const Path& path) const;
    V3f spread(const V3f& direction, float solid_angle, const Surface& from,
               const Path& path) const;

    const Scene& scene_;
    const Tracer& tracer_;
    const Environment& environment_;
    const Environment& reflected_;
    Shading shading_;
    float skip_;  // how far from a surface rays start that leave it
    std::vector<std::vector<V3f>> vertex_colors_;
};

}  // namespace chromeball
