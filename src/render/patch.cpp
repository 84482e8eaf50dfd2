#include "render/patch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "render/patch_match.h"
#include "resample/source.h"

namespace chromeball {
namespace {

/// Beyond the outline: an outline that is not quite right, and the rim's blur.
constexpr double kMoreThanRadius = 1.05, kMorePixels = 2, kMoreBlurs = 2.5;
/// Pieces are looked for in a picture whose hole is at most that wide.
constexpr int kWidestHole = 128;
/// Colours and, much weaker in numbers, how rough the picture is there.
constexpr int kChannels = 5;
constexpr float kRoughness = 4;

/// An ellipse in a picture, and the part of the picture around it that is looked at.
struct Hole {
    Outline ellipse;
    double cosine, sine;
    Window window;  // of the hole
    Window near;    // from where pieces are taken

    Hole(const Outline& e, Size size)
        : ellipse(e),
          cosine(std::cos(e.angle * std::numbers::pi / 180)),
          sine(std::sin(e.angle * std::numbers::pi / 180)),
          window(needed_window(e, {0, 0, size})) {
        // One and a half radii more on each side.
        near = needed_window({e.cx, e.cy, 2.5 * e.a, 2.5 * e.b, e.angle}, {0, 0, size});
    }
    bool has(int x, int y) const {
        const double dx = x + 0.5 - ellipse.cx, dy = y + 0.5 - ellipse.cy;
        const double u = (dx * cosine + dy * sine) / ellipse.a,
                     v = (dy * cosine - dx * sine) / ellipse.b;
        return u * u + v * v <= 1;
    }
};

float brightness(const float* p) { return p[0] + p[1] + p[2]; }

/// Light between 0 and 1, so that lamps do not count for more than all else: x / (x + usual).
struct Compression {
    float usual;
    float squeezed(float x) const { return std::max(0.0F, x) / (std::max(0.0F, x) + usual); }
    float freed(float t) const {
        const float most = std::clamp(t, 0.0F, 0.9999F);
        return usual * most / (1 - most);
    }
};

Compression compression_for(const Image& picture, const Hole& hole) {
    double sum = 0;
    std::size_t count = 0;
    const auto& [left, top, size] = hole.near;
    for (int y = top; y < top + size.height; ++y)
        for (int x = left; x < left + size.width; ++x) {
            const float light = brightness(picture.pixel(x, y));
            if (hole.has(x, y) || !(light > 0)) continue;
            sum += std::log(static_cast<double>(light) / 3);
            ++count;
        }
    return {count > 0 ? static_cast<float>(std::exp(sum / static_cast<double>(count))) : 1.0F};
}

/// What is near the hole, `step` pixels as one.
Holed looks_near(const Image& picture, const Hole& hole, const Compression& compression, int step) {
    const auto& [left, top, near] = hole.near;
    const Size size{(near.width + step - 1) / step, (near.height + step - 1) / step};
    Holed out{Image(size, kChannels), std::vector<char>(size.pixels())};
    const int right = left + near.width, bottom = top + near.height;
    for_each_band(size.height, 16, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < size.width; ++x) {
                float* to = out.look.pixel(x, y);
                float count = 0;
                bool unknown = false;
                for (int py = top + y * step; py < std::min(bottom, top + (y + 1) * step); ++py)
                    for (int px = left + x * step; px < std::min(right, left + (x + 1) * step);
                         ++px) {
                        const float* p = picture.pixel(px, py);
                        // Beyond a plate's data window nothing is known either.
                        unknown = unknown || hole.has(px, py) || !(p[3] > 0);
                        for (int c = 0; c < 3; ++c) to[c] += compression.squeezed(p[c]);
                        const float here = compression.squeezed(brightness(p));
                        const auto rough = [&](int nx, int ny) {
                            if (nx >= right || ny >= bottom || hole.has(nx, ny)) return 0.0F;
                            const float next =
                                compression.squeezed(brightness(picture.pixel(nx, ny)));
                            return kRoughness * std::abs(next - here);
                        };
                        to[3] += rough(px + 1, py);
                        to[4] += rough(px, py + 1);
                        count += 1;
                    }
                for (int c = 0; c < kChannels; ++c) to[c] = unknown ? 0 : to[c] / count;
                out.hole[out.at(x, y)] = unknown;
            }
    });
    return out;
}

/// How much what is around the hole is off from the pieces that are laid there, continued into it.
Image correction_of(const Holed& near, const std::vector<std::optional<GridPlace>>& from) {
    Holed off{Image(near.look.size(), 3), std::vector<char>(near.hole.size(), 1)};
    for (int y = 0; y < near.look.height(); ++y)
        for (int x = 0; x < near.look.width(); ++x) {
            const auto& place = from[near.at(x, y)];
            if (near.hole[near.at(x, y)] || !place) continue;
            for (int c = 0; c < 3; ++c)
                off.look.pixel(x, y)[c] =
                    near.look.pixel(x, y)[c] - near.look.pixel(place->x, place->y)[c];
            off.hole[off.at(x, y)] = 0;
        }
    fill_smoothly(off);
    return std::move(off.look);
}

/// Draws the hole's pixels from the pieces found for a coarser picture of it.
class Painter {
public:
    Painter(const Image& picture, const Hole& hole, const Compression& compression, int step)
        : picture_(picture),
          hole_(hole),
          compression_(compression),
          step_(step),
          near_(looks_near(picture, hole, compression, step)),
          from_(likest_places(near_)) {
        found_ = std::any_of(from_.begin(), from_.end(), [](const auto& p) { return p; });
        if (found_) {
            correction_ = correction_of(near_, from_);
            return;
        }
        fill_smoothly(near_);
    }

    void paint(int x, int y, float* to) const {
        const auto& [left, top, size] = hole_.near;
        const double u = (x - left + 0.5) / step_ - 0.5, v = (y - top + 0.5) / step_ - 0.5;
        const int u0 = static_cast<int>(std::floor(u)), v0 = static_cast<int>(std::floor(v));
        const auto fu = seam(u - u0), fv = seam(v - v0);
        float sum[4] = {}, off[3] = {}, weights = 0;
        for (int k = 0; k < 4; ++k) {
            const int i = std::clamp(u0 + k % 2, 0, near_.look.width() - 1);
            const int j = std::clamp(v0 + k / 2, 0, near_.look.height() - 1);
            const float weight = (k % 2 ? fu : 1 - fu) * (k / 2 ? fv : 1 - fv);
            if (!(weight > 0)) continue;
            if (!found_) {
                const float* p = near_.look.pixel(i, j);
                for (int c = 0; c < 3; ++c) sum[c] += weight * compression_.freed(p[c]);
                sum[3] += weight;
                weights += weight;
                continue;
            }
            const auto& place = from_[near_.at(i, j)];
            if (!place) continue;
            const int px = std::clamp(x + (place->x - i) * step_, left, left + size.width - 1);
            const int py = std::clamp(y + (place->y - j) * step_, top, top + size.height - 1);
            const float* p = picture_.pixel(px, py);
            for (int c = 0; c < 4; ++c) sum[c] += weight * p[c];
            for (int c = 0; c < 3; ++c) off[c] += weight * correction_.pixel(i, j)[c];
            weights += weight;
        }
        if (!(weights > 0)) return;
        for (int c = 0; c < 4; ++c) sum[c] /= weights;
        for (int c = 0; c < 3; ++c)
            to[c] = !found_ ? sum[c]
                            : compression_.freed(compression_.squeezed(sum[c]) + off[c] / weights);
        to[3] = sum[3];
    }

private:
    /// How much of the next piece: over a pixel or so only, since means of several have less grain.
    float seam(double part) const {
        if (!found_) return static_cast<float>(part);
        return static_cast<float>(std::clamp(0.75 * step_ * (part - 0.5) + 0.5, 0.0, 1.0));
    }

    const Image& picture_;
    const Hole& hole_;
    const Compression& compression_;
    int step_;
    Holed near_;
    std::vector<std::optional<GridPlace>> from_;
    bool found_ = false;
    Image correction_;
};

}  // namespace

void paint_out(Image& picture, const Outline& outline, double blur) {
    assert(picture.channels() == 4);
    const double more = kMorePixels + kMoreBlurs * blur;
    const Hole hole({outline.cx, outline.cy, outline.a * kMoreThanRadius + more,
                     outline.b * kMoreThanRadius + more, outline.angle},
                    picture.size());
    const auto& [left, top, size] = hole.window;
    if (size.pixels() == 0) return;
    bool known = false;  // anything around it
    for (int y = hole.near.y; y < hole.near.y + hole.near.size.height && !known; ++y)
        for (int x = hole.near.x; x < hole.near.x + hole.near.size.width && !known; ++x)
            known = !hole.has(x, y) && picture.pixel(x, y)[3] > 0;
    if (!known) return;
    int step = 1;
    while (std::max(size.width, size.height) > step * kWidestHole) step *= 2;
    const Compression compression = compression_for(picture, hole);
    const Painter painter(picture, hole, compression, step);
    // Painted aside: pieces come from the picture as it was.
    Image painted(size, 4);
    for_each_band(size.height, 16, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < size.width; ++x)
                if (hole.has(left + x, top + y))
                    painter.paint(left + x, top + y, painted.pixel(x, y));
    });
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            if (hole.has(left + x, top + y))
                std::copy_n(painted.pixel(x, y), 4, picture.pixel(left + x, top + y));
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
