#pragma once

#include "io/decoders.h"
#include "io/encoders.h"

// OpenImageIO takes a fifth of a second to load, and most jobs need nothing of it. So what uses it
// (oiio_*.cpp) is a module, chromeball_oiio.so, that oiio_module.cpp loads when it is first asked.

namespace chromeball::io {

/// What the module offers: decode_with_oiio, encode_with_oiio and open_clip_with_oiio.
struct OiioModule {
    const char* version;  ///< of the chromeball that it was built with; another one's will not do
    Photo (*decode)(const std::string&, const FileProbe&, const DecodeRequest&);
    Bytes (*encode)(const std::string&, const Values&, const WriteOptions&, WriteReport&);
    std::unique_ptr<ClipReader> (*open_clip)(const std::string&);
};

/// The one function that the module exports, under this name.
inline constexpr char kOiioModuleEntry[] = "chromeball_oiio_module";
using OiioModuleEntry = const OiioModule*();

}  // namespace chromeball::io
