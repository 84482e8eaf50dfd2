#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/image.h"
#include "core/photo.h"

namespace chromeball::detecting {

/// One channel of owned pixels, rows from top to bottom without padding.
template <class T>
struct Raster {
    Size size;
    std::vector<T> values;

    Raster() = default;
    explicit Raster(Size s) : size(s), values(s.pixels()) {}
    T* row(int y) { return values.data() + offset(y); }
    const T* row(int y) const { return values.data() + offset(y); }

private:
    std::size_t offset(int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width);
    }
};

/// Bilinear; NaN outside the picture.
template <class T, class Value>
float sample(const Raster<T>& picture, double x, double y, const Value& value) {
    const auto [w, h] = picture.size;
    if (!(x >= 0 && y >= 0 && x <= w && y <= h)) return std::numeric_limits<float>::quiet_NaN();
    const double fx = std::clamp(x - 0.5, 0.0, w - 1.0), fy = std::clamp(y - 0.5, 0.0, h - 1.0);
    const int x0 = std::min(static_cast<int>(fx), std::max(0, w - 2));
    const int y0 = std::min(static_cast<int>(fy), std::max(0, h - 2));
    const int x1 = std::min(x0 + 1, w - 1), y1 = std::min(y0 + 1, h - 1);
    const auto u = static_cast<float>(fx - x0), v = static_cast<float>(fy - y0);
    const T *top = picture.row(y0), *bottom = picture.row(y1);
    return (1 - v) * ((1 - u) * value(top[x0]) + u * value(top[x1])) +
           v * ((1 - u) * value(bottom[x0]) + u * value(bottom[x1]));
}

/// The photo as detection looks at it: one channel, 16 bits, tone-compressed so that bright and
/// dark parts have edges alike.
struct Grey {
    Raster<std::uint16_t> pixels;
    /// What a code stands for in (roughly) linear light: the 50 % point of a rim lies where the
    /// pixel is half ball, half background, which is a statement about light, not about codes.
    std::vector<float> linear;
};

/// One step of the pyramid, values 0 to 1. A position of the photo is the level's times scale
/// (continuous coordinates, so no half-pixel terms).
struct Level {
    Raster<float> grey;
    double scale_x = 1;
    double scale_y = 1;
    float noise = 0;  ///< typical gradient of flat parts, per pixel; never 0

    double scale() const { return 0.5 * (scale_x + scale_y); }
};

/// Alpha is left out; NaN counts as black, infinity as the brightest.
Grey grey_of(const Photo& photo);

/// A level as a photo of its own, whose codes stand for the same light.
Grey grey_of(const Level& level, const std::vector<float>& linear);

/// Levels from at most `longest` pixels on the long side down to about 40, each half the one
/// before.
std::vector<Level> pyramid(const Raster<std::uint16_t>& picture, int longest);

/// The finest level on which the radius (pixels of the photo) is at most `largest`.
const Level& level_for(const std::vector<Level>& levels, double photo_radius, double largest);

}  // namespace chromeball::detecting
