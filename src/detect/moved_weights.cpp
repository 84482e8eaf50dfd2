// Written by tests/detect/fit_confidence.cpp (see README.md there) from 1237 of the random
// pictures 200000 to 400571: 789 candidates that seemed to have moved, 360 of them right.

#include "detect/weights.h"

namespace chromeball::detecting {
namespace {

constexpr std::array<double, 3> kGains[] = {
    {0.000, 0.000, 0.311},     // likelihood of a smeared rim over none
    {1.095, 0.030, 0.000},     // likelihood of its end over a ball that goes on
    {0.572, 0.210, 0.000},     // part of the rim that shows as smeared
    {0.000, -0.629, -0.880},   // part of it that shows elsewhere
    {0.906, 1.162, 0.444},     // log of what the inside passes of the gates
    {0.984, 0.512, 0.792},     // part of the inside with detail
    {-0.069, 0.203, -0.378},   // log2 radial / tangential slopes before the rim
    {-0.370, -0.021, -0.550},  // concentric rings
    {0.000, 0.000, -0.400},    // log of the motion's length inside / fitted
    {0.000, 0.280, 0.000},     // clarity of streaks
    {0.000, 1.281, 0.183},     // how sharply moved edges end at the rim
    {0.000, 0.000, 0.000},     // slopes along the motion / across
    {-0.222, -0.432, -0.104},  // log2 motion / radius
    {0.000, 0.000, 0.000},     // log2 radius in the photo
    {0.020, 0.887, 0.050},     // other fits that agree
};
constexpr double kBias = -6.482;

}  // namespace

const Weights& moved_weights() {
    static const Weights kWeights{moved_signs(), kBias, kGains, false};
    return kWeights;
}

}  // namespace chromeball::detecting
