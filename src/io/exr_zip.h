#pragma once

#include <OpenEXR/ImfForward.h>

#include <functional>
#include <string>
#include <vector>

#include "core/photo.h"
#include "io/exr_chunks.h"

namespace chromeball::io {

/// Whether decode_zip() can read these channels as that type: scanlines, ZIP or ZIPS compression,
/// full resolution, stored as the type. For exr_read.cpp only.
bool can_decode_zip(const Imf::Header& header, const std::vector<std::string>& channels,
                    PixelType type);

/// Decodes the rows of the photo's window from the file of its name, as OpenEXR would in three
/// times the time: it reads chunks one after the other, inflates with zlib and undoes the
/// differences of bytes through memory.
///
/// header, chunks  of the part
/// channels        the photo's channels by their names in the file
/// first           the window's first row in the file's coordinates
/// bands           takes bands of the photo, see ReadOptions; null: they are put into photo.pixels,
///                 which has the size
void decode_zip(const Imf::Header& header, const ChunkTable& chunks,
                const std::vector<std::string>& channels, int first,
                const std::function<void(const Photo& band)>& bands, Photo& photo);

}  // namespace chromeball::io
