#pragma once

#include "core/outline.h"
#include "detect/grey.h"
#include "detect/rim.h"

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
};

Evidence evidence_of(const Level& level, const Outline& outline, const Rim& rim);

/// How much speaks for a mirror ball, 0 to 1: enough to put candidates in order.
double score_of(const Evidence& evidence);

/// The probability that this is a mirror ball and its outline right to 2 %, 0 to 1; half where the
/// score is.
double confidence_of(double score, const Evidence& evidence);

}  // namespace chromeball::detecting
