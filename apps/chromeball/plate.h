#pragma once

#include <string>
#include <vector>

#include "color/color.h"
#include "console.h"
#include "core/image.h"
#include "core/metadata.h"
#include "light_input.h"

namespace chromeball {

/// A photo that something is put into, in its ball's place.
struct Plate {
    Image pixels;  ///< RGBA of the display window, in the working space
    PhotoView view;
    Rotation to_world;
    Metadata metadata;  ///< worth passing on
};

/// A photo as RGBA of its display window, in the working space; black and clear where it has no
/// pixels. warnings: what is not as it should be. Throws Error.
Image plate_pixels(const Photo& photo, const ColorOptions& color, const ColorConfig& colors,
                   std::vector<std::string>& warnings);

/// Reads a photo and finds its ball, or takes the one that the options tell. `light` is what was
/// made of options.input: where that is the same photo, its ball is known. Throws Error.
Plate read_plate(const std::string& path, const LightOptions& options, const Light& light,
                 const MapOptions& map, const ColorConfig& colors, const Console& console);

}  // namespace chromeball
