#include "render/patch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "resample/source.h"

namespace chromeball {
namespace {

/// Beyond the outline: a blurred rim, and an outline that is not quite right.
constexpr double kMoreThanRadius = 1.03, kMorePixels = 2;

/// A part of the picture with a margin of known pixels, and which of its pixels are wanted.
struct Hole {
    Image pixels;  // RGBA
    std::vector<char> wanted;
    Window window;
};

Hole hole_of(const Image& picture, const Outline& e) {
    const double c = std::cos(e.angle * std::numbers::pi / 180);
    const double s = std::sin(e.angle * std::numbers::pi / 180);
    const double a = e.a * kMoreThanRadius + kMorePixels, b = e.b * kMoreThanRadius + kMorePixels;
    Hole hole;
    hole.window = needed_window({e.cx, e.cy, a, b, e.angle}, {0, 0, picture.size()});
    const auto [left, top, size] = hole.window;
    if (size.pixels() == 0) return hole;
    hole.pixels = Image(size, 4);
    hole.wanted.resize(size.pixels());
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            std::copy_n(picture.pixel(left + x, top + y), 4, hole.pixels.pixel(x, y));
            const double dx = left + x + 0.5 - e.cx, dy = top + y + 0.5 - e.cy;
            const double u = (dx * c + dy * s) / a, v = (dy * c - dx * s) / b;
            hole.wanted[static_cast<std::size_t>(y * size.width + x)] = u * u + v * v <= 1;
        }
    return hole;
}

/// A first guess: means over ever larger squares of what is known, finest that knows anything.
void guess(Hole& hole) {
    struct Level {
        Size size;
        std::vector<float> sums;  // RGBA and weight
    };
    std::vector<Level> levels(1);
    levels[0] = {hole.pixels.size(), std::vector<float>(hole.pixels.size().pixels() * 5)};
    for (std::size_t i = 0; i < hole.wanted.size(); ++i) {
        if (hole.wanted[i]) continue;
        const auto width = static_cast<std::size_t>(hole.pixels.width());
        const float* p =
            hole.pixels.pixel(static_cast<int>(i % width), static_cast<int>(i / width));
        std::copy_n(p, 4, &levels[0].sums[5 * i]);
        levels[0].sums[5 * i + 4] = 1;
    }
    while (levels.back().size.width > 1 || levels.back().size.height > 1) {
        const Level& fine = levels.back();
        Level coarse{{(fine.size.width + 1) / 2, (fine.size.height + 1) / 2}, {}};
        coarse.sums.resize(coarse.size.pixels() * 5);
        for (int y = 0; y < fine.size.height; ++y)
            for (int x = 0; x < fine.size.width; ++x)
                for (int k = 0; k < 5; ++k)
                    coarse.sums[static_cast<std::size_t>(5 * (y / 2 * coarse.size.width + x / 2) +
                                                         k)] +=
                        fine.sums[static_cast<std::size_t>(5 * (y * fine.size.width + x) + k)];
        levels.push_back(std::move(coarse));
    }
    for (int y = 0; y < hole.pixels.height(); ++y)
        for (int x = 0; x < hole.pixels.width(); ++x) {
            if (!hole.wanted[static_cast<std::size_t>(y * hole.pixels.width() + x)]) continue;
            for (std::size_t l = 1; l < levels.size(); ++l) {
                const Level& level = levels[l];
                const float* sum = &level.sums[static_cast<std::size_t>(
                    5 * ((y >> l) * level.size.width + (x >> l)))];
                if (sum[4] == 0) continue;
                for (int c = 0; c < 4; ++c) hole.pixels.pixel(x, y)[c] = sum[c] / sum[4];
                break;
            }
        }
}

/// Each wanted pixel becomes the mean of its neighbours: Gauss-Seidel with over-relaxation, whose
/// best factor for a square of that size is 2 / (1 + sin(pi / n)).
void relax(Hole& hole) {
    const int width = hole.pixels.width(), height = hole.pixels.height();
    const int side = std::max(width, height);
    const auto factor = static_cast<float>(2 / (1 + std::sin(std::numbers::pi / side)));
    const int rounds = std::min(3 * side, 2000);
    for (int round = 0; round < rounds; ++round)
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                if (!hole.wanted[static_cast<std::size_t>(y * width + x)]) continue;
                float sum[4] = {};
                float count = 0;
                const auto add = [&](int nx, int ny) {
                    if (nx < 0 || ny < 0 || nx >= width || ny >= height) return;
                    const float* p = hole.pixels.pixel(nx, ny);
                    for (int c = 0; c < 4; ++c) sum[c] += p[c];
                    count += 1;
                };
                add(x - 1, y);
                add(x + 1, y);
                add(x, y - 1);
                add(x, y + 1);
                float* p = hole.pixels.pixel(x, y);
                for (int c = 0; c < 4; ++c) p[c] += factor * (sum[c] / count - p[c]);
            }
}

}  // namespace

void paint_out(Image& picture, const Outline& outline) {
    assert(picture.channels() == 4);
    Hole hole = hole_of(picture, outline);
    const bool known = std::any_of(hole.wanted.begin(), hole.wanted.end(),
                                   [](char wanted) { return wanted == 0; });
    if (!known) return;  // nothing around it
    guess(hole);
    relax(hole);
    for (int y = 0; y < hole.window.size.height; ++y)
        for (int x = 0; x < hole.window.size.width; ++x)
            std::copy_n(hole.pixels.pixel(x, y), 4,
                        picture.pixel(hole.window.x + x, hole.window.y + y));
}

void lay_over(Image& below, const Image& above) {
    assert(below.size() == above.size() && below.channels() == 4 && above.channels() == 4);
    for_each_band(below.height(), 16, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < below.width(); ++x) {
                const float* a = above.pixel(x, y);
                float* b = below.pixel(x, y);
                for (int c = 0; c < 4; ++c) b[c] = a[c] + (1 - a[3]) * b[c];
            }
    });
}

}  // namespace chromeball
