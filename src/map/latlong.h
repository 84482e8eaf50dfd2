#pragma once

#include <numbers>

#include "map/projection.h"

namespace chromeball {

/// Latitude and longitude as OpenEXR and UsdLux have them: longitude = pi (1 - 2u), latitude =
/// pi (1/2 - v), d = (cos lat sin lon, sin lat, cos lat cos lon). +Z in the middle, +X at u = 1/4.
struct LatLong {
    static constexpr std::string_view name = "latlong";

    template <class T>
    std::optional<Vec3<T>> to_direction(const Vec2<T>& position) const {
        using std::cos, std::sin;
        const T lon = T(std::numbers::pi) * (T(1.0) - T(2.0) * position.x);
        const T lat = T(std::numbers::pi) * (T(0.5) - position.y);
        return Vec3<T>(cos(lat) * sin(lon), sin(lat), cos(lat) * cos(lon));
    }

    /// At the poles u is 1/2.
    template <class T>
    std::optional<Vec2<T>> to_position(const Vec3<T>& d) const {
        using std::atan2;
        const T lon = atan2(d.x, d.z);
        const T lat = atan2(d.y, length_of(d.x, d.z));
        return Vec2<T>(T(0.5) - lon * T(0.5 * std::numbers::inv_pi),
                       T(0.5) - lat * T(std::numbers::inv_pi));
    }

    double solid_angle(V2d position) const {
        // A square of side 1 spans 2 pi of longitude and pi of latitude.
        return 2 * std::numbers::pi * std::numbers::pi *
               std::max(0.0, std::cos(std::numbers::pi * (0.5 - position.y)));
    }

    /// Within 15 degrees of a pole, where meridians fan out.
    bool curved(V3d d) const {
        constexpr double kSine = 0.9659258262890683;  // sin 75 degrees
        return std::abs(d.y) > kSine;
    }
};

}  // namespace chromeball
