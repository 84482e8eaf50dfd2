#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/image.h"
#include "io/write.h"

// The doors behind write.cpp, as decoders.h is behind read.cpp.

namespace chromeball::io {

using Bytes = std::vector<std::byte>;

/// What is encoded: values that fit the format, in its type, interleaved without padding.
struct Values {
    Size size;
    int channels = 0;
    int colors = 0;      ///< 1 or 3
    bool alpha = false;  ///< the channel after the colours; the one after that is confidence
    PixelType type = PixelType::f32;
    Bytes data;
};

/// Names of encoded sRGB that deserve the formats' own mark.
inline bool is_encoded_srgb(const ColorTag& tag) {
    return tag.space == "sRGB" || tag.space == "srgb_texture" || tag.space == "srgb_rec709_scene" ||
           tag.space == "sRGB - Texture";
}

/// A whole EXR file in memory. `path` is for messages.
Bytes encode_exr(const std::string& path, const Values& values, const WriteOptions& options);

/// A whole PNG file in memory.
Bytes encode_png(const Values& values, const WriteOptions& options);

/// A whole HDR, TIFF or JPEG file in memory.
Bytes encode_with_oiio(const std::string& path, const Values& values, const WriteOptions& options);

}  // namespace chromeball::io
