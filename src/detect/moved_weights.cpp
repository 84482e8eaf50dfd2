// Written by tests/detect/fit_confidence.cpp (see README.md there) from 800 of the random
// pictures 200000 to 200799: 492 candidates that seemed to have moved, 261 of them right.

#include "detect/weights.h"

namespace chromeball::detecting {
namespace {

constexpr std::array<double, 3> kGains[] = {
    {0.000, 0.000, 0.000},     // likelihood of a smeared rim over none
    {1.337, 0.041, 0.000},     // likelihood of its end over a ball that goes on
    {0.513, 0.000, 0.000},     // part of the rim that shows as smeared
    {-0.032, -1.080, -1.180},  // part of it that shows elsewhere
    {2.663, 1.548, 0.706},     // likelihood over outlines that are 2 % off
    {1.434, 1.166, 0.000},     // log of what the inside passes of the gates
    {0.000, 0.584, 0.966},     // part of the inside with detail
    {-0.074, 0.348, 0.256},    // log2 radial / tangential slopes before the rim
    {-0.436, 0.000, 0.000},    // concentric rings
    {0.000, -0.230, -0.254},   // log of the motion's length inside / fitted
    {0.000, 0.000, 0.097},     // clarity of streaks
    {0.000, 0.938, 0.000},     // how sharply moved edges end at the rim
    {0.000, 0.000, 0.000},     // slopes along the motion / across
    {-0.162, 0.338, 0.561},    // log2 motion / radius
    {0.996, 0.252, 0.335},     // log2 radius in the photo
    {0.002, 0.000, 0.000},     // other fits that agree
};
constexpr double kBias = -9.184;

}  // namespace

const Weights& moved_weights() {
    static const Weights kWeights{moved_signs(), kBias, kGains, false};
    return kWeights;
}

}  // namespace chromeball::detecting
