#include "map/orientation.h"

#include <Imath/ImathMatrix.h>

#include <cmath>
#include <numbers>

namespace chromeball {
namespace {

using Imath::M33d;

/// Rows, the largest deviation of its columns from an orthonormal right-handed frame.
double deviation(const M33d& m) {
    const M33d square = m.transposed() * m;
    double largest = std::abs(m.determinant() - 1);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            largest = std::max(largest, std::abs(square[i][j] - (i == j ? 1 : 0)));
    return largest;
}

/// Polar decomposition: the mean of a matrix and its inverse transposed goes to the nearest
/// rotation.
M33d orthonormalised(M33d m) {
    for (int step = 0; step < 8; ++step) m = (m + m.inverse().transposed()) * 0.5;
    return m;
}

std::array<double, 9> numbers_of(const M33d& m) {
    return {m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]};
}

}  // namespace

Rotation Rotation::about(int axis, double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    // Quarter turns are exact, so that presets move pixels without blurring them.
    const double quarters = degrees / 90;
    const bool exact = quarters == std::round(quarters);
    const double c = exact ? std::round(std::cos(a)) : std::cos(a);
    const double s = exact ? std::round(std::sin(a)) : std::sin(a);
    const auto i = static_cast<std::size_t>((axis + 1) % 3),
               j = static_cast<std::size_t>((axis + 2) % 3);
    Rotation r;
    r.m_[3 * i + i] = c;
    r.m_[3 * i + j] = -s;
    r.m_[3 * j + i] = s;
    r.m_[3 * j + j] = c;
    return r;
}

Rotation Rotation::about_x(double degrees) { return about(0, degrees); }
Rotation Rotation::about_y(double degrees) { return about(1, degrees); }
Rotation Rotation::about_z(double degrees) { return about(2, degrees); }

Rotation Rotation::yaw_pitch_roll(double yaw, double pitch, double roll) {
    return about_y(yaw) * about_x(pitch) * about_z(roll);
}

std::optional<Rotation> Rotation::nearest(std::span<const double> n) {
    if (n.size() != 9 && n.size() != 16) return std::nullopt;
    const std::size_t stride = n.size() == 16 ? 4 : 3;
    M33d m;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) m[static_cast<int>(i)][j] = n[i * stride + j];
    if (!(deviation(m) <= 1e-3)) return std::nullopt;  // NaN is refused too
    return Rotation(numbers_of(orthonormalised(m)));
}

std::optional<Rotation> Rotation::camera_to_world(std::span<const double> world_to_camera,
                                                  std::string_view axes) {
    double fy = 1, fz = 1;  // the camera's own axes as seen in our camera frame: signs of y and z
    if (axes == "opencv")
        fy = fz = -1;
    else if (axes == "renderman")
        fz = -1;
    else if (axes != "opengl")
        return std::nullopt;
    if (world_to_camera.size() != 16) return std::nullopt;
    // For row vectors the rows are where the world's axes go; as rows of a matrix for column
    // vectors that takes the camera to the world they are just right, once the camera's axes are
    // ours.
    std::array<double, 9> m{};
    for (std::size_t i = 0; i < 3; ++i) {
        m[3 * i] = world_to_camera[4 * i];
        m[3 * i + 1] = fy * world_to_camera[4 * i + 1];
        m[3 * i + 2] = fz * world_to_camera[4 * i + 2];
    }
    return nearest(m);
}

Rotation Rotation::inverse() const {
    return Rotation({m_[0], m_[3], m_[6], m_[1], m_[4], m_[7], m_[2], m_[5], m_[8]});
}

Rotation Rotation::operator*(const Rotation& other) const {
    Rotation product;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) sum += m_[3 * i + k] * other.m_[3 * k + j];
            product.m_[3 * i + j] = sum;
        }
    return product;
}

}  // namespace chromeball
