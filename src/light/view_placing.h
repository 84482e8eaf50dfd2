#pragma once

#include <vector>

#include "light/view_unknowns.h"

namespace chromeball {

/// Gives each view that is not told a first rotation, one after the other, the one that fits best
/// first: searched through all of SO(3) against those that are placed already. The views in the
/// order in which they were placed.
std::vector<std::size_t> placed_in_turn(TurningViews& state, const Watch& watch);

}  // namespace chromeball
