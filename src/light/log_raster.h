#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "core/image.h"
#include "light/response.h"

namespace chromeball {

/// What photos of different exposures have in common: the light's logarithm, and how much it is
/// worth (one over its variance; 0 where it is clipped, black or outside).
struct LogRaster {
    Size size;
    std::vector<float> value, weight;

    explicit LogRaster(Size s = {}) : size(s), value(s.pixels()), weight(s.pixels()) {}
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
               static_cast<std::size_t>(x);
    }
};

/// What of the colour is compared: a channel, or the luminance, for which no channel may clip.
constexpr int kLuminance = 3;

/// The luminance; but a channel, such as the blue of leaves, where it shows much more of the pair
/// of neighbours that share least.
///
/// order   the photos' numbers; those beside each other are neighbours
int channel_to_compare(std::span<const ExposedPhoto> photos, std::span<const int> order);

/// A part of the photo, means of factor x factor pixels. Weights know the photo's noise, and no
/// logarithm is taken to be known to better than 3 %.
///
/// channel   0 to 2, or kLuminance
LogRaster log_raster(const ExposedPhoto& photo, const Response& response, const Window& region,
                     int factor, int channel);

/// A raster at all sizes, each half the one before, the finest first.
struct LogPyramid {
    std::vector<LogRaster> levels;  ///< less their local means
    LogRaster coarsest;             ///< whole
};

/// Smooth, since between noisy pixels a mean of two is less noisy, which draws shifts to halves;
/// less the mean around each pixel, since over gentle slopes an error of the curve or of the
/// exposure would look like a shift.
LogPyramid log_pyramid(LogRaster finest);

/// What a raster says at a place between pixels.
struct LogSample {
    double value, weight;
};

/// Bilinear, weight 0 where a neighbour is missing.
inline LogSample sample(const LogRaster& r, double x, double y) {
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    if (x0 < 0 || y0 < 0 || x0 + 1 >= r.size.width || y0 + 1 >= r.size.height) return {0, 0};
    const std::size_t at = r.at(x0, y0), below = r.at(x0, y0 + 1);
    const float least =
        std::min({r.weight[at], r.weight[at + 1], r.weight[below], r.weight[below + 1]});
    if (!(least > 0)) return {0, 0};
    const auto u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
    const float top = (1 - u) * r.value[at] + u * r.value[at + 1];
    const float bottom = (1 - u) * r.value[below] + u * r.value[below + 1];
    return {static_cast<double>((1 - v) * top + v * bottom), static_cast<double>(least)};
}

/// Per pixel: central differences, which do not go with the pixel's own noise; nothing at an edge.
inline std::optional<V2d> slope(const LogRaster& r, int x, int y) {
    if (x < 1 || y < 1 || x + 1 >= r.size.width || y + 1 >= r.size.height) return std::nullopt;
    const std::size_t left = r.at(x - 1, y), right = r.at(x + 1, y);
    const std::size_t above = r.at(x, y - 1), below = r.at(x, y + 1);
    if (!(std::min({r.weight[left], r.weight[right], r.weight[above], r.weight[below]}) > 0))
        return std::nullopt;
    return V2d(static_cast<double>(r.value[right] - r.value[left]) / 2,
               static_cast<double>(r.value[below] - r.value[above]) / 2);
}

}  // namespace chromeball
