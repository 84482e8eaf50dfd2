#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "map/orientation.h"
#include "resample/filter.h"
#include "resample/tap.h"

namespace chromeball {

/// What an output pixel's sub-samples add up to.
struct Sum {
    double r = 0, g = 0, b = 0, alpha = 0, total = 0;

    void add(double weight, const std::optional<Rgbw>& tap) {
        total += weight;
        if (!tap) return;
        r += weight * tap->r;
        g += weight * tap->g;
        b += weight * tap->b;
        alpha += weight * tap->w;
    }
    void store(float* pixel) const {
        if (!(total > 0)) return;
        pixel[0] = static_cast<float>(r / total);
        pixel[1] = static_cast<float>(g / total);
        pixel[2] = static_cast<float>(b / total);
        pixel[3] = static_cast<float>(std::min(alpha / total, 1.0));
    }
};

/// Sub-samples along one side of an output pixel whose footprint is that many source pixels long.
inline int sample_count(double footprint) {
    using namespace filter;
    return static_cast<int>(
        std::clamp(std::ceil(kTapsPerPixel * footprint), double{kLeastTaps}, double{kMostTaps}));
}

/// One output picture: target T drawn from source P.
template <class T, class P>
class Pass {
public:
    Pass(const T& target, Size size, const Rotation& source_from_target, const Lookup<P>& lookup)
        : target_(target), size_(size), rotation_(source_from_target), lookup_(lookup) {}

    Sum fast(int x, int y) const {
        Sum sum;
        sum.add(1, exact_tap(position(x + 0.5, y + 0.5)));
        return sum;
    }

    Sum adaptive(int x, int y) const {
        const auto [at, steep] = footprint(x, y);
        if (!at) return exact_sum(x, y, filter::kUnknownTaps, filter::kUnknownTaps);
        const V2d by_x(at->x.du, at->y.du), by_y(at->x.dv, at->y.dv);
        const int nx = sample_count(by_x.length()), ny = sample_count(by_y.length());
        const V2d centre = value_of(*at);
        const V2d reach(0.5 * (std::abs(by_x.x) + std::abs(by_y.x)),
                        0.5 * (std::abs(by_x.y) + std::abs(by_y.y)));
        if (std::max(by_x.length(), by_y.length()) < filter::kMagnified) {
            if (const auto tap = lookup_.cubic(centre)) {
                Sum sum;
                sum.add(1, tap);
                return sum;
            }
        }
        if ((steep && !nearly_straight(x, y)) || !lookup_.whole(centre, reach))
            return exact_sum(x, y, nx, ny);
        Sum sum;
        for (int j = 0; j < ny; ++j) {
            const V2d row = centre + by_y * ((j + 0.5) / ny - 0.5);
            for (int i = 0; i < nx; ++i)
                sum.add(1, lookup_.tap(row + by_x * ((i + 0.5) / nx - 0.5)));
        }
        return sum;
    }

private:
    struct Footprint {
        std::optional<Vec2<Dual>> at;  ///< source position, derivatives per output pixel
        bool steep = false;            ///< whether steps from there cannot be taken as straight
    };

    V2d position(double x, double y) const { return {x / size_.width, y / size_.height}; }

    /// Where the source shows a pixel's middle, if it does.
    std::optional<V2d> middle(int x, int y) const {
        const auto d = target_.to_direction(position(x + 0.5, y + 0.5));
        return d ? lookup_.locate(rotation_ * *d) : std::nullopt;
    }

    /// Whether a pixel's middle lies between its neighbours' where straight lines put it.
    bool nearly_straight(int x, int y) const {
        const auto at = middle(x, y);
        const auto left = middle(x - 1, y), right = middle(x + 1, y), up = middle(x, y - 1),
                   down = middle(x, y + 1);
        if (!at || !left || !right || !up || !down) return false;
        const auto bend = [&](V2d before, V2d after) {
            const V2d off = before + after - *at * 2.0;
            return std::max(std::abs(off.x), std::abs(off.y));
        };
        return std::max(bend(*left, *right), bend(*up, *down)) < filter::kNearlyStraight;
    }

    Footprint footprint(int x, int y) const {
        // Off the middle by a little that no symmetry hits: a pole or the ball's axis has no
        // Jacobian.
        constexpr double kOff = 1e-4;
        const Vec2<Dual> p{Dual((x + 0.5 + kOff) / size_.width, 1.0 / size_.width, 0),
                           Dual((y + 0.5 + kOff) / size_.height, 0, 1.0 / size_.height)};
        const auto d = target_.to_direction(p);
        if (!d) return {};
        const Vec3<Dual> turned = rotation_ * *d;
        const bool steep =
            target_.curved(value_of(*d)) || lookup_.projection().curved(value_of(turned));
        auto at = lookup_.locate(turned);
        if (at) {  // back to the middle
            at->x.value -= kOff * (at->x.du + at->x.dv);
            at->y.value -= kOff * (at->y.du + at->y.dv);
        }
        return {at, steep};
    }

    std::optional<Rgbw> exact_tap(V2d p) const {
        const auto d = target_.to_direction(p);
        if (!d) return std::nullopt;
        const auto at = lookup_.locate(rotation_ * *d);
        return at ? lookup_.tap(*at) : std::nullopt;
    }

    Sum exact_sum(int x, int y, int nx, int ny) const {
        Sum sum;
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i)
                sum.add(1, exact_tap(position(x + (i + 0.5) / nx, y + (j + 0.5) / ny)));
        return sum;
    }

    const T& target_;
    Size size_;
    Rotation rotation_;
    const Lookup<P>& lookup_;
};

/// Rows handed to a thread at a time; a constant, so that nothing depends on the number of threads.
constexpr int kBandRows = 8;

/// Calls draw(x, y) for all pixels and stores what it sums up.
template <class Draw>
void for_each_pixel(ImageView<float> out, const Watch& watch, const Draw& draw) {
    for_each_band(
        out.size.height, kBandRows,
        [&](int first, int last) {
            for (int y = first; y < last; ++y)
                for (int x = 0; x < out.size.width; ++x) draw(x, y).store(out.pixel(x, y));
        },
        watch);
}

}  // namespace chromeball
