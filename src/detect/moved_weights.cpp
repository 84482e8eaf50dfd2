// Written by tests/detect/fit_confidence.cpp (see README.md there) from 1051 of the random
// pictures 100000 to 200656: 731 candidates that seemed to have moved, 268 of them right.

#include "detect/weights.h"

namespace chromeball::detecting {
namespace {

constexpr std::array<double, 3> kGains[] = {
    {0.000, 0.000, 0.517},     // likelihood of a smeared rim over none
    {1.071, 0.000, 0.000},     // likelihood of its end over a ball that goes on
    {1.428, 0.000, 0.000},     // part of the rim that shows as smeared
    {0.000, -0.536, -0.903},   // part of it that shows elsewhere
    {0.590, 1.233, 0.847},     // log of what the inside passes of the gates
    {0.513, 0.621, 0.688},     // part of the inside with detail
    {0.067, -0.003, -0.379},   // log2 radial / tangential slopes before the rim
    {-0.271, -0.388, -0.262},  // concentric rings
    {0.000, -0.071, -0.446},   // log of the motion's length inside / fitted
    {0.000, 0.056, 0.065},     // clarity of streaks
    {0.943, 1.525, 0.000},     // how sharply moved edges end at the rim
    {0.000, -0.065, 0.000},    // slopes along the motion / across
    {-0.805, 0.020, 0.437},    // log2 motion / radius
    {0.000, 0.000, 0.000},     // log2 radius in the photo
    {0.462, 0.432, 0.032},     // other fits that agree
};
constexpr double kBias = -7.670;

}  // namespace

const Weights& moved_weights() {
    static const Weights kWeights{moved_signs(), kBias, kGains, false};
    return kWeights;
}

}  // namespace chromeball::detecting
