#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "resample/filter.h"
#include "resample/source.h"

namespace chromeball {

/// Bilinear between the four pixels around a position; all four must exist.
inline Rgbw bilinear_tap(ImageView<const float> pixels, V2d p) {
    const double x = p.x - 0.5, y = p.y - 0.5;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    const float* top = pixels.pixel(x0, y0);
    const float* below = top + pixels.stride;
    Rgbw sum;
    sum.add((1 - fx) * (1 - fy), top);
    sum.add(fx * (1 - fy), top + 4);
    sum.add((1 - fx) * fy, below);
    sum.add(fx * fy, below + 4);
    return sum;
}

/// A slope at a sample from the differences to the ones before and after: their mean, but 0 at
/// extremes and at most three times the smaller, so that a cubic through the samples is monotonic
/// wherever they are. Fritsch, Carlson: Monotone Piecewise Cubic Interpolation, 1980.
inline float cubic_slope(float before, float after) {
    const float low = 3 * std::min(before, after), high = 3 * std::max(before, after);
    const float mean = 0.5F * (before + after);
    return std::max(std::min(mean, std::max(low, 0.0F)), std::min(high, 0.0F));
}

/// The cubic between p[1] and p[2], t in [0, 1].
inline float monotone_cubic(const float (&p)[4], float t) {
    const float rise = p[2] - p[1];
    const float m1 = cubic_slope(p[1] - p[0], rise), m2 = cubic_slope(rise, p[3] - p[2]);
    const float bend = m1 + m2 - 2 * rise, c2 = rise - m1 - bend;
    const float value = p[1] + t * (m1 + t * (c2 + t * bend));
    return std::clamp(value, std::min(p[1], p[2]), std::max(p[1], p[2]));
}

/// Between the 4 x 4 pixels around a position, first along rows. Sharper than bilinear where the
/// picture is magnified; never outside the range of the pixels around; and as every slope enters
/// the integrals to its left and right with opposite signs, the mean over the picture is that of
/// its pixels. All 16 must exist.
inline Rgbw cubic_tap(ImageView<const float> pixels, V2d p) {
    const double x = p.x - 0.5, y = p.y - 0.5;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    float sum[4];
    for (int c = 0; c < 4; ++c) {
        float rows[4];
        for (int j = 0; j < 4; ++j) {
            const float* row = pixels.pixel(x0 - 1, y0 - 1 + j) + c;
            rows[j] = monotone_cubic({row[0], row[4], row[8], row[12]}, fx);
        }
        sum[c] = monotone_cubic(rows, fy);
    }
    return {sum[0], sum[1], sum[2], sum[3]};
}

/// Where a source's projection P puts a direction, in its prepared pixels, and what is there.
template <class P>
class Lookup {
public:
    Lookup(const Source& source)
        : source_(source),
          projection_(std::get<P>(source.projection)),
          pixels_(source.pixels.view()) {}

    const P& projection() const { return projection_; }

    template <class T>
    std::optional<Vec2<T>> locate(const Vec3<T>& d) const {
        if constexpr (std::is_same_v<P, Cube>) {
            const int face = face_of({value_of(d.x), value_of(d.y), value_of(d.z)});
            const Vec2<T> ab = projection_.coordinates_on(face, d);
            const double n = source_.face_size, padded = n + 2 * source_.border;
            return Vec2<T>(T(source_.border) + T(0.5 * n) * (ab.x + T(1.0)),
                           T(face * padded + source_.border) + T(0.5 * n) * (ab.y + T(1.0)));
        } else {
            const auto position = projection_.to_position(d);
            if (!position) return std::nullopt;
            return source_.to_pixels(*position);
        }
    }

    /// Whether everything within `reach` of a position can be taken from the picture without a look
    /// at seams, or at a ball's rim or the photo's edge.
    bool whole(V2d at, V2d reach) const {
        if constexpr (std::is_same_v<P, Cube>) {
            const double padded = source_.face_size + 2 * source_.border;
            const double y = at.y - padded * std::floor(at.y / padded);
            return at.x - reach.x >= 0.5 && at.x + reach.x <= padded - 0.5 && y - reach.y >= 0.5 &&
                   y + reach.y <= padded - 0.5;
        } else if constexpr (std::is_same_v<P, LatLong>) {
            return at.x - reach.x >= 0.5 && at.x + reach.x <= pixels_.size.width - 0.5 &&
                   at.y - reach.y >= 0.5 && at.y + reach.y <= pixels_.size.height - 0.5;
        } else if constexpr (std::is_same_v<P, MirrorBall>) {
            const double inner = 1 - (source_.rim.last_depth() + reach.length()) / source_.ball->b;
            return at.x - reach.x >= source_.left && at.x + reach.x <= source_.right &&
                   at.y - reach.y >= source_.top && at.y + reach.y <= source_.bottom && inner > 0 &&
                   EllipseRows(*source_.ball).at(at.x, at.y).square < inner * inner;
        } else {
            return true;
        }
    }

    /// A cubic's value at a position; nothing where some pixel that it needs must not be used.
    std::optional<Rgbw> cubic(V2d at) const {
        constexpr V2d kReach(filter::kCubicReach, filter::kCubicReach);
        if (source_.ball && !whole(at, kReach)) return std::nullopt;
        Rgbw sum = cubic_tap(pixels_, at);
        if (!source_.ball) return sum;
        if (!(sum.w > filter::kPure)) return std::nullopt;
        const float scale = 1 / sum.w;
        return Rgbw{sum.r * scale, sum.g * scale, sum.b * scale, 1};
    }

    /// Colour and weight at a position; nothing where the picture has nothing to show.
    std::optional<Rgbw> tap(V2d at) const {
        if (source_.ball) return ball_tap(at);
        return bilinear_tap(pixels_, at);
    }

private:
    std::optional<Rgbw> ball_tap(V2d at) const {
        if (!(at.x >= source_.left && at.x <= source_.right && at.y >= source_.top &&
              at.y <= source_.bottom))
            return std::nullopt;
        const auto at_rim = source_.rim.tap(at.x, at.y);
        const Rgbw sum = at_rim ? *at_rim : bilinear_tap(pixels_, at);
        if (!(sum.w > 0)) return std::nullopt;
        const float scale = 1 / sum.w;
        return Rgbw{sum.r * scale, sum.g * scale, sum.b * scale, 1};
    }

    const Source& source_;
    const P& projection_;
    ImageView<const float> pixels_;
};

}  // namespace chromeball
