#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/image.h"
#include "map/dual.h"
#include "map/layouts.h"

namespace chromeball {

/// The sphere in cells: a cube map (the layout `openexr`) whose cells know their directions and
/// their neighbours, over edges of faces too. What is computed on it fits any output.
class ViewCube {
public:
    /// size: of a face, cells
    explicit ViewCube(int size);

    int size() const { return size_; }
    std::size_t cells() const { return directions_.size(); }
    V3d direction(std::size_t cell) const { return directions_[cell]; }
    const std::vector<V3d>& directions() const { return directions_; }
    /// Left, right, up, down.
    const std::array<std::uint32_t, 4>& neighbours(std::size_t cell) const {
        return neighbours_[cell];
    }
    double solid_angle(std::size_t cell) const { return solid_angles_[cell]; }
    /// Radians across a cell in the middle of a face; in the corners about half of that.
    double cell_angle() const { return 2.0 / size_; }

    /// The picture's layout, and its size in pixels.
    const Layout& layout() const { return *layout_; }

private:
    int size_;
    const Layout* layout_;
    std::vector<V3d> directions_;
    std::vector<std::array<std::uint32_t, 4>> neighbours_;
    std::vector<double> solid_angles_;
};

/// One number a cell.
using CellValues = std::vector<float>;

/// The largest (smallest) value within that many steps to neighbours.
CellValues widened(const ViewCube& cube, CellValues values, int steps);
CellValues narrowed(const ViewCube& cube, CellValues values, int steps);
/// Means with the neighbours, that many times: a blur of sqrt(steps / 2) cells.
CellValues blurred(const ViewCube& cube, CellValues values, int steps);

/// A picture of a cube, four channels, in another size: means, or smooth in between. Colour and
/// fourth channel alike, as colour multiplied by a weight and the weight.
Image resized(const Image& cube, int size);

}  // namespace chromeball
