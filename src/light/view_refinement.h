#pragma once

#include <vector>

#include "light/view_unknowns.h"

namespace chromeball {

/// Turns the placed views, and changes their balls, so that they differ least: Gauss-Newton on log
/// light over what they share, seen in steps of `angle` radians, with Tukey's weights so that what
/// only one of them shows does not pull.
///
/// steps   at most so many
/// balls   see unknowns_of()
void refine(TurningViews& state, const std::vector<std::size_t>& placed, double angle, int steps,
            bool balls);

}  // namespace chromeball
