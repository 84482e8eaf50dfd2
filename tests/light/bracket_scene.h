#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "light/merge.h"

// Brackets of a scene given by a formula, so that what comes out can be compared.

namespace chromeball::test {

using Rgb = std::array<double, 3>;
using Scene = std::function<Rgb(double x, double y)>;  // pixels of the reference

/// Smooth noise of -1 to 1, the same at every call, that repeats nowhere; x, y in its grains.
inline double grain(double x, double y) {
    const auto corner = [](double i, double j) {
        const double h = std::sin(i * 127.1 + j * 311.7) * 43758.5453;
        return 2 * (h - std::floor(h)) - 1;
    };
    const double i = std::floor(x), j = std::floor(y);
    const auto ease = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
    const double u = ease(x - i), v = ease(y - j);
    return (1 - v) * ((1 - u) * corner(i, j) + u * corner(i + 1, j)) +
           v * ((1 - u) * corner(i, j + 1) + u * corner(i + 1, j + 1));
}

/// Six stops from left to right with texture, coarse and fine; every channel its own.
inline Rgb textured(double x, double y) {
    const double slow = std::exp2(6 * x / 240 - 3);
    const double texture = 1 + 0.3 * grain(x / 23, y / 23) + 0.2 * grain(x / 5, y / 5);
    return {slow * texture, 0.8 * slow * texture, 0.6 * slow * (2 - texture)};
}

/// Even squares of 16 pixels of seven stops, mixed.
inline Rgb squares(double x, double y) {
    const int i = static_cast<int>(x / 16), j = static_cast<int>(y / 16);
    const double v = std::exp2(((i * 7 + j * 13) % 29) / 4.0 - 4);
    return {v, 0.85 * v, 0.7 * v};
}

inline double srgb_encoded(double v) {
    v = std::clamp(v, 0.0, 1.0);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

/// A camera's curve with a foot and a shoulder, rising, 0 to 1.
inline double contrasty(double v) {
    const double e = srgb_encoded(v);
    return 0.4 * e + 0.6 * e * e * (3 - 2 * e);
}

struct Take {
    double exposure = 1;
    V2d shift{0, 0};
    std::function<double(double)> curve = srgb_encoded;
    bool integers = true;  ///< 8 bits; else linear floats that clip at 1
    double noise = 0.002;  ///< of white
};

/// One photo of a scene.
inline ExposedPhoto photo_of(const Scene& scene, Size size, const Take& take, unsigned seed = 1) {
    auto pixels = std::make_shared<Image>(size, 3);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, take.noise);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const Rgb light = scene(x + 0.5 - take.shift.x, y + 0.5 - take.shift.y);
            for (std::size_t c = 0; c < 3; ++c) {
                const double v = std::clamp(light[c] * take.exposure + noise(random), 0.0, 1.0);
                pixels->pixel(x, y)[c] =
                    static_cast<float>(take.integers ? std::round(255 * take.curve(v)) / 255 : v);
            }
        }
    ExposedPhoto photo;
    photo.name = "take" + std::to_string(seed);
    photo.size = size;
    photo.step = take.integers ? 1.0 / 255 : 0;
    photo.white = 1;
    photo.read = [pixels](int first, int last, ImageView<float> rows) {
        for (int y = first; y < last; ++y)
            std::copy_n(pixels->row(y), pixels->width() * 3, rows.row(y - first));
    };
    return photo;
}

/// Several of one scene, no noise alike.
inline std::vector<ExposedPhoto> photos_of(const Scene& scene, Size size,
                                           const std::vector<Take>& takes) {
    std::vector<ExposedPhoto> photos;
    for (std::size_t k = 0; k < takes.size(); ++k)
        photos.push_back(photo_of(scene, size, takes[k], static_cast<unsigned>(k + 1)));
    return photos;
}

inline std::vector<MergePhoto> to_merge(const std::vector<ExposedPhoto>& photos,
                                        const std::vector<Take>& takes) {
    std::vector<MergePhoto> all;
    for (std::size_t k = 0; k < photos.size(); ++k)
        all.push_back({photos[k], takes[k].exposure, takes[k].shift});
    return all;
}

/// Root mean square of log2(merged / scene) over the pixels of a window, all channels.
inline double rms_stops(const Image& merged, const Scene& scene, const Window& window) {
    double sum = 0, count = 0;
    for (int y = window.y; y < window.y + window.size.height; ++y)
        for (int x = window.x; x < window.x + window.size.width; ++x) {
            const Rgb light = scene(x + 0.5, y + 0.5);
            for (std::size_t c = 0; c < 3; ++c) {
                const double v = std::max(1e-9, static_cast<double>(merged.pixel(x, y)[c]));
                const double off = std::log2(v / light[c]);
                sum += off * off, count += 1;
            }
        }
    return std::sqrt(sum / count);
}

}  // namespace chromeball::test
