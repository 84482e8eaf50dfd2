#pragma once

#include <array>
#include <optional>

#include "core/image.h"
#include "map/layouts.h"

namespace chromeball {

/// What a picture holds, over the part of it that alpha shows.
struct MapMeasure {
    double lowest = 0;   ///< luminance above 0; meaningless where highest is 0
    double highest = 0;  ///< luminance
    std::array<double, 3>
        mean{};  ///< RGB: over the sphere, by solid angle, where the layout is known
    std::optional<double> covered_steradians;  ///< where the layout is known
};

/// pixels: 3 or 4 channels, colour multiplied by alpha; of layout's aspect unless that is nullptr.
MapMeasure measure(const Image& pixels, const Layout* layout);

/// Whether all that a layout leaves empty (corners, cells of a cross) is black or transparent;
/// looked at on a grid of some 256 x 256 places. False for a layout that leaves nothing empty.
bool empty_parts_are_empty(const Image& pixels, const Layout& layout);

}  // namespace chromeball
