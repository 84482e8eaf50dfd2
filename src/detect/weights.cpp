// Written by tests/detect/fit_confidence.cpp (see README.md there) from 1993 of the random pictures
// 100000 to 103176: 1631 candidates that stood still, 371 of them right.

#include "detect/weights.h"

namespace chromeball::detecting {
namespace {

constexpr std::array<double, 3> kGains[] = {
    {0.000, 0.000, 0.000},     // gate: the rim shows
    {0.000, 0.000, 0.000},     // gate: it is significant
    {0.000, 0.000, 0.000},     // gate: the world is squeezed at it
    {0.012, 0.050, 0.337},     // gate: and not stretched before it
    {0.390, 0.754, 0.575},     // gate: detail inside
    {1.469, 1.493, 0.101},     // gate: edges of all strengths
    {0.205, 0.295, 0.595},     // gate: not made of rings
    {0.000, 0.000, 0.000},     // gate: no great step across the rim
    {0.358, 0.000, 0.000},     // part of the rim with an edge
    {0.236, 1.298, 0.996},     // the same in the finest pixels, clear ones only
    {0.000, -1.112, -1.010},   // concentric rings
    {0.000, 0.077, 0.000},     // log2 radius in the photo
    {0.249, 1.496, 0.689},     // log2 contrast inside
    {0.000, 0.426, 0.125},     // log2 detail / contrast
    {0.797, 0.067, 0.176},     // log2 radial / tangential slopes
    {0.791, 2.723, 0.000},     // crispness of edges
    {0.000, 0.000, 0.000},     // more than crisp: lines or noise
    {-0.293, -0.596, -1.196},  // log2 deviation / radius by the last fit
    {-0.181, 0.000, -2.054},   // log2 change / radius by the last fits
};
constexpr double kBias = -13.446;

}  // namespace

const Weights& weights() {
    static const Weights kWeights{all_signs(), kBias, kGains};
    return kWeights;
}

}  // namespace chromeball::detecting
