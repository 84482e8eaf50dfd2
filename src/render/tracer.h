#pragma once

#include <cstdint>
#include <memory>

#include "render/scene.h"

namespace chromeball {

/// Sixteen rays that start near each other, as arrays so that they are followed side by side.
struct RayPacket {
    static constexpr int kRays = 16;
    alignas(64) std::int32_t valid[kRays];  ///< -1: follow it, 0: leave it
    alignas(64) float ox[kRays], oy[kRays], oz[kRays], from[kRays];
    alignas(64) float dx[kRays], dy[kRays], dz[kRays];

    /// Ray `i` starts at `origin`, and is followed.
    void start(int i, const V3f& origin, const V3f& direction) {
        valid[i] = -1;
        ox[i] = origin.x, oy[i] = origin.y, oz[i] = origin.z, from[i] = 0;
        dx[i] = direction.x, dy[i] = direction.y, dz[i] = direction.z;
    }
};

/// What a ray met first.
struct Hit {
    static constexpr std::uint32_t kNothing = ~0U;
    std::uint32_t object = kNothing;  ///< of the scene
    std::uint32_t triangle = 0;       ///< of the object's mesh
    float distance = 0;               ///< in lengths of the ray's direction
    float u = 0, v = 0;               ///< barycentric: of the triangle's second and third position
    explicit operator bool() const { return object != kNothing; }
};

/// Finds what rays meet in a scene. Safe to use from many threads; the scene may go.
class Tracer {
public:
    /// Throws Error where there is not enough memory, or where the module with the ray tracer
    /// cannot be loaded.
    explicit Tracer(const Scene& scene);

    void intersect(const RayPacket& rays, Hit (&hits)[RayPacket::kRays]) const;
    Hit intersect(const V3f& origin, const V3f& direction, float from) const;

private:
    std::shared_ptr<void> scene_;
};

}  // namespace chromeball
