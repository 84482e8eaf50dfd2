#pragma once

#include <OpenEXR/ImfForward.h>

#include <string>

#include "io/probe.h"

namespace chromeball::io {

/// Throws Error when the file ends before the last chunk (rows or a tile) of a part does, by its
/// table of contents and that chunk's length: who decodes some rows only would not notice. Costs
/// reading the table. For exr_read.cpp only.
void check_chunks_are_there(const std::string& path, const FileProbe& probe,
                            const Imf::MultiPartInputFile& file, int part);

}  // namespace chromeball::io
