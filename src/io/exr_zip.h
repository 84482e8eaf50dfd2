#pragma once

#include <OpenEXR/ImfForward.h>

#include <string>
#include <vector>

#include "core/photo.h"
#include "io/exr_chunks.h"

namespace chromeball::io {

/// Whether decode_zip() can read these channels as that type: scanlines, ZIP or ZIPS compression,
/// full resolution, stored as the type. For exr_read.cpp only.
bool can_decode_zip(const Imf::Header& header, const std::vector<std::string>& channels,
                    PixelType type);

/// Fills photo.pixels, from the file of the photo's name, with the rows of its window, as OpenEXR
/// would in three times the time: it reads chunks one after the other, inflates with zlib and
/// undoes the differences of bytes through memory.
///
/// chunks      of the part whose header that is
/// channels    the photo's channels by their names in the file
/// first       the window's first row in the file's coordinates
void decode_zip(const Imf::Header& header, const ChunkTable& chunks,
                const std::vector<std::string>& channels, int first, Photo& photo);

}  // namespace chromeball::io
