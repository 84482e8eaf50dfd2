#include <cmath>
#include <numeric>

#include "detect/weights.h"

namespace chromeball::detecting {
namespace {

constexpr std::array kGate{-6.0, -3.0, -1.5, -0.3};

// Knots lie about where what is told begins and ends, and what is right.
constexpr Sign kSigns[] = {
    {"gate: the rim shows", kGate, 1},
    {"gate: it is significant", kGate, 1},
    {"gate: the world is squeezed at it", kGate, 1},
    {"gate: and not stretched before it", kGate, 1},
    {"gate: detail inside", kGate, 1},
    {"gate: edges of all strengths", kGate, 1},
    {"gate: not made of rings", kGate, 1},
    {"gate: no great step across the rim", kGate, 1},
    {"part of the rim with an edge", {0.20, 0.40, 0.55, 0.70}, 1},
    {"the same in the finest pixels, clear ones only", {0.2, 0.4, 0.6, 0.8}, 1},
    {"concentric rings", {0.05, 0.20, 0.40, 0.70}, -1},
    {"log2 radius in the photo", {3.6, 4.5, 5.5, 6.5}, 1},
    {"log2 contrast inside", {-4, -3, -2, -1}, 1},
    {"log2 detail / contrast", {-6, -5, -4, -3}, 1},
    {"log2 radial / tangential slopes", {0.4, 0.8, 1.2, 1.6}, 1},
    {"crispness of edges", {0.3, 0.7, 1.0, 1.3}, 1},
    {"more than crisp: lines or noise", {2.0, 2.3, 2.6, 3.2}, -1},
    {"log2 deviation / radius by the last fit", {-12.0, -10.5, -9.5, -8.0}, -1},
    {"log2 change / radius by the last fits", {-9.0, -7.5, -6.0, -4.5}, -1}};

constexpr Sign kMovedSigns[] = {
    {"likelihood of a smeared rim over none", {5, 8, 11, 15}, 1},
    {"likelihood of its end over a ball that goes on", {-4, -1.5, 0.5, 3}, 1},
    {"part of the rim that shows as smeared", {0.5, 0.7, 0.85, 0.97}, 1},
    {"part of it that shows elsewhere", {0.1, 0.3, 0.5, 0.7}, -1},
    {"likelihood over outlines that are 2 % off", {1, 7, 18, 40}, 1},
    {"log of what the inside passes of the gates", {-7, -2.5, -0.6, -0.05}, 1},
    {"part of the inside with detail", {0.3, 0.6, 0.8, 0.95}, 1},
    {"log2 radial / tangential slopes before the rim", {0, 0.4, 0.8, 1.2}, 0},
    {"concentric rings", {0.05, 0.12, 0.2, 0.35}, -1},
    {"log of the motion's length inside / fitted", {0.01, 0.04, 0.1, 0.3}, -1},
    {"clarity of streaks", {0.08, 0.15, 0.25, 0.35}, 1},
    {"how sharply moved edges end at the rim", {-0.5, 0.3, 0.8, 1.3}, 1},
    {"slopes along the motion / across", {0.45, 0.65, 0.8, 0.95}, -1},
    {"log2 motion / radius", {-4, -3, -2, -1.2}, 0},
    {"log2 radius in the photo", {5, 5.8, 6.6, 7.5}, 1},
    {"other fits that agree", {0, 0.5, 1.2, 2.4}, 1}};

}  // namespace

std::span<const Sign> all_signs() { return kSigns; }
std::span<const Sign> moved_signs() { return kMovedSigns; }

double most_for(std::span<const double> signs) {
    const auto gates = signs.first(kGates);
    const double passed = std::accumulate(gates.begin(), gates.end(), 0.0);
    return kMostUngated + (1 - kMostUngated) * part_between(passed, -1.5, -0.5);
}

double chance_of(const Weights& weights, std::span<const double> signs) {
    double odds = weights.bias;
    for (std::size_t i = 0; i < weights.gains.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            odds += weights.gains[i][k] * part_between(signs[i], weights.signs[i].knots[k],
                                                       weights.signs[i].knots[k + 1]);
    return (weights.gated ? most_for(signs) : 1) / (1 + std::exp(-odds));
}

}  // namespace chromeball::detecting
