#pragma once

#include <cmath>

namespace chromeball {

/// The mean of f(dx, dy) over the square [0, 1] x [0, 1], exact for cubics: Gauss's two points
/// along each side.
template <class F>
double mean_over_square(const F& f) {
    const double off = 0.5 / std::sqrt(3.0);
    const double a = 0.5 - off, b = 0.5 + off;
    return 0.25 * (f(a, a) + f(b, a) + f(a, b) + f(b, b));
}

}  // namespace chromeball
