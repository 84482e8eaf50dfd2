#include "light/fill.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "resample/resample.h"

namespace chromeball {
namespace {

/// Means of 2 x 2 cells over those that are known.
Image halved(const Image& cube) {
    Image out({cube.width() / 2, cube.height() / 2}, 4);
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x) {
            float* to = out.pixel(x, y);
            float count = 0;
            for (int k = 0; k < 4; ++k) {
                const float* p = cube.pixel(2 * x + k % 2, 2 * y + k / 2);
                if (!(p[3] > 0)) continue;
                for (int c = 0; c < 3; ++c) to[c] += p[c];
                ++count;
            }
            if (count == 0) continue;
            for (int c = 0; c < 3; ++c) to[c] /= count;
            to[3] = 1;
        }
    return out;
}

/// Relaxes the unknown cells towards the means of their neighbours.
void relax(Image& picture, const std::vector<std::uint32_t>& unknown, int rounds) {
    const ViewCube cube(picture.width());
    std::vector<std::array<float, 3>> next(unknown.size());
    float* all = picture.row(0);
    for (int round = 0; round < rounds; ++round) {
        for_each_band(static_cast<int>(unknown.size()), 4096, [&](int first, int last) {
            for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last);
                 ++i) {
                std::array<float, 3> sum{};
                for (const std::uint32_t n : cube.neighbours(unknown[i]))
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += 0.25F * all[4 * n + c];
                next[i] = sum;
            }
        });
        for (std::size_t i = 0; i < unknown.size(); ++i)
            std::copy_n(next[i].data(), 3, all + 4 * static_cast<std::size_t>(unknown[i]));
    }
}

}  // namespace

void fill_gaps(Image& picture) {
    const int size = picture.width();
    std::vector<std::uint32_t> unknown;
    const std::size_t cells = picture.size().pixels();
    float* all = picture.row(0);
    for (std::size_t i = 0; i < cells; ++i)
        if (!(all[4 * i + 3] > 0)) unknown.push_back(static_cast<std::uint32_t>(i));
    if (unknown.empty()) return;
    if (unknown.size() == cells) {
        for (std::size_t i = 0; i < cells; ++i) std::fill_n(all + 4 * i, 3, 0.0F);
        return;
    }
    if (size % 2 == 0 && size > 2) {
        Image coarse = halved(picture);
        fill_gaps(coarse);
        for (int y = 0; y < coarse.height(); ++y)
            for (int x = 0; x < coarse.width(); ++x) coarse.pixel(x, y)[3] = 1;
        const Image start = resized(coarse, size);
        for (const std::uint32_t i : unknown)
            std::copy_n(start.row(0) + 4 * static_cast<std::size_t>(i), 3,
                        all + 4 * static_cast<std::size_t>(i));
    } else {
        // Somewhere to start from.
        std::array<float, 3> mean{};
        for (std::size_t i = 0; i < cells; ++i)
            if (all[4 * i + 3] > 0)
                for (std::size_t c = 0; c < 3; ++c)
                    mean[c] += all[4 * i + c] / static_cast<float>(cells - unknown.size());
        for (const std::uint32_t i : unknown)
            std::copy_n(mean.data(), 3, all + 4 * static_cast<std::size_t>(i));
    }
    relax(picture, unknown, 30);
}

void fill_unbelieved(Image& map, const Image& confidence, const Layout& layout) {
    constexpr float kLeast = 0.02F, kDark = 1e-6F;
    constexpr int kCube = 128;
    const Layout& cube = *find_layout("openexr");
    const auto believed = [&](int x, int y) {
        return std::min(confidence.pixel(x, y)[0] / kLeast, 1.0F);
    };
    const bool has_alpha = map.channels() > 3;
    Image weighed(map.size(), 4);
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const float* from = map.pixel(x, y);
            float* to = weighed.pixel(x, y);
            for (int c = 0; c < 3; ++c) to[c] = from[c] * believed(x, y);
            to[3] = (has_alpha ? from[3] : 1) * believed(x, y);
        }
    // Colours and their weight alike, so that one can be divided by the other.
    ResampleOptions plain;
    plain.keeps_light = false;
    Image around = resample(map_source(weighed, layout), cube, kCube, plain);
    float* p = around.row(0);
    for (std::size_t i = 0; i < around.size().pixels(); ++i, p += 4) {
        const bool known = p[3] > 0.5F;
        for (int c = 0; c < 3; ++c) p[c] = known ? std::log2(std::max(p[c] / p[3], kDark)) : 0;
        p[3] = known ? 1 : 0;
    }
    fill_gaps(around);
    p = around.row(0);
    for (std::size_t i = 0; i < around.size().pixels(); ++i, p += 4) {
        for (int c = 0; c < 3; ++c) p[c] = std::exp2(p[c]);
        p[3] = 1;
    }
    const Image fill = resample(map_source(around, cube), layout, map.width() / layout.width_units);
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            float* to = map.pixel(x, y);
            const float* from = fill.pixel(x, y);
            if (!(from[3] > 0)) continue;  // outside of the layout's directions
            const float* known = weighed.pixel(x, y);
            for (int c = 0; c < 3; ++c) to[c] = known[c] + (1 - known[3]) * from[c] / from[3];
            if (has_alpha) to[3] = 1;
        }
}

}  // namespace chromeball
