#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include <Imath/half.h>

#include "core/photo.h"

namespace chromeball {

template <class T>
constexpr PixelType pixel_type() {
    if constexpr (std::is_same_v<T, std::uint8_t>) return PixelType::u8;
    if constexpr (std::is_same_v<T, std::uint16_t>) return PixelType::u16;
    if constexpr (std::is_same_v<T, Imath::half>) return PixelType::f16;
    return PixelType::f32;
}

/// A photo of these numbers, at the display window's corner.
template <class T>
Photo photo_of(Size size, int channels, const std::vector<T>& values) {
    Photo photo;
    photo.name = "plate.tif";
    photo.type = pixel_type<T>();
    photo.channels = channels;
    photo.window = {0, 0, size};
    photo.display = size;
    const auto bytes = std::as_bytes(std::span(values));
    photo.pixels.assign(bytes.begin(), bytes.end());
    return photo;
}

/// A photo of one pixel.
inline Photo pixel_photo(const std::vector<float>& values) {
    return photo_of<float>({1, 1}, static_cast<int>(values.size()), values);
}

/// An image of one pixel.
inline Image pixel_image(const std::vector<float>& values) {
    Image image({1, 1}, static_cast<int>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) image.row(0)[i] = values[i];
    return image;
}

}  // namespace chromeball
