#pragma once

#include <span>
#include <string_view>

namespace chromeball::io {

/// How one fact is called in OpenEXR and in the other formats.
struct FactName {
    std::string_view exr;    ///< OpenEXR's standard attribute
    std::string_view type;   ///< its type
    std::string_view other;  ///< OpenImageIO's name of the same fact in EXIF, DPX, ...; empty: none
};

/// The facts worth passing on, in the order in which they are written. A fact with several other
/// names has a row for each, the best first.
std::span<const FactName> fact_names();

}  // namespace chromeball::io
