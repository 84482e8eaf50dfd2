#pragma once

#include <numbers>
#include <vector>

#include "light/rotation.h"

// For those who turn views: what may be changed of them.

namespace chromeball {

/// The views while they are being turned.
struct TurningViews {
    std::vector<Unturned>& views;
    ViewAlignment& pose;

    /// Changes a view's ball; false where there is none like that.
    bool change(std::size_t i, const BallChange& change);
};

/// What may be unknown of a view: its turn about an axis of the world; its ball. All are counted
/// in radians, or in what moves directions by about as much.
enum class UnknownKind { about_x, about_y, about_z, right, down, growth, inverse_distance };

struct ViewUnknown {
    std::size_t view;
    UnknownKind kind;
    double deviation;  ///< that is expected of it; 0: it may be anything

    bool turns() const { return kind <= UnknownKind::about_z; }
};

/// Those of the views that are placed. The first of them stands still, as do those whose rotation
/// is known.
///
/// balls   whether balls' outlines and distances are among them, where they are not known for sure
std::vector<ViewUnknown> unknowns_of(const std::vector<Unturned>& views,
                                     const std::vector<std::size_t>& placed, bool balls);

/// A turn about one of the axes.
Rotation turn_about(UnknownKind axis, double radians);

/// A change of the ball by an unknown of it that is no turn; and how much of it there is by now.
BallChange changed(BallChange change, const BallModel& ball, UnknownKind kind, double by);
double amount(const BallChange& change, const BallModel& ball, UnknownKind kind);

}  // namespace chromeball
