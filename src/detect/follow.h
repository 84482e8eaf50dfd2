#pragma once

#include <array>

#include "detect/draft.h"

namespace chromeball::detecting {

/// How a rim is followed at one scale: everything in parts of the radius, but never finer than the
/// pixels allow.
struct Pass {
    double largest_radius;  ///< of the level used
    int rays;
    double reach, loose, tight;
    std::array<double, 3> starts;  ///< radii to start from; the true rim is rarely further inside
};
constexpr Pass kPasses[] = {{72, 80, 0.22, 0.08, 0.02, {1}},
                            {130, 160, 0.10, 0.04, 0.010, {1, 1.04, 1.08}},
                            {350, 256, 0.05, 0.016, 0.005, {1, 1.012, 1.025}}};

/// Follows the rim from several starts and keeps the most significant: close inside of a mirror
/// ball's rim its reflections make weaker rims of their own.
void follow(Draft& draft, const Picture& picture, const Pass& pass);

/// Starts from circles that touch the draft's on the far side, all around it: a false rim often
/// shares a part of the true one and cuts through the ball elsewhere.
void escape(Draft& draft, const Picture& picture);

/// The finest fits. One is always settled, for something must be said of it.
void finish(Draft& draft, const Picture& picture, bool always);

}  // namespace chromeball::detecting
