#include "shot/track.h"

#include <algorithm>
#include <cmath>

namespace chromeball {
namespace {

struct Box {
    double left, top, right, bottom;
};

Box around(const Outline& outline, double further) {
    const double reach = outline.a + further;
    return {outline.cx - reach, outline.cy - reach, outline.cx + reach, outline.cy + reach};
}

}  // namespace

Window search_window(const Outline& last, double margin, const Window& picture) {
    const Box box = around(last, margin * last.a);
    const auto cut = [](double v, int from, int length) {
        return static_cast<int>(std::clamp(v, double(from), double(from) + length));
    };
    const int left = cut(std::floor(box.left), picture.x, picture.size.width);
    const int right = cut(std::ceil(box.right), picture.x, picture.size.width);
    const int top = cut(std::floor(box.top), picture.y, picture.size.height);
    const int bottom = cut(std::ceil(box.bottom), picture.y, picture.size.height);
    return {left, top, {right - left, bottom - top}};
}

bool well_inside(const Outline& outline, const Window& window, const Window& picture) {
    // A tenth of the radius: as far as the rim's surroundings are looked at.
    const Box box = around(outline, std::max(2.0, 0.1 * outline.a));
    const int right = window.x + window.size.width, bottom = window.y + window.size.height;
    return (window.x == picture.x || box.left >= window.x) &&
           (window.y == picture.y || box.top >= window.y) &&
           (right == picture.x + picture.size.width || box.right <= right) &&
           (bottom == picture.y + picture.size.height || box.bottom <= bottom);
}

Photo part_of(const Photo& photo, const Window& window) {
    Photo part = photo;
    part.window = window;
    const std::size_t pixel =
        bytes_per_value(photo.type) * static_cast<std::size_t>(photo.channels);
    const auto offset = [&](int x, int y) {
        return (static_cast<std::size_t>(y - photo.window.y) *
                    static_cast<std::size_t>(photo.window.size.width) +
                static_cast<std::size_t>(x - photo.window.x)) *
               pixel;
    };
    const std::size_t row = static_cast<std::size_t>(window.size.width) * pixel;
    part.pixels.resize(row * static_cast<std::size_t>(window.size.height));
    for (int y = 0; y < window.size.height; ++y)
        std::copy_n(
            photo.pixels.begin() + static_cast<std::ptrdiff_t>(offset(window.x, window.y + y)), row,
            part.pixels.begin() + static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(y)));
    return part;
}

}  // namespace chromeball
