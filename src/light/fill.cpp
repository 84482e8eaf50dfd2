#include "light/fill.h"

#include <algorithm>

#include "core/parallel.h"

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

}  // namespace chromeball
