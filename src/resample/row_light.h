#pragma once

#include <array>
#include <cstddef>

namespace chromeball {

/// How much light a row of pixels holds, and the most in one of them, per channel. Negative values
/// and what is no finite number count as 0.
struct RowLight {
    std::array<float, 3> sum{}, highest{};
};

/// Of `count` pixels of four channels; the fourth is not looked at.
RowLight row_light(const float* pixels, std::size_t count);

}  // namespace chromeball
