#pragma once

#include <cstddef>
#include <span>

#include "core/metadata.h"

namespace chromeball::io {

/// What a camera says of a picture (EXIF 2.32).
struct Exif {
    int orientation = 1;  ///< 1 to 8
    bool srgb = false;    ///< ColorSpace says so
    Metadata metadata;    ///< under the names that OpenImageIO gives the tags
};

/// From the TIFF structure that EXIF is: what follows "Exif\0\0" in a JPEG, a PNG's eXIf chunk.
/// Damaged parts are left out, as are tags that say nothing of a picture's light: thumbnails,
/// makers' notes, places.
Exif read_exif(std::span<const std::byte> tiff);

}  // namespace chromeball::io
