// Written by tests/detect/fit_confidence.cpp (see README.md there) from 930 of the random
// pictures 200000 to 200965: 562 candidates that seemed to have moved, 301 of them right.

#include "detect/weights.h"

namespace chromeball::detecting {
namespace {

constexpr std::array<double, 3> kGains[] = {
    {0.000, 0.000, 0.000},     // likelihood of a smeared rim over none
    {1.112, 0.071, 0.000},     // likelihood of its end over a ball that goes on
    {0.590, 0.000, 0.000},     // part of the rim that shows as smeared
    {-0.055, -1.059, -1.195},  // part of it that shows elsewhere
    {2.726, 1.508, 0.883},     // likelihood over outlines that are 2 % off
    {1.595, 1.198, 0.044},     // log of what the inside passes of the gates
    {0.000, 0.755, 0.902},     // part of the inside with detail
    {0.041, 0.326, -0.121},    // log2 radial / tangential slopes before the rim
    {-0.576, 0.000, -0.008},   // concentric rings
    {0.000, -0.229, -0.255},   // log of the motion's length inside / fitted
    {0.000, 0.000, 0.270},     // clarity of streaks
    {0.000, 1.052, 0.000},     // how sharply moved edges end at the rim
    {0.000, 0.000, -0.110},    // slopes along the motion / across
    {-0.385, 0.475, 0.374},    // log2 motion / radius
    {0.883, 0.309, 0.261},     // log2 radius in the photo
    {0.000, 0.000, 0.000},     // other fits that agree
};
constexpr double kBias = -9.358;

}  // namespace

const Weights& moved_weights() {
    static const Weights kWeights{moved_signs(), kBias, kGains, false};
    return kWeights;
}

}  // namespace chromeball::detecting
