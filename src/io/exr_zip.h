#pragma once

#include <OpenEXR/ImfForward.h>

#include <string>
#include <vector>

#include "core/photo.h"

namespace chromeball::io {

/// Whether decode_zip() can read these channels as that type: scanlines, ZIP or ZIPS compression,
/// full resolution, stored as the type. For exr_read.cpp only.
bool can_decode_zip(const Imf::Header& header, const std::vector<std::string>& channels,
                    PixelType type);

/// Fills photo.pixels with the rows of its window, as OpenEXR would in two to three times the time:
/// it inflates with zlib and undoes the differences of bytes through memory.
///
/// first       the window's first row in the file's coordinates
/// channels    the photo's channels by their names in the file
void decode_zip(Imf::InputPart& part, const std::vector<std::string>& channels, int first,
                Photo& photo);

}  // namespace chromeball::io
