#include "shot/track.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace chromeball {
namespace {

struct Box {
    double left, top, right, bottom;
};

Box around(const Outline& outline, double further) {
    const double reach = outline.a + further;
    return {outline.cx - reach, outline.cy - reach, outline.cx + reach, outline.cy + reach};
}

std::size_t pixel_bytes(const Photo& photo) {
    return bytes_per_value(photo.type) * static_cast<std::size_t>(photo.channels);
}

}  // namespace

std::optional<Outline> outline_between(const Outline& before, const Outline& after, double part) {
    constexpr double kMostGrowth = 2, kFarthest = 6;  // times the radius
    constexpr double kMostBeyond = 3;
    if (part > kMostBeyond) return std::nullopt;
    const double small = std::min(before.a, after.a), large = std::max(before.a, after.a);
    const double way = std::hypot(after.cx - before.cx, after.cy - before.cy);
    if (large > kMostGrowth * small || way > kFarthest * small) return std::nullopt;
    const auto mean = [&](double one, double other) { return one + part * (other - one); };
    // Which way it is longer says little so far from where it was seen.
    const double radius = mean(std::sqrt(before.a * before.b), std::sqrt(after.a * after.b));
    if (radius < small / kMostGrowth) return std::nullopt;
    return Outline{mean(before.cx, after.cx), mean(before.cy, after.cy), radius, radius, 0};
}

bool may_be_same(const Outline& one, const Outline& other) {
    constexpr double kMostGrowth = 1.25;
    const double small = std::min(one.a, other.a), large = std::max(one.a, other.a);
    return large < kMostGrowth * small && std::hypot(one.cx - other.cx, one.cy - other.cy) < small;
}

std::optional<V2d> motion_between(const V2d& before, const V2d& after, double part) {
    // A motion and its opposite look alike.
    const V2d turned = before.dot(after) < 0 ? -after : after;
    const double shorter = std::min(before.length(), after.length());
    if ((turned - before).length() > 0.5 * shorter) return std::nullopt;
    return before + (turned - before) * part;
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

Window shared_window(const Window& one, const Window& other) {
    const auto shared = [](int a, int a_length, int b, int b_length) {
        const int first = std::max(a, b);
        return std::pair{first, std::max(0, std::min(a + a_length, b + b_length) - first)};
    };
    const auto [x, width] = shared(one.x, one.size.width, other.x, other.size.width);
    const auto [y, height] = shared(one.y, one.size.height, other.y, other.size.height);
    return {x, y, {width, height}};
}

Photo empty_part(Photo description, const Window& window) {
    Photo part = std::move(description);
    part.window = shared_window(part.window, window);
    part.pixels = PixelBytes(part.window.size.pixels() * pixel_bytes(part));
    return part;
}

void copy_shared(const Photo& photo, Photo& part) {
    const Window shared = shared_window(photo.window, part.window);
    const std::size_t pixel = pixel_bytes(photo);
    const auto at = [&](const Window& window, int y) {
        const auto row = static_cast<std::size_t>(y - window.y);
        return (row * static_cast<std::size_t>(window.size.width) +
                static_cast<std::size_t>(shared.x - window.x)) *
               pixel;
    };
    const std::size_t bytes = static_cast<std::size_t>(shared.size.width) * pixel;
    if (bytes == 0) return;
    for (int y = shared.y; y < shared.y + shared.size.height; ++y)
        std::memcpy(part.pixels.data() + at(part.window, y),
                    photo.pixels.data() + at(photo.window, y), bytes);
}

}  // namespace chromeball
