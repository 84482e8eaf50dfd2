#include "light/view_placing.h"

#include <algorithm>
#include <numbers>

#include "light/rotation_search.h"
#include "light/view_differences.h"
#include "light/view_refinement.h"

namespace chromeball {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// A guess for where a view belongs, refined against the one it was compared with.
struct Guess {
    Rotation to_world;
    double agreement = -1;
};

/// The first ones, of those that have come to the same place the best.
std::vector<Guess> apart(std::vector<Guess> guesses, double angle, std::size_t most) {
    std::vector<Guess> kept;
    for (const Guess& guess : guesses)
        if (kept.size() < most && std::all_of(kept.begin(), kept.end(), [&](const Guess& other) {
                return angle_between(guess.to_world, other.to_world) > angle;
            }))
            kept.push_back(guess);
    return kept;
}

/// The best rotation of a view against one that is placed.
Guess best_guess(TurningViews& state, std::size_t placed, std::size_t view, const Watch& watch) {
    const Unturned& fixed = state.views[placed];
    const Unturned& free = state.views[view];
    const Rotation& fixed_pose = state.pose.to_world[placed];
    std::vector<Guess> guesses;
    for (const Rotation& turn : likely_rotations(fixed.pyramid, free.pyramid, 48, watch))
        guesses.push_back({fixed_pose * turn, 0});
    struct Round {
        double degrees;
        std::size_t keep;
    };
    for (const auto& [degrees, keep] : {Round{4, 12}, Round{2, 4}, Round{1, 1}}) {
        for (Guess& guess : guesses) {
            state.pose.to_world[view] = guess.to_world;
            refine(state, {placed, view}, degrees * kDegree, 6, false);
            guess.to_world = state.pose.to_world[view];
            const auto world = fibonacci_directions(2000);
            guess.agreement =
                likeness(sampled(fixed.pyramid, world, fixed_pose, degrees * kDegree),
                         sampled(free.pyramid, world, guess.to_world, degrees * kDegree));
        }
        watch.check();
        std::stable_sort(guesses.begin(), guesses.end(),
                         [](const Guess& a, const Guess& b) { return a.agreement > b.agreement; });
        guesses = apart(std::move(guesses), 0.5 * degrees * kDegree, keep);
    }
    return guesses.front();
}

/// A likeness that is no chance.
constexpr double kSurely = 0.5;

}  // namespace

std::vector<std::size_t> placed_in_turn(TurningViews& state, const Watch& watch) {
    std::vector<std::size_t> placed, waiting;
    for (std::size_t i = 0; i < state.views.size(); ++i)
        (state.views[i].to_world ? placed : waiting).push_back(i);
    if (placed.empty()) {
        placed.push_back(0);
        waiting.erase(waiting.begin());
    }
    std::vector<std::vector<Guess>> guesses(state.views.size());
    while (!waiting.empty()) {
        std::size_t best = 0;
        Guess guess;
        for (std::size_t k = 0; k < waiting.size(); ++k) {
            auto& known = guesses[waiting[k]];
            for (std::size_t n = known.size(); n < placed.size(); ++n) {
                // One that fits needs no other view to fit to.
                if (n > 0 && known.front().agreement > kSurely) break;
                known.push_back(best_guess(state, placed[n], waiting[k], watch));
            }
            for (const Guess& one : known)
                if (one.agreement > guess.agreement) {
                    guess = one;
                    best = k;
                }
        }
        state.pose.to_world[waiting[best]] = guess.to_world;
        placed.push_back(waiting[best]);
        waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return placed;
}

}  // namespace chromeball
