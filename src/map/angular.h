#pragma once

#include <numbers>

#include "map/projection.h"

namespace chromeball {

/// Debevec's angular map ("light probe"): the middle shows -Z, the circle's edge +Z, +X is to the
/// right, +Y up, and the radius is the angle from -Z over pi.
/// Debevec: Rendering Synthetic Objects into Real Scenes, 1998; and his Light Probe Image Gallery.
struct Angular {
    static constexpr std::string_view name = "angular";

    template <class T>
    std::optional<Vec3<T>> to_direction(const Vec2<T>& position) const {
        using std::cos, std::sin;
        const T x = T(2.0) * position.x - T(1.0), y = T(1.0) - T(2.0) * position.y;
        const T r = length_of(x, y);
        if (value_of(r) > 1) return std::nullopt;
        const T theta = T(std::numbers::pi) * r;
        // sin(pi r) / r goes to pi in the middle.
        const T ratio = value_of(r) < 1e-9 ? T(std::numbers::pi) : sin(theta) / r;
        return Vec3<T>(ratio * x, ratio * y, -cos(theta));
    }

    /// +Z exactly, which is the whole edge, is put at its right end.
    template <class T>
    std::optional<Vec2<T>> to_position(const Vec3<T>& d) const {
        using std::atan2;
        const T across = length_of(d.x, d.y);
        if (value_of(across) == 0 && value_of(d.z) > 0) return Vec2<T>(T(1.0), T(0.5));
        const T r = atan2(across, -d.z) * T(std::numbers::inv_pi);
        // r / across goes to 1 / (pi |d|) in the middle.
        const T ratio =
            value_of(across) < 1e-9 * -value_of(d.z) ? T(-std::numbers::inv_pi) / d.z : r / across;
        return Vec2<T>(T(0.5) + T(0.5) * ratio * d.x, T(0.5) - T(0.5) * ratio * d.y);
    }

    double solid_angle(V2d position) const {
        const double r = std::hypot(2 * position.x - 1, 1 - 2 * position.y);
        if (r > 1) return 0;
        const double pi = std::numbers::pi;
        // sin(theta) dtheta dphi over (1/4) r dr dphi, the 1/4 since the radius spans half a side.
        return r < 1e-9 ? 4 * pi * pi : 4 * pi * std::sin(pi * r) / r;
    }

    /// Beyond 150 degrees from the middle, where the edge is drawn out along the circle.
    bool curved(V3d d) const { return d.z > 0.8660254037844386; }
};

}  // namespace chromeball
