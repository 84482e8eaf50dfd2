#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "map/dual.h"

namespace chromeball {

/// An orthonormal matrix of determinant 1 that acts on column vectors.
class Rotation {
public:
    /// The identity.
    Rotation() = default;

    /// Counter-clockwise by degrees, seen from the axis' tip.
    static Rotation about_x(double degrees);
    static Rotation about_y(double degrees);
    static Rotation about_z(double degrees);
    /// Ry(yaw) Rx(pitch) Rz(roll).
    static Rotation yaw_pitch_roll(double yaw, double pitch, double roll);

    /// The rotation nearest to 9 numbers, row by row, or to the upper left of 16. Nothing if their
    /// columns are off orthonormal by more than 1e-3, or mirror.
    static std::optional<Rotation> nearest(std::span<const double> numbers);

    /// As nearest(), of a worldToCamera matrix as EXR files hold it: 16 numbers, row-major, acting
    /// on row vectors (p' = p M). `axes` names the camera's own frame: "opengl" (looks along -Z, +Y
    /// up), "opencv" (along +Z, +Y down), "renderman" (along +Z, +Y up, left-handed). The result
    /// takes our camera frame to the world. Nothing for an unknown name too.
    static std::optional<Rotation> camera_to_world(std::span<const double> world_to_camera,
                                                   std::string_view axes);

    Rotation inverse() const;
    double at(int row, int column) const { return m_[static_cast<std::size_t>(3 * row + column)]; }
    const std::array<double, 9>& rows() const { return m_; }
    bool is_identity() const { return *this == Rotation(); }
    bool operator==(const Rotation&) const = default;

    template <class T>
    Vec3<T> operator*(const Vec3<T>& v) const {
        return {T(m_[0]) * v.x + T(m_[1]) * v.y + T(m_[2]) * v.z,
                T(m_[3]) * v.x + T(m_[4]) * v.y + T(m_[5]) * v.z,
                T(m_[6]) * v.x + T(m_[7]) * v.y + T(m_[8]) * v.z};
    }
    Rotation operator*(const Rotation& other) const;

private:
    explicit Rotation(const std::array<double, 9>& m) : m_(m) {}
    static Rotation about(int axis, double degrees);

    std::array<double, 9> m_{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

}  // namespace chromeball
