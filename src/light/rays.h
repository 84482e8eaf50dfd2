#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <vector>

#include "map/projection.h"

namespace chromeball {

/// Light from a small part of the sphere.
struct Ray {
    V3d direction{0, 0, 0};        ///< unit vector
    std::array<double, 3> flux{};  ///< radiance times steradians
    double steradians = 0;
};

/// The sphere in pieces of equal height and equal area, so that a hundred thousand pixels become a
/// few thousand rays.
class Rays {
public:
    void add(V3d d, const float* rgb, double steradians);
    /// There is light, but nobody knows which.
    void add_unknown(V3d d, double steradians);
    /// What is not known, or not shown (nothing was added there), becomes as bright as what lies
    /// around it.
    void fill();
    /// Those that hold anything.
    std::vector<Ray> take() const;
    /// Mean over the piece that a direction lies in.
    std::array<double, 3> radiance(V3d d) const;

private:
    static std::size_t cell_of(V3d d);
    static V3d middle(std::size_t cell);

    static constexpr std::size_t kRows = 48, kColumns = 96;
    static constexpr double kCellArea = 4 * std::numbers::pi / (kRows * kColumns);
    std::vector<Ray> rays_ = std::vector<Ray>(kRows * kColumns);  ///< directions not normalised
    std::vector<double> unknown_ = std::vector<double>(kRows * kColumns);  ///< steradians
};

/// What they give a surface, W / m^2 in the units of their radiance.
std::array<double, 3> irradiance_of(const std::vector<Ray>& rays, V3d normal);

}  // namespace chromeball
