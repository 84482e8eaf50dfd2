#pragma once

#include <string>

#include "color/color.h"
#include "console.h"
#include "core/image.h"
#include "core/metadata.h"
#include "map_job.h"

namespace chromeball {

/// Encodes a picture of the working space (RGBA, colour multiplied by alpha) and writes it to
/// `path`, in the plan's format, with its origin and `metadata`. The origin's version is filled in
/// here.
WrittenMap write_picture_file(const std::string& path, Image picture, const OutputPlan& plan,
                              const MapOptions& options, Provenance origin,
                              const ColorConfig& colors, Metadata metadata);
/// The same, told to the user. source: what it was made from.
void write_picture(const std::string& path, Image picture, const OutputPlan& plan,
                   const MapOptions& options, const std::string& source, const ColorConfig& colors,
                   const Console& console, Metadata metadata = {});

}  // namespace chromeball
