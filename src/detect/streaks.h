#pragma once

#include <cstddef>
#include <vector>

#include "core/outline.h"
#include "detect/grey.h"
#include "map/camera.h"

namespace chromeball::detecting {

/// A motion during the exposure that the inside of an outline speaks for.
struct Streaks {
    V2d motion;  ///< pixels of the level; its sign is open
    /// How clearly: 0.05 and less is chance, 0.15 to 0.35 is usual where something moved.
    double clarity = 0;
};

/// Slopes inside of an outline along the way where they are least, over those across it: 0.4 to
/// 0.8 where something moved, 0.7 to 1 where not.
double smoothness_along(const Level& level, const Outline& outline);

/// The likeliest motions of what is inside an outline, pixels of the level, best first, at most
/// `most`. Its radius should be 40 to 80 pixels there: below, short motions do not show; above, it
/// only takes longer.
std::vector<Streaks> streaks_of(const Level& level, const Outline& outline, std::size_t most);

/// The motion near `first` that the inside of an outline speaks for most, to a fraction of a pixel
/// of the level along it and across. `first` may be wrong by an eighth of its length.
V2d settled_motion(const Level& level, const Outline& outline, const V2d& first);

}  // namespace chromeball::detecting
