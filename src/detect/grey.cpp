#include "detect/grey.h"

#include <Imath/half.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace chromeball::detecting {
namespace {

constexpr int kCodes = 65536;
constexpr int kSmallestLevel = 40;

/// Red, green, blue weights close to luminance; a mirror ball has little colour of its own.
template <class T>
double mixed(const T* pixel, int channels) {
    if (channels < 3) return static_cast<double>(pixel[0]);
    return 0.3 * static_cast<double>(pixel[0]) + 0.5 * static_cast<double>(pixel[1]) +
           0.2 * static_cast<double>(pixel[2]);
}

/// The same mix in whole numbers: this loop sees every pixel of a large photo.
template <class T>
void mix_integers(const Photo& photo, Raster<std::uint16_t>& out) {
    const auto* in = reinterpret_cast<const T*>(photo.pixels.data());
    constexpr unsigned to_16_bits = sizeof(T) == 1 ? 257 : 1;
    const std::size_t count = out.values.size();
    const auto channels = static_cast<std::size_t>(photo.channels);
    if (channels < 3) {
        for (std::size_t i = 0; i < count; ++i)
            out.values[i] = static_cast<std::uint16_t>(in[i * channels] * to_16_bits);
        return;
    }
    for (std::size_t i = 0; i < count; ++i) {
        const T* p = in + i * channels;
        out.values[i] =
            static_cast<std::uint16_t>(((77u * p[0] + 128u * p[1] + 51u * p[2]) * to_16_bits) >> 8);
    }
}

float to_float(float value) { return value; }
float to_float(Imath::half value) { return static_cast<float>(value); }

template <class T>
std::vector<float> mix_floats(const Photo& photo, std::size_t count) {
    const auto* in = reinterpret_cast<const T*>(photo.pixels.data());
    const auto channels = static_cast<std::size_t>(photo.channels);
    std::vector<float> out(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::array<float, 3> rgb{};
        for (std::size_t c = 0; c < std::min<std::size_t>(channels, 3); ++c)
            rgb[c] = to_float(in[i * channels + c]);
        const double value = mixed(rgb.data(), photo.channels);
        // Negative values come from colour-space changes; for finding edges they are black.
        out[i] = std::isnan(value) ? 0.f
                                   : static_cast<float>(std::clamp(
                                         value, 0.0, double{std::numeric_limits<float>::max()}));
    }
    return out;
}

float quantile(std::vector<float>& values, double part) {
    if (values.empty()) return 0;
    const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

/// log(1 + x / knee) up to a high percentile: linear in the dark, logarithmic above, so neither the
/// sun nor the unit of the file matters.
Grey compressed(const std::vector<float>& light, Size size) {
    std::vector<float> some;
    const std::size_t step = std::max<std::size_t>(1, light.size() / 100000);
    for (std::size_t i = 0; i < light.size(); i += step)
        if (light[i] > 0) some.push_back(light[i]);
    const double knee = std::max<double>(0.5 * quantile(some, 0.5), 1e-30);
    const double top = std::max<double>(quantile(some, 0.998), 2 * knee);
    const double gain = (kCodes - 1) / std::log1p(top / knee);

    Grey grey{Raster<std::uint16_t>(size), std::vector<float>(kCodes)};
    for (std::size_t i = 0; i < light.size(); ++i) {
        const double code = gain * std::log1p(light[i] / knee);
        grey.pixels.values[i] = static_cast<std::uint16_t>(std::min<double>(code, kCodes - 1));
    }
    for (int i = 0; i < kCodes; ++i)
        grey.linear[static_cast<std::size_t>(i)] = static_cast<float>(std::expm1(i / gain));
    return grey;
}

/// sRGB's curve; for other encodings (log) it is wrong in contrast but right enough for the middle
/// of an edge.
std::vector<float> srgb_light() {
    std::vector<float> light(kCodes);
    for (int i = 0; i < kCodes; ++i) {
        const double v = i / double{kCodes - 1};
        light[static_cast<std::size_t>(i)] =
            static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return light;
}

cv::Mat matrix(const Raster<float>& raster) {
    return {raster.size.height, raster.size.width, CV_32F,
            const_cast<float*>(raster.values.data())};
}

Raster<float> shrunk(const cv::Mat& picture, Size size, double gain) {
    cv::Mat small;
    cv::resize(picture, small, cv::Size(size.width, size.height), 0, 0, cv::INTER_AREA);
    Raster<float> raster(size);
    cv::Mat target = matrix(raster);
    small.convertTo(target, CV_32F, gain);
    return raster;
}

/// A low quantile of differences between neighbours: what flat parts of the picture hold.
float noise_of(const Raster<float>& grey) {
    std::vector<float> steps;
    const int stride = std::max(1, grey.size.height / 200);
    for (int y = 0; y < grey.size.height; y += stride)
        for (int x = 2; x < grey.size.width; x += 3)
            steps.push_back(std::abs(grey.row(y)[x] - grey.row(y)[x - 1]));
    // The lower third of a noisy flat picture's differences ends at 0.43 sigma sqrt(2). 8-bit
    // quantisation is the floor: 0.3 of a code.
    return std::max(quantile(steps, 0.33) / 0.6f, 0.3f / 255);
}

}  // namespace

Grey grey_of(const Photo& photo) {
    const Size size = photo.window.size;
    if (is_integer(photo.type)) {
        Grey grey{Raster<std::uint16_t>(size), srgb_light()};
        if (photo.type == PixelType::u8)
            mix_integers<std::uint8_t>(photo, grey.pixels);
        else
            mix_integers<std::uint16_t>(photo, grey.pixels);
        return grey;
    }
    const auto light = photo.type == PixelType::f16 ? mix_floats<Imath::half>(photo, size.pixels())
                                                    : mix_floats<float>(photo, size.pixels());
    return compressed(light, size);
}

std::vector<Level> pyramid(const Raster<std::uint16_t>& picture, int longest) {
    const auto [width, height] = picture.size;
    const double shrink = std::max(1.0, std::max(width, height) / double(longest));
    const auto reduced = [](int full, double by) {
        return std::max(1, static_cast<int>(std::lround(full / by)));
    };
    const cv::Mat full(height, width, CV_16U, const_cast<std::uint16_t*>(picture.values.data()));
    std::vector<Level> levels;
    Size size{reduced(width, shrink), reduced(height, shrink)};
    while (true) {
        Level level;
        level.grey = levels.empty() ? shrunk(full, size, 1.0 / (kCodes - 1))
                                    : shrunk(matrix(levels.back().grey), size, 1.0);
        level.scale_x = double(width) / size.width;
        level.scale_y = double(height) / size.height;
        level.noise = noise_of(level.grey);
        levels.push_back(std::move(level));
        if (std::max(size.width, size.height) < 2 * kSmallestLevel ||
            std::min(size.width, size.height) < 16)
            return levels;
        size = {reduced(size.width, 2), reduced(size.height, 2)};
    }
}

const Level& level_for(const std::vector<Level>& levels, double photo_radius, double largest) {
    for (const Level& level : levels)
        if (photo_radius / level.scale() <= largest) return level;
    return levels.back();
}

}  // namespace chromeball::detecting
