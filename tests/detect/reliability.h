#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/outline.h"

namespace chromeball {

/// What counts as right: centre and both axes within 2 % of the radius.
inline bool right_outline(const Outline& found, const Outline& truth) {
    const double part = 0.02 * std::sqrt(truth.a * truth.b);
    return std::hypot(found.cx - truth.cx, found.cy - truth.cy) <= part &&
           std::abs(found.a - truth.a) <= 0.02 * truth.a &&
           std::abs(found.b - truth.b) <= 0.02 * truth.b;
}

/// Whether an outline is that of one of the balls.
inline bool right_one(const Outline& found, const std::vector<Outline>& balls) {
    return std::any_of(balls.begin(), balls.end(),
                       [&](const Outline& ball) { return right_outline(found, ball); });
}

}  // namespace chromeball
