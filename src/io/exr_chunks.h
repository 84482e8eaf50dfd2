#pragma once

#include <OpenEXR/ImfForward.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/probe.h"

namespace chromeball::io {

/// Where the chunks (rows or a tile) of a part lie in its file.
struct ChunkTable {
    std::vector<std::uint64_t> places;  ///< of scanlines from top to bottom
    bool multipart = false;             ///< a chunk begins with its part's number
};

/// The table of contents of a part; nothing where the library understands headers that we do not.
/// Throws Error when the file ends before the last chunk does, by the table and that chunk's
/// length: who decodes some rows only would not notice. For exr_read.cpp only.
std::optional<ChunkTable> checked_chunks(const std::string& path, const FileProbe& probe,
                                         const Imf::MultiPartInputFile& file, int part);

}  // namespace chromeball::io
