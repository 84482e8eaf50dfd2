#include "map/cube.h"

#include <cassert>

#include "map/layouts.h"

namespace chromeball {

Cube::Cube() : Cube(cube_layouts().front()) {}

Cube::Cube(const CubeLayout& layout) : layout_(&layout) {
    assert(static_cast<std::size_t>(layout.columns * layout.rows) <= cells_.size());
    cells_.fill(-1);
    for (int face = 0; face < 6; ++face) {
        const Face& f = layout.faces[static_cast<std::size_t>(face)];
        cells_[static_cast<std::size_t>(f.row * layout.columns + f.column)] =
            static_cast<signed char>(face);
        forward_[static_cast<std::size_t>(face)] = layout.forward(face);
    }
}

}  // namespace chromeball
