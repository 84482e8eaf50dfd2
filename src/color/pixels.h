#pragma once

#include <cstddef>

#include "core/image.h"
#include "core/photo.h"

namespace chromeball {

/// Some rows of a photo's stored pixels. Borrowed.
struct StoredRows {
    const std::byte* data = nullptr;  ///< the first channel of the first pixel
    PixelType type = PixelType::u8;
    int channels = 0;
    Size size;
    std::ptrdiff_t row_bytes = 0;

    bool is_grey() const { return channels < 3; }
    bool has_alpha() const { return channels == 2 || channels == 4; }
    std::ptrdiff_t pixel_bytes() const {
        return static_cast<std::ptrdiff_t>(bytes_per_value(type)) * channels;
    }
};

/// Rows first to last of the part of a photo that `window` (display-window coordinates, inside the
/// photo's own) covers.
StoredRows stored_rows(const Photo& photo, const Window& window, int first, int last);

/// The part of a window that lies in another; of size 0 x 0 where there is none.
Window intersection(const Window& a, const Window& b);

/// Stored numbers as floats, integers over [0, 1], grey in all three colours. `to` has the size of
/// `from`, and four channels where that has alpha, else three.
void load_floats(const StoredRows& from, ImageView<float> to);

/// Divides colour by alpha, in place; colour becomes 0 where alpha is 0. Four channels.
void divide_by_alpha(ImageView<float> pixels);

/// Multiplies colour by alpha, in place. Four channels.
void multiply_by_alpha(ImageView<float> pixels);

/// Counts pixels with a number that is not finite, as stored or as decoded. Such a pixel becomes 0
/// with alpha 0, and without an alpha channel NaN, for add_alpha() to find.
std::size_t clear_bad_pixels(const StoredRows& stored, ImageView<float> decoded);

/// A copy with an alpha channel of 1; pixels whose first channel is NaN become 0 with alpha 0.
Image add_alpha(const Image& rgb);

}  // namespace chromeball
