#include "render/module_doors.h"

// The module's side of module.h.

extern "C" __attribute__((visibility("default"))) const chromeball::render::Module*
chromeball_render_module() {
    using namespace chromeball::render;
    static constexpr Module kModule = {CHROMEBALL_VERSION, &embree::build,
                                       &embree::destroy,   &embree::intersect_packet,
                                       &embree::intersect, &assimp::load};
    return &kModule;
}
