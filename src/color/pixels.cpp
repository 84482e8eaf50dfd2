#include "color/pixels.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <Imath/half.h>

namespace chromeball {
namespace {

float as_float(std::uint8_t value) { return static_cast<float>(value) / 255.0f; }
float as_float(std::uint16_t value) { return static_cast<float>(value) / 65535.0f; }
float as_float(Imath::half value) { return value; }
float as_float(float value) { return value; }

/// Calls f with a pointer of the stored type to the row's first number.
template <class F>
auto visit_row(const StoredRows& rows, int y, F f) {
    const std::byte* row = rows.data + y * rows.row_bytes;
    switch (rows.type) {
        case PixelType::u8:
            return f(reinterpret_cast<const std::uint8_t*>(row));
        case PixelType::u16:
            return f(reinterpret_cast<const std::uint16_t*>(row));
        case PixelType::f16:
            return f(reinterpret_cast<const Imath::half*>(row));
        default:
            return f(reinterpret_cast<const float*>(row));
    }
}

template <class T>
void load_row(const T* from, const StoredRows& rows, float* to) {
    const int green = rows.is_grey() ? 0 : 1;
    const int blue = rows.is_grey() ? 0 : 2;
    for (int x = 0; x < rows.size.width; ++x, from += rows.channels) {
        *to++ = as_float(from[0]);
        *to++ = as_float(from[green]);
        *to++ = as_float(from[blue]);
        if (rows.has_alpha()) *to++ = as_float(from[rows.channels - 1]);
    }
}

// Infinities and NaNs have all bits of the exponent set. Asking the bits, without branches, lets
// the compiler test a row many numbers at a time; integers are always finite.
unsigned is_bad(std::uint8_t) { return 0; }
unsigned is_bad(std::uint16_t) { return 0; }
unsigned is_bad(Imath::half value) { return (value.bits() & 0x7c00u) == 0x7c00u; }
unsigned is_bad(float value) {
    return (std::bit_cast<std::uint32_t>(value) & 0x7f800000u) == 0x7f800000u;
}

template <class T>
bool any_bad(const T* values, std::ptrdiff_t count) {
    unsigned bad = 0;
    for (std::ptrdiff_t i = 0; i < count; ++i) bad |= is_bad(values[i]);
    return bad != 0;
}

/// As clear_bad_pixels, a row.
template <class T>
std::size_t clear_bad_in_row(const T* stored, int stored_channels, float* p, int channels,
                             int width) {
    std::size_t bad = 0;
    for (int x = 0; x < width; ++x, p += channels, stored += stored_channels) {
        if (!any_bad(stored, stored_channels) && !any_bad(p, channels)) continue;
        std::fill(p, p + channels, 0.0f);
        if (channels == 3) p[0] = std::numeric_limits<float>::quiet_NaN();
        ++bad;
    }
    return bad;
}

}  // namespace

StoredRows stored_rows(const Photo& photo, const Window& window, int first, int last) {
    StoredRows rows{
        .type = photo.type, .channels = photo.channels, .size = {window.size.width, last - first}};
    rows.row_bytes = rows.pixel_bytes() * photo.window.size.width;
    rows.data = photo.pixels.data() + (window.y - photo.window.y + first) * rows.row_bytes +
                (window.x - photo.window.x) * rows.pixel_bytes();
    return rows;
}

Window intersection(const Window& a, const Window& b) {
    // In 64 bits, since files may claim windows near the ends of int.
    const auto overlap = [](std::int64_t a0, std::int64_t a_size, std::int64_t b0,
                            std::int64_t b_size) {
        const std::int64_t start = std::max(a0, b0);
        const std::int64_t end = std::min(a0 + a_size, b0 + b_size);
        return std::pair(static_cast<int>(start),
                         static_cast<int>(std::max<std::int64_t>(end - start, 0)));
    };
    const auto [x, width] = overlap(a.x, a.size.width, b.x, b.size.width);
    const auto [y, height] = overlap(a.y, a.size.height, b.y, b.size.height);
    if (width == 0 || height == 0) return {};
    return {x, y, {width, height}};
}

void load_floats(const StoredRows& from, ImageView<float> to) {
    assert(from.size == to.size && to.channels == (from.has_alpha() ? 4 : 3));
    for (int y = 0; y < from.size.height; ++y)
        visit_row(from, y, [&](const auto* row) { load_row(row, from, to.row(y)); });
}

void divide_by_alpha(ImageView<float> pixels) {
    assert(pixels.channels == 4);
    for (int y = 0; y < pixels.size.height; ++y) {
        float* p = pixels.row(y);
        for (int x = 0; x < pixels.size.width; ++x, p += 4) {
            // Of a denormal alpha the inverse is infinite: as good as 0.
            const float inverse = 1.0f / p[3];
            for (int c = 0; c < 3; ++c) p[c] = std::isinf(inverse) ? 0.0f : p[c] * inverse;
        }
    }
}

void multiply_by_alpha(ImageView<float> pixels) {
    assert(pixels.channels == 4);
    for (int y = 0; y < pixels.size.height; ++y) {
        float* p = pixels.row(y);
        for (int x = 0; x < pixels.size.width; ++x, p += 4)
            for (int c = 0; c < 3; ++c) p[c] *= p[3];
    }
}

std::size_t clear_bad_pixels(const StoredRows& stored, ImageView<float> decoded) {
    std::size_t bad = 0;
    const std::ptrdiff_t width = decoded.size.width;
    const int channels = decoded.channels;
    for (int y = 0; y < decoded.size.height; ++y) {
        visit_row(stored, y, [&](const auto* from) {
            float* to = decoded.row(y);
            // Both are looked at: a transform may turn a NaN into a number, and a large number
            // into infinity.
            if (any_bad(from, width * stored.channels) || any_bad(to, width * channels))
                bad += clear_bad_in_row(from, stored.channels, to, channels, decoded.size.width);
        });
    }
    return bad;
}

Image add_alpha(const Image& rgb) {
    assert(rgb.channels() == 3);
    Image rgba(rgb.size(), 4);
    for (int y = 0; y < rgb.height(); ++y) {
        const float* from = rgb.row(y);
        float* to = rgba.row(y);
        for (int x = 0; x < rgb.width(); ++x, from += 3, to += 4) {
            if (std::isnan(from[0])) continue;
            std::copy(from, from + 3, to);
            to[3] = 1.0f;
        }
    }
    return rgba;
}

}  // namespace chromeball
