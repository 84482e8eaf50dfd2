#pragma once

#include <algorithm>
#include <array>
#include <span>

namespace chromeball::detecting {

/// A sign for or against a mirror ball, as it is weighed: log-odds that rise or fall in straight
/// pieces between four knots and stay as they are beyond, so that no value, however odd, decides
/// alone.
struct Sign {
    const char* name;
    std::array<double, 4> knots;  ///< in the sign's own unit
    int direction;                ///< 1: more of it can only speak for a ball; -1: only against
};

/// Log-odds of "a mirror ball, and its outline right to 2 %".
struct Weights {
    std::span<const Sign> signs;
    double bias;
    std::span<const std::array<double, 3>> gains;  ///< of each sign from knot to knot
    bool gated = true;                             ///< whether the first signs are gates
};

/// The first signs are gates: what a mirror ball passes all at once. As log2 of soft
/// steps from 0 to 1.
constexpr std::size_t kGates = 8;

/// In the order of signs_of().
std::span<const Sign> all_signs();
const Weights& weights();
/// Those of balls that moved, which have no gates; in the order of MovedBall::signs.
std::span<const Sign> moved_signs();
const Weights& moved_weights();

/// How far a value has come from one knot to the next, 0 to 1.
inline double part_between(double value, double from, double to) {
    // The comparison is false for what is not a number, which thus says nothing.
    return value > from ? std::min((value - from) / (to - from), 1.0) : 0.0;
}

/// The most that can be said by the gates, from 1 to kMostUngated: a sum of signs forgives the lack
/// of one for plenty of the others, but what fails the gates (together: a half is -1) is something
/// else, of kinds, too, that the weights were not fitted on.
double most_for(std::span<const double> signs);
constexpr double kMostUngated = 0.3;

/// The probability that weights give: what the gates, if there are any, allow times a logistic
/// regression. As many signs as there are.
double chance_of(const Weights& weights, std::span<const double> signs);

}  // namespace chromeball::detecting
