#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/memory.h"
#include "core/metadata.h"

namespace chromeball {

/// Stored pixels, of any type.
using PixelBytes = std::vector<std::byte, ZeroedAllocator<std::byte>>;

/// How a photo's numbers are stored: integers over their full range, or floats.
enum class PixelType { u8, u16, f16, f32 };

constexpr std::size_t bytes_per_value(PixelType type) {
    return type == PixelType::u8 ? 1 : type == PixelType::f32 ? 4 : 2;
}
constexpr bool is_integer(PixelType type) {
    return type == PixelType::u8 || type == PixelType::u16;
}

/// What a file itself says of its colours. Guesses do not count.
struct ColorTag {
    /// A colour-space name: colorInteropID, the ICC profile's description, EXIF's "sRGB"; empty
    /// where the file is silent.
    std::string space;
    /// CIE xy of red, green, blue, white, as OpenEXR stores them.
    std::optional<std::array<double, 8>> chromaticities;
};

/// Pixels as stored in a file, upright (EXIF orientation applied), with what the file says of them.
///
/// Encoded numbers must never be averaged: only `color` turns a Photo into an Image.
struct Photo {
    std::string name;  ///< the path as given, for messages
    PixelType type = PixelType::u8;
    int channels = 0;   ///< 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha
    Window window;      ///< where the pixels lie in the display window (EXR data window; rows read)
    Size display;       ///< the display window's size; coordinates are relative to its corner
    PixelBytes pixels;  ///< interleaved, rows from top to bottom, without padding
    bool associated_alpha = true;  ///< whether colour is already multiplied by alpha
    ColorTag color;
    Metadata metadata;
    /// What the decoder found wrong in the pixels' data and went on over; empty where all is well.
    std::string damage;
};

}  // namespace chromeball
