#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/image.h"
#include "io/write.h"

// The doors behind write.cpp, as decoders.h is behind read.cpp.

namespace chromeball::io {

using Bytes = std::vector<std::byte>;

/// What is encoded: values that fit the format, in its type, interleaved without padding. They are
/// made when they are asked for, so that they need not all be in memory.
struct Values {
    Size size;
    int channels = 0;
    int colors = 0;      ///< 1 or 3
    bool alpha = false;  ///< the channel after the colours; the one after that is confidence
    PixelType type = PixelType::f32;
    /// Stores the rows first to last and tells what had to be done to them. From any thread.
    std::function<WriteReport(int first, int last, std::byte* out)> store;

    std::size_t pixel_bytes() const {
        return bytes_per_value(type) * static_cast<std::size_t>(channels);
    }
    std::size_t row_bytes() const { return pixel_bytes() * static_cast<std::size_t>(size.width); }
};

/// Rows first to last, on all cores; what was done to them is added to the report.
void store_rows(const Values& values, int first, int last, std::byte* out, WriteReport& report);

inline void add(WriteReport& total, const WriteReport& part) {
    total.clamped += part.clamped;
    total.repaired += part.repaired;
}

/// Names of encoded sRGB that deserve the formats' own mark.
inline bool is_encoded_srgb(const ColorTag& tag) {
    return tag.space == "sRGB" || tag.space == "srgb_texture" || tag.space == "srgb_rec709_scene" ||
           tag.space == "sRGB - Texture";
}

/// A whole EXR file in memory. `path` is for messages.
Bytes encode_exr(const std::string& path, const Values& values, const WriteOptions& options,
                 WriteReport& report);

/// A whole PNG file in memory.
Bytes encode_png(const Values& values, const WriteOptions& options, WriteReport& report);

/// A whole HDR, TIFF or JPEG file in memory.
Bytes encode_with_oiio(const std::string& path, const Values& values, const WriteOptions& options,
                       WriteReport& report);

}  // namespace chromeball::io
