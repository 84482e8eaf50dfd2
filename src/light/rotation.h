#pragma once

#include <optional>
#include <vector>

#include "core/watch.h"
#include "light/view.h"

namespace chromeball {

/// A view to be turned so that it fits the others, and what is known of it.
struct Unturned {
    ViewPyramid pyramid;
    std::optional<Rotation> to_world;  ///< where it is known
    std::optional<BallModel> ball;     ///< of which the unknown is found, too
};

/// How views fit together.
struct ViewAlignment {
    std::vector<Rotation> to_world;  ///< a view; the first one's is as told, or the identity
    std::vector<BallChange> change;  ///< a view
    std::vector<double> residual;    ///< a view: median misfit to the others, radians
    /// A view: how much less it differs from the others than turned any other way, 0 (not at all)
    /// to 1 (nothing is left of the difference).
    std::vector<double> agreement;
};

/// Two views of one place agree at least so much, views of different places less.
constexpr double kLeastAgreement = 0.5;

/// Turns views so that they show the same: for every view that is not told, the best rotation is
/// searched through all of SO(3) against those that are placed already; then all are refined
/// together, by Gauss-Newton on log light over the overlaps, coarse to fine, with Tukey's weights
/// so that what only one view shows (a photographer) does not pull. Exposure and tint may differ.
/// Balls' outlines and distances, where they are not known for sure, are refined with them: a
/// quarter of a pixel there turns directions by more than what views can be compared to.
///
/// Whether the result is to be believed tells `agreement`.
ViewAlignment align_views(std::vector<Unturned> views, const Watch& watch = {});

}  // namespace chromeball
