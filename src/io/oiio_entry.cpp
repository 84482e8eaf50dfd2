#include "io/oiio_doors.h"
#include "io/oiio_module.h"

// The module's side of oiio_module.h.

extern "C" __attribute__((visibility("default"))) const chromeball::io::OiioModule*
chromeball_oiio_module() {
    using namespace chromeball::io;
    static constexpr OiioModule kModule = {CHROMEBALL_VERSION, &oiio::decode, &oiio::encode,
                                           &oiio::open_clip};
    return &kModule;
}
