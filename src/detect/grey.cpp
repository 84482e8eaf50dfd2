#include "detect/grey.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace chromeball::detecting {
namespace {

constexpr int kCodes = 65536;
constexpr int kSmallestLevel = 40;

/// Red, green, blue in parts close to luminance, in whole numbers; a mirror ball has little colour
/// of its own. This loop sees every pixel of a large photo.
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

[[gnu::always_inline]] inline std::uint32_t all_bits_if(bool condition) {
    return 0u - static_cast<std::uint32_t>(condition);
}

/// A half from its bits; infinity becomes 65536. Without branches, for compilers to make vectors
/// of.
[[gnu::always_inline]] inline float from_half(std::uint16_t half) {
    const std::uint32_t magnitude = half & 0x7fffu, sign = (half & 0x8000u) << 16;
    const std::uint32_t rebased = (magnitude << 13) + (112u << 23);
    // Below 2^-14 there is no implied leading one: put one there and take it away again.
    const auto small =
        std::bit_cast<std::uint32_t>(std::bit_cast<float>(rebased + (1u << 23)) - 0x1p-14f);
    const std::uint32_t is_small = all_bits_if(magnitude < 0x400);
    const std::uint32_t not_a_number = all_bits_if(magnitude > 0x7c00) & 0x7fc00000u;
    return std::bit_cast<float>((small & is_small) | (rebased & ~is_small) | sign | not_a_number);
}

/// Negative values come from colour-space changes; for finding edges they are black, as NaN is.
[[gnu::always_inline]] inline float as_light(float value) {
    return value > 0 ? std::min(value, std::numeric_limits<float>::max()) : 0.f;
}

constexpr std::size_t kAtOnce = 1024;  // pixels

/// Light of at most kAtOnce pixels.
[[gnu::always_inline]] inline void mix_floats(const float* in, int channels, std::size_t count,
                                              float* out) {
    const auto step = static_cast<std::size_t>(channels);
    if (channels < 3) {
        for (std::size_t i = 0; i < count; ++i) out[i] = as_light(in[i * step]);
        return;
    }
    const auto mixed = [](const float* p) {
        return as_light(0.3f * p[0] + 0.5f * p[1] + 0.2f * p[2]);
    };
    if (channels == 3)
        for (std::size_t i = 0; i < count; ++i) out[i] = mixed(in + i * 3);
    else
        for (std::size_t i = 0; i < count; ++i) out[i] = mixed(in + i * step);
}

[[gnu::always_inline]] inline void mix_floats(const std::uint16_t* in, int channels,
                                              std::size_t count, float* out) {
    std::array<float, 4 * kAtOnce> values;
    const std::size_t most = values.size() / static_cast<std::size_t>(channels);
    for (std::size_t done = 0; done < count; done += most) {
        const std::size_t pixels = std::min(most, count - done);
        const std::size_t first = done * static_cast<std::size_t>(channels);
        for (std::size_t i = 0; i < pixels * static_cast<std::size_t>(channels); ++i)
            values[i] = from_half(in[first + i]);
        mix_floats(values.data(), channels, pixels, out + done);
    }
}

float quantile(std::vector<float>& values, double part) {
    if (values.empty()) return 0;
    const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

/// Natural logarithm of a finite value >= 1, to 1e-7: the same bits on any processor, and in steps
/// that compilers turn into vectors.
[[gnu::always_inline]] inline float logarithm(float value) {
    // value = m 2^e with m from sqrt(1/2) to sqrt(2); log m = 2 atanh s, as its series.
    constexpr std::uint32_t kRootOfHalf = 0x3f3504f3;
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(value) - kRootOfHalf;
    const auto e = static_cast<float>(static_cast<std::int32_t>(bits) >> 23);
    const float m = std::bit_cast<float>((bits & 0x7fffffu) + kRootOfHalf);
    const float s = (m - 1) / (m + 1), q = s * s;
    return e * std::numbers::ln2_v<float> + 2 * s * (1 + q * (1 / 3.f + q * (1 / 5.f + q / 7)));
}

/// How light becomes codes: code = per_log log(1 + light per_knee), light per_knee at most `most`.
struct Compression {
    float per_knee, per_log, most;
};

/// The codes of so many pixels. This loop sees every pixel of a large photo, so there is a copy for
/// wider registers; products are not contracted there, so both give the same bits.
template <class T>
[[gnu::always_inline]] inline void compress(const T* in, int channels, std::size_t count,
                                            const Compression& how, std::uint16_t* codes) {
    std::array<float, kAtOnce> light;
    for (std::size_t first = 0; first < count; first += light.size()) {
        const std::size_t some_more = std::min(light.size(), count - first);
        mix_floats(in + first * static_cast<std::size_t>(channels), channels, some_more,
                   light.data());
        for (std::size_t i = 0; i < some_more; ++i) {
            const float code =
                how.per_log * logarithm(1 + std::min(light[i] * how.per_knee, how.most));
            codes[first + i] = static_cast<std::uint16_t>(
                static_cast<std::int32_t>(std::min(code, float{kCodes - 1})));
        }
    }
}

#if defined(__x86_64__) && defined(__GNUC__)
template <class T>
[[gnu::target("avx2")]] void compress_by_8(const T* in, int channels, std::size_t count,
                                           const Compression& how, std::uint16_t* codes) {
    compress(in, channels, count, how, codes);
}
template <class T>
void compress_fast(const T* in, int channels, std::size_t count, const Compression& how,
                   std::uint16_t* codes) {
    if (__builtin_cpu_supports("avx2"))
        compress_by_8(in, channels, count, how, codes);
    else
        compress(in, channels, count, how, codes);
}
#else
template <class T>
void compress_fast(const T* in, int channels, std::size_t count, const Compression& how,
                   std::uint16_t* codes) {
    compress(in, channels, count, how, codes);
}
#endif

/// log(1 + x / knee) up to a high percentile: linear in the dark, logarithmic above, so neither the
/// sun nor the unit of the file matters.
template <class T>
Grey compressed(const Photo& photo) {
    const auto* in = reinterpret_cast<const T*>(photo.pixels.data());
    const std::size_t count = photo.window.size.pixels();
    const auto channels = static_cast<std::size_t>(photo.channels);
    std::vector<float> some;
    const std::size_t step = std::max<std::size_t>(1, count / 100000);
    for (std::size_t i = 0; i < count; i += step) {
        float light = 0;
        mix_floats(in + i * channels, photo.channels, 1, &light);
        if (light > 0) some.push_back(light);
    }
    const double knee = std::max<double>(0.5 * quantile(some, 0.5), 1e-30);
    const double top = std::max<double>(quantile(some, 0.998), 2 * knee);
    const double gain = (kCodes - 1) / std::log1p(top / knee);

    Grey grey{Raster<std::uint16_t>(photo.window.size), std::vector<float>(kCodes)};
    const Compression how{static_cast<float>(1 / knee), static_cast<float>(gain),
                          static_cast<float>(std::min(top / knee, 1e38))};
    compress_fast(in, photo.channels, count, how, grey.pixels.values.data());
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
    return photo.type == PixelType::f16 ? compressed<std::uint16_t>(photo)
                                        : compressed<float>(photo);
}

Grey grey_of(const Level& level, const std::vector<float>& linear) {
    Grey grey{Raster<std::uint16_t>(level.grey.size), linear};
    std::ranges::transform(level.grey.values, grey.pixels.values.begin(), [](float v) {
        return static_cast<std::uint16_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * (kCodes - 1)));
    });
    return grey;
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
