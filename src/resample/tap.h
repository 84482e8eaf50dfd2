#pragma once

#include <cmath>
#include <optional>

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

    /// Whether everything within `reach` of a position lies on the same side of all seams.
    bool seamless(V2d at, V2d reach) const {
        if constexpr (std::is_same_v<P, Cube>) {
            const double padded = source_.face_size + 2 * source_.border;
            const double y = at.y - padded * std::floor(at.y / padded);
            return at.x - reach.x >= 0.5 && at.x + reach.x <= padded - 0.5 && y - reach.y >= 0.5 &&
                   y + reach.y <= padded - 0.5;
        } else if constexpr (std::is_same_v<P, LatLong>) {
            return at.x - reach.x >= 0.5 && at.x + reach.x <= pixels_.size.width - 0.5 &&
                   at.y - reach.y >= 0.5 && at.y + reach.y <= pixels_.size.height - 0.5;
        } else {
            return true;
        }
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
