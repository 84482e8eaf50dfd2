#pragma once

#include <string>

#include "render/load.h"
#include "render/tracer.h"

// Embree and Assimp take longer to load than all else that the program links. So what uses them
// (embree.cpp, assimp.cpp) is a module, chromeball_render.so, that module.cpp loads when it is
// first asked.

namespace chromeball::render {

/// What the module offers.
struct Module {
    const char* version;  ///< of the chromeball that it was built with; another one's will not do
    void* (*build)(const Scene&);
    void (*destroy)(void*);
    void (*intersect_packet)(void*, const RayPacket&, Hit*);
    Hit (*intersect)(void*, const V3f& origin, const V3f& direction, float from);
    Scene (*load)(const std::string& path, const LoadLimits& limits);
};

/// The one function that the module exports, under this name.
inline constexpr char kModuleEntry[] = "chromeball_render_module";
using ModuleEntry = const Module*();

/// Loaded at the first call; after a failure the next call tries again. Throws Error.
const Module& module();

}  // namespace chromeball::render
