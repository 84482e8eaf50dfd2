#include "light/view_unknowns.h"

#include <algorithm>
#include <numbers>

namespace chromeball {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

bool TurningViews::change(std::size_t i, const BallChange& change) {
    if (change == pose.change[i]) return true;
    const auto moved = ball_of(*views[i].ball, change);
    if (!moved) return false;
    views[i].pyramid.set_ball(*moved);
    pose.change[i] = change;
    return true;
}

Rotation turn_about(UnknownKind kind, double radians) {
    const double degrees = radians / kDegree;
    return kind == UnknownKind::about_x   ? Rotation::about_x(degrees)
           : kind == UnknownKind::about_y ? Rotation::about_y(degrees)
                                          : Rotation::about_z(degrees);
}

BallChange changed(BallChange change, const BallModel& ball, UnknownKind kind, double by) {
    // In its middle a pixel turns directions by 2 / radius.
    const double pixels = 0.5 * ball.outline.b * by;
    if (kind == UnknownKind::right) change.right += pixels;
    if (kind == UnknownKind::down) change.down += pixels;
    if (kind == UnknownKind::growth) change.growth += by;
    // Nobody stands nearer than 2.5 radii.
    if (kind == UnknownKind::inverse_distance)
        change.inverse_distance = std::clamp(change.inverse_distance + by, 0.0, 0.4);
    return change;
}

double amount(const BallChange& change, const BallModel& ball, UnknownKind kind) {
    if (kind == UnknownKind::right) return change.right / (0.5 * ball.outline.b);
    if (kind == UnknownKind::down) return change.down / (0.5 * ball.outline.b);
    return kind == UnknownKind::growth ? change.growth : change.inverse_distance;
}

std::vector<ViewUnknown> unknowns_of(const std::vector<Unturned>& views,
                                     const std::vector<std::size_t>& placed, bool balls) {
    std::vector<ViewUnknown> unknowns;
    for (const std::size_t i : placed) {
        // Somebody must stand still.
        if (!views[i].to_world && i != placed.front())
            for (const UnknownKind kind :
                 {UnknownKind::about_x, UnknownKind::about_y, UnknownKind::about_z})
                unknowns.push_back({i, kind, 0});
        if (!balls || !views[i].ball) continue;
        const BallModel& ball = *views[i].ball;
        if (ball.deviation > 0) {
            const double deviation = ball.deviation / ball.outline.b;
            unknowns.push_back({i, UnknownKind::right, 2 * deviation});
            unknowns.push_back({i, UnknownKind::down, 2 * deviation});
            unknowns.push_back({i, UnknownKind::growth, deviation});
        }
        if (!ball.camera_known) unknowns.push_back({i, UnknownKind::inverse_distance, 0.1});
    }
    return unknowns;
}

}  // namespace chromeball
