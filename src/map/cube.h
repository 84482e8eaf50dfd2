#pragma once

#include <algorithm>
#include <array>

#include "map/projection.h"

namespace chromeball {

/// One face of a cube map: its cell in the picture and the directions its pixel rows and columns
/// run in.
struct Face {
    int column = 0;
    int row = 0;
    V3d right;
    V3d down;
};

/// Where the six faces lie and how they are turned: a definition, nothing else. Faces are in the
/// order +X -X +Y -Y +Z -Z of the directions they show.
struct CubeLayout {
    std::string_view name;
    int columns = 0;
    int rows = 0;
    std::array<Face, 6> faces;
    /// Faces read correctly from inside, forward = cross(right, down). Mirrored ones, as OpenGL
    /// stores them, have forward = -cross(right, down).
    bool mirrored = false;

    V3d forward(int face) const {
        const V3d f = faces[static_cast<std::size_t>(face)].right.cross(
            faces[static_cast<std::size_t>(face)].down);
        return mirrored ? -f : f;
    }
};

/// The face that shows a direction: the axis with the largest component; ties go to X, then Y.
inline int face_of(V3d d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    if (x >= y && x >= z) return d.x >= 0 ? 0 : 1;
    if (y >= z) return d.y >= 0 ? 2 : 3;
    return d.z >= 0 ? 4 : 5;
}

/// A cube map: a direction r meets the cube at r / max(|rx|, |ry|, |rz|).
class Cube {
public:
    static constexpr std::string_view name = "cube";

    /// The layout `openexr`: a column of six.
    Cube();
    /// The layout must outlive the projection.
    explicit Cube(const CubeLayout& layout);

    const CubeLayout& layout() const { return *layout_; }

    /// The face whose cell a position lies in; -1 in an empty cell or outside the picture.
    int face_at(V2d position) const {
        if (!(position.x >= 0 && position.x <= 1 && position.y >= 0 && position.y <= 1)) return -1;
        const int column =
            std::min(static_cast<int>(position.x * layout_->columns), layout_->columns - 1);
        const int row = std::min(static_cast<int>(position.y * layout_->rows), layout_->rows - 1);
        return cells_[static_cast<std::size_t>(row * layout_->columns + column)];
    }

    /// Across the face's plane: a and b run from -1 to 1 along right and down, and may go beyond.
    template <class T>
    Vec3<T> direction_on(int face, const T& a, const T& b) const {
        const Face& f = layout_->faces[static_cast<std::size_t>(face)];
        const V3d& n = forward_[static_cast<std::size_t>(face)];
        return unit(Vec3<T>(T(n.x) + a * T(f.right.x) + b * T(f.down.x),
                            T(n.y) + a * T(f.right.y) + b * T(f.down.y),
                            T(n.z) + a * T(f.right.z) + b * T(f.down.z)));
    }
    /// Back, for directions on the face's side of the cube.
    template <class T>
    Vec2<T> coordinates_on(int face, const Vec3<T>& d) const {
        const Face& f = layout_->faces[static_cast<std::size_t>(face)];
        const T depth = along(d, forward_[static_cast<std::size_t>(face)]);
        return {along(d, f.right) / depth, along(d, f.down) / depth};
    }

    template <class T>
    std::optional<Vec3<T>> to_direction(const Vec2<T>& position) const {
        const int face = face_at({value_of(position.x), value_of(position.y)});
        if (face < 0) return std::nullopt;
        const Face& f = layout_->faces[static_cast<std::size_t>(face)];
        const T across = position.x * T(layout_->columns) - T(f.column);
        const T downward = position.y * T(layout_->rows) - T(f.row);
        return direction_on(face, T(2.0) * across - T(1.0), T(2.0) * downward - T(1.0));
    }

    template <class T>
    std::optional<Vec2<T>> to_position(const Vec3<T>& d) const {
        const int face = face_of({value_of(d.x), value_of(d.y), value_of(d.z)});
        const Face& f = layout_->faces[static_cast<std::size_t>(face)];
        const Vec2<T> ab = coordinates_on(face, d);
        return Vec2<T>((T(f.column) + T(0.5) * (inside(ab.x) + T(1.0))) / T(layout_->columns),
                       (T(f.row) + T(0.5) * (inside(ab.y) + T(1.0))) / T(layout_->rows));
    }

    double solid_angle(V2d position) const {
        const int face = face_at(position);
        if (face < 0) return 0;
        const Face& f = layout_->faces[static_cast<std::size_t>(face)];
        const double a = 2 * (position.x * layout_->columns - f.column) - 1;
        const double b = 2 * (position.y * layout_->rows - f.row) - 1;
        const double square = 1 + a * a + b * b;
        // A unit of image area is 4 x columns x rows units of the face's plane.
        return 4.0 * layout_->columns * layout_->rows / (square * std::sqrt(square));
    }

    bool curved(V3d) const { return false; }

private:
    /// A coordinate on a face, kept off its border by a hair: that of the cell's right and lower
    /// side belongs to the next cell, which may show something else or nothing.
    template <class T>
    static T inside(const T& a) {
        constexpr double kInside = 1 - 1e-14;
        const double beyond = value_of(a) - std::clamp(value_of(a), -kInside, kInside);
        return a - T(beyond);
    }

    const CubeLayout* layout_;
    std::array<V3d, 6> forward_;
    std::array<signed char, 16> cells_{};
};

}  // namespace chromeball
