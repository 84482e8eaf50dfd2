#include "shot/track.h"

#include <algorithm>
#include <cmath>
#include <cstring>

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

std::optional<Outline> outline_between(const Outline& before, const Outline& after, double part) {
    constexpr double kMostGrowth = 2, kFarthest = 6;  // times the radius
    const double small = std::min(before.a, after.a), large = std::max(before.a, after.a);
    const double way = std::hypot(after.cx - before.cx, after.cy - before.cy);
    if (large > kMostGrowth * small || way > kFarthest * small) return std::nullopt;
    const auto mean = [&](double one, double other) { return one + part * (other - one); };
    // Which way it is longer says little so far from where it was seen.
    const double radius = mean(std::sqrt(before.a * before.b), std::sqrt(after.a * after.b));
    return Outline{mean(before.cx, after.cx), mean(before.cy, after.cy), radius, radius, 0};
}

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

Photo part_of(Photo photo, const Window& window) {
    const std::size_t pixel =
        bytes_per_value(photo.type) * static_cast<std::size_t>(photo.channels);
    const std::size_t row = static_cast<std::size_t>(window.size.width) * pixel;
    const std::size_t stored = static_cast<std::size_t>(photo.window.size.width) * pixel;
    const auto first = static_cast<std::size_t>(window.y - photo.window.y) * stored +
                       static_cast<std::size_t>(window.x - photo.window.x) * pixel;
    // In place: rows only move towards the beginning.
    std::byte* pixels = photo.pixels.data();
    for (std::size_t y = 0; y < static_cast<std::size_t>(window.size.height); ++y)
        std::memmove(pixels + y * row, pixels + first + y * stored, row);
    photo.pixels.resize(row * static_cast<std::size_t>(window.size.height));
    photo.window = window;
    return photo;
}

}  // namespace chromeball
