#pragma once

#include <Imath/ImathVec.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace chromeball {

using Imath::V2d;
using Imath::V3d;

/// Unit vectors spread evenly over the sphere along a spiral; the same ones every time.
inline std::vector<V3d> directions_on_sphere(int count) {
    std::vector<V3d> directions;
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0));  // the golden angle
    for (int i = 0; i < count; ++i) {
        const double y = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - y * y);
        directions.emplace_back(r * std::sin(turn * i), y, r * std::cos(turn * i));
    }
    return directions;
}

/// The 26 directions of a cube's face centres, edge centres and corners, where shapes have seams
/// and poles; not of unit length.
inline std::vector<V3d> cube_directions() {
    std::vector<V3d> directions;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x != 0 || y != 0 || z != 0) directions.emplace_back(x, y, z);
    return directions;
}

/// Radians; keeps its digits for small angles.
inline double angle_between(V3d a, V3d b) { return std::atan2(a.cross(b).length(), a.dot(b)); }

inline double degrees(double radians) { return radians * 180 / std::numbers::pi; }
inline double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// A unit vector `off` radians from -Z, turned by `around` from +X towards +Y.
inline V3d off_axis(double off, double around) {
    return {std::sin(off) * std::cos(around), std::sin(off) * std::sin(around), -std::cos(off)};
}

}  // namespace chromeball
