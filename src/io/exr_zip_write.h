#pragma once

#include <string>
#include <vector>

#include "io/encoders.h"

namespace chromeball::io {

/// What follows the header in an EXR file of scanlines with ZIP compression: the table of contents
/// and the chunks. As OpenEXR would write it, in a fifth of the time: ISA-L deflates, on all cores.
///
/// header  the file so far; the rest is appended
/// names   of the channels, in the values' order
void append_zip(const Values& values, const std::vector<std::string>& names, Bytes& header,
                WriteReport& report);

}  // namespace chromeball::io
