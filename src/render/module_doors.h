#pragma once

#include "render/module.h"

namespace chromeball::render {

namespace embree {
void* build(const Scene& scene);
void destroy(void* built);
void intersect_packet(void* built, const RayPacket& rays, Hit* hits);
Hit intersect(void* built, const V3f& origin, const V3f& direction, float from);
}  // namespace embree

namespace assimp {
Scene load(const std::string& path, const LoadLimits& limits);
}  // namespace assimp

}  // namespace chromeball::render
