#pragma once

#include <vector>

#include "core/outline.h"
#include "detect/grey.h"
#include "detect/rim.h"
#include "detect/weights.h"

namespace chromeball::detecting {

constexpr double kScoredRadius = 90;  ///< at most, of the level on which the inside is looked at

/// What speaks for a mirror ball within an outline. Parts are 0 to 1.
struct Evidence {
    Rim rim;
    double radius = 0;        ///< pixels, of the level looked at
    double photo_radius = 0;  ///< pixels of the photo
    double contrast = 0;      ///< range of the grey values inside
    double noise = 0;         ///< of the level
    double detail = 0;    ///< fine structure inside, median over its parts, of the level's values
    double detailed = 0;  ///< part of the inside that has fine structure
    double squeeze = 0;   ///< log2 of radial over tangential slopes, towards the rim
    double squeeze_before = 0;  ///< the same one ring further inside
    double rings = 0;           ///< how much of the inside is explained by concentric rings alone
    double sameness = 0;        ///< median over high percentile of the strengths of edges inside
    double step = 0;            ///< difference across the rim, in parts of the contrast inside
    double crispness = 0;  ///< log2 of how much edges inside weaken when blurred: 0 soft, 1.4 sharp
};

Evidence evidence_of(const Level& level, const Outline& outline, const Rim& rim);

/// How far the evidence passes all gates at once, 0 to 1: enough to put candidates in order.
double score_of(const Evidence& evidence);

/// What the last fits of the rim, in the photo's own pixels, say of themselves.
struct LastFit {
    double coverage = 0;   ///< Rim::coverage
    double visible = 0;    ///< part of the rim inside the picture on which a clear edge was found
    double deviation = 0;  ///< of the radius, pixels; 0 where it is not told
    double change = 0;     ///< greatest distance that the rim moved, pixels
};

/// The evidence as the numbers that are weighed to the probability that this is a mirror ball and
/// its outline right to 2 %: see all_signs(). The gates come first.
std::vector<double> signs_of(const Evidence& evidence, const LastFit& last);

}  // namespace chromeball::detecting
