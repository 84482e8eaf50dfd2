#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "color/color.h"
#include "console.h"
#include "core/image.h"
#include "core/metadata.h"
#include "map/layouts.h"

namespace chromeball {

/// An environment map in the working space.
struct MapInput {
    Image pixels;      ///< layout.picture(size), 3 or 4 channels
    Image confidence;  ///< the same size, three channels alike, 0 to 1; empty where it has none
    std::string space;
    Metadata metadata;  ///< what is worth passing on
    std::size_t bad_pixels = 0;
    std::vector<std::string> warnings;
};

/// The channel `confidence` of a file or the part of it that `region` says, three channels alike;
/// empty where it has none.
Image read_confidence(const std::string& path, std::int64_t max_pixels,
                      const std::optional<Window>& region = {});

/// A file, or for `faces` a folder of six. Throws Error where the picture has not the layout's
/// aspect.
MapInput read_map(const std::string& path, const Layout& layout, std::int64_t max_pixels,
                  const ColorConfig& colors, const std::optional<std::string>& input_space);

/// What was read, and all that is not as it should be.
void tell(const MapInput& map, const std::string& path, const Layout& layout,
          const Console& console);

/// The text for a --from that is no shape.
std::string unknown_shape(const std::string& name);

}  // namespace chromeball
