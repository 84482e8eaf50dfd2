#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace chromeball {

/// A colour space that files name in tags, and what tags and configs call it.
struct KnownSpace {
    std::string_view id;  ///< the Color Interop Forum's identifier, which is what we write
    /// What configs call it, besides the identifier.
    std::vector<std::string_view> names;
    /// What files call it: descriptions of ICC profiles, names in EXIF.
    std::vector<std::string_view> profiles;
    /// CIE xy of red, green, blue, white; only of scene-linear spaces, since a file that holds
    /// chromaticities is linear.
    std::optional<std::array<double, 8>> chromaticities;
};

/// Every space that is known by more than its name in a config. Add yours here.
const std::vector<KnownSpace>& known_spaces();

/// The one that a file's tag names, whatever its case and punctuation; nullptr for none.
const KnownSpace* known_space(std::string_view tag);

/// The linear one with these primaries and white, each within 1e-3; nullptr for none.
const KnownSpace* known_space(const std::array<double, 8>& chromaticities);

}  // namespace chromeball
