#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "core/photo.h"
#include "map/camera.h"

namespace chromeball::painted {

/// A number in [0, 1) that looks random, from whole numbers.
inline double hash(int x, int y, int z) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^
                      static_cast<std::uint32_t>(y) * 0xd8163841u ^
                      static_cast<std::uint32_t>(z) * 0xcb1ab31fu;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return static_cast<double>(h ^ (h >> 15)) / 4294967296.0;
}

/// Smooth random values on a lattice.
inline double value_noise(V3d p) {
    const auto cell = [](double v) { return static_cast<int>(std::floor(v)); };
    const int x = cell(p.x), y = cell(p.y), z = cell(p.z);
    const auto ease = [](double t) { return t * t * (3 - 2 * t); };
    const double u = ease(p.x - x), v = ease(p.y - y), w = ease(p.z - z);
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        const int a = i & 1, b = i >> 1 & 1, c = i >> 2;
        sum += (a ? u : 1 - u) * (b ? v : 1 - v) * (c ? w : 1 - w) * hash(x + a, y + b, z + c);
    }
    return sum;
}

/// A street: sky with clouds, houses with windows along the horizon, paving, a low sun. Linear.
inline V3d street(V3d d) {
    const double azimuth = std::atan2(d.x, -d.z) / std::numbers::pi * 180 + 180;
    const double elevation = std::asin(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi * 180;
    const auto plot = [](double degrees) { return static_cast<int>(std::floor(degrees)); };
    const int house = plot(azimuth / 9);
    if (elevation > 0 && elevation < 8 + 25 * hash(house, 1, 2)) {
        const int column = plot(azimuth / 1.5), floor = plot(elevation / 2.5);
        const bool window = hash(column, floor, 3) > 0.55;
        const double paint = 0.15 + 0.5 * hash(house, 4, 5);
        return window ? V3d(0.05, 0.06, 0.08) + V3d(1.2 * (hash(column, floor, 7) > 0.85))
                      : V3d(paint, 0.9 * paint, 0.75 * paint);
    }
    const double rough =
        0.6 * value_noise(d * 9) + 0.3 * value_noise(d * 31) + 0.2 * value_noise(d * 90);
    if (elevation <= 0) {
        const double x = d.x / std::min(d.y, -0.02), z = d.z / std::min(d.y, -0.02);
        const bool light = (plot(x / 0.7) + plot(z / 0.7)) % 2 == 0;
        return V3d(0.30, 0.26, 0.22) * (light ? 1.3 : 0.7) * (0.4 + rough);
    }
    const V3d sun = V3d(0.5, 0.6, 0.62).normalized();
    return V3d(0.5, 0.65, 0.9) * (0.4 + rough) + V3d(30) * (d.dot(sun) > 0.995);
}

/// A ball in front of a pinhole camera; lengths are the ball's radii.
struct Scene {
    Size size{720, 480};
    Camera camera{1000.0, {360, 240}};
    V3d centre{-1.2, 0.8, -9};
    std::function<V3d(V3d)> world = street;
    /// Colour of the ball where it is hit (unit normal) and what it mirrors.
    std::function<V3d(V3d normal, V3d mirrored)> surface = [](V3d, V3d mirrored) {
        return mirrored * 0.85;
    };
    /// What lies before everything, by position in the picture; negative: nothing.
    std::function<V3d(double x, double y)> before = [](double, double) { return V3d(-1); };
    int samples = 2;  ///< a side of a pixel

    Outline outline() const {
        const Cone cone{centre.normalized(), std::asin(1 / centre.length())};
        return outline_of(cone, camera).value();
    }

    V3d seen(double x, double y) const {
        if (const V3d near = before(x, y); near.x >= 0) return near;
        const double f = *camera.focal;
        const V3d q =
            V3d((x - camera.principal.x) / f, (camera.principal.y - y) / f, -1).normalized();
        const double along = q.dot(centre);
        const double inside = along * along - centre.length2() + 1;
        if (inside <= 0 || along <= 0) return world(q);
        const V3d n = q * (along - std::sqrt(inside)) - centre;
        return surface(n, world(q - n * (2 * q.dot(n))));
    }

    /// Linear light, three channels.
    std::vector<float> light() const {
        std::vector<float> values;
        values.reserve(3 * size.pixels());
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x) {
                V3d sum(0);
                for (int i = 0; i < samples * samples; ++i)
                    sum +=
                        seen(x + (i % samples + 0.5) / samples, y + (i / samples + 0.5) / samples);
                sum /= samples * samples;
                for (const double v : {sum.x, sum.y, sum.z})
                    values.push_back(static_cast<float>(v));
            }
        return values;
    }
};

inline Photo empty_photo(Size size, PixelType type, int channels) {
    Photo photo;
    photo.type = type;
    photo.channels = channels;
    photo.window = {0, 0, size};
    photo.display = size;
    photo.pixels.resize(size.pixels() * static_cast<std::size_t>(channels) * bytes_per_value(type));
    return photo;
}

inline Photo float_photo(const std::vector<float>& light, Size size) {
    Photo photo = empty_photo(size, PixelType::f32, 3);
    std::memcpy(photo.pixels.data(), light.data(), photo.pixels.size());
    return photo;
}

/// 8-bit sRGB, with noise of `noise` codes.
inline Photo camera_photo(const std::vector<float>& light, Size size, double noise = 1) {
    Photo photo = empty_photo(size, PixelType::u8, 3);
    std::mt19937 random(1);
    std::normal_distribution<double> grain(0, noise);
    for (std::size_t i = 0; i < light.size(); ++i) {
        const double v = std::clamp<double>(light[i], 0, 1);
        const double code = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
        photo.pixels[i] =
            static_cast<std::byte>(std::lround(std::clamp(255 * code + grain(random), 0.0, 255.0)));
    }
    return photo;
}

inline Photo camera_photo(const Scene& scene, double noise = 1) {
    return camera_photo(scene.light(), scene.size, noise);
}

}  // namespace chromeball::painted
