#pragma once

#include <vector>

#include "resample/source.h"

namespace chromeball {

/// A pixel of a source's border, and how much of another pixel's colour is in it.
struct Copy {
    int x = 0, y = 0;
    float part = 1;
};

/// Where the border of a prepared lat-long or cube holds the pixel (x, y) of its picture once more:
/// beyond seams and poles. Both are pixels of source.pixels.
std::vector<Copy> copies_of(const Source& source, int x, int y);

}  // namespace chromeball
