#pragma once

#include "io/decoders.h"
#include "io/encoders.h"

namespace chromeball::io::oiio {

/// What the module does for decode_with_oiio and encode_with_oiio.
Photo decode(const std::string& path, const FileProbe& probe, const DecodeRequest& request);
Bytes encode(const std::string& path, const Values& values, const WriteOptions& options,
             WriteReport& report);
/// What the module does for open_clip_with_oiio.
std::unique_ptr<ClipReader> open_clip(const std::string& path);

}  // namespace chromeball::io::oiio
