#pragma once

#include <optional>
#include <vector>

#include "core/outline.h"
#include "detect/edge.h"
#include "detect/grey.h"
#include "detect/shape.h"
#include "map/camera.h"

namespace chromeball::detecting {

/// An outline, wrong by up to some 15 % of its radius, of something that seems to have moved.
struct MovedStart {
    Outline outline;
    V2d motion;          ///< pixels of the photo; its sign is open
    double clarity = 0;  ///< see Streaks
};

/// What the inside of an outline says; nothing where it is not streaked.
std::optional<MovedStart> moved_start(const std::vector<Level>& levels, const Outline& outline);

/// Whether the inside of an outline is so clearly streaked that what is taken for a ball that stood
/// still may have moved: its rim then lies half of the motion too far outside.
bool may_have_moved(const std::vector<Level>& levels, const Outline& outline);

/// A mirror ball that moved during the exposure.
struct MovedBall {
    Outline outline;  ///< in the middle of the exposure
    V2d motion;       ///< from shutter open to close, pixels; its sign is open
    ShapeCovariance covariance{};
    double visible = 0;              ///< part of the rim that shows as such a ball's would
    double chance = 0;               ///< probability that it is one, outline within 2 %
    std::vector<double> signs = {};  ///< what that was weighed from, see moved_signs()
};

/// The moved balls near starts; less than one for each, and several that are the same.
///
/// seen   where pictures before and behind showed such a ball: to end there says as much as three
///        other starts that end there, too
std::vector<MovedBall> moved_balls(const Grey& picture, const std::vector<Level>& levels,
                                   const std::vector<MovedStart>& starts, const Lens& lens,
                                   const std::optional<Outline>& seen = std::nullopt);

}  // namespace chromeball::detecting
