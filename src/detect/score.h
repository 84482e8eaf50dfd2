#pragma once

#include "core/outline.h"
#include "detect/grey.h"
#include "detect/rim.h"

namespace chromeball::detecting {

/// What speaks for a mirror ball within an outline. Parts are 0 to 1.
struct Evidence {
    Rim rim;
    double radius = 0;    ///< pixels, of the level looked at
    double contrast = 0;  ///< range of the grey values inside
    double noise = 0;     ///< of the level
    double detail = 0;    ///< fine structure inside, median over its parts, of the level's values
    double detailed = 0;  ///< part of the inside that has fine structure
    double squeeze = 0;   ///< log2 of radial over tangential slopes, towards the rim
    double squeeze_before = 0;  ///< the same one ring further inside
    double rings = 0;           ///< how much of the inside is explained by concentric rings alone
    double sameness = 0;        ///< median over high percentile of the strengths of edges inside
    double step = 0;            ///< difference across the rim, in parts of the contrast inside
};

Evidence evidence_of(const Level& level, const Outline& outline, const Rim& rim);

/// How sure it is that this is a mirror ball with this outline, 0 to 1; 0.5 is even odds.
double confidence_of(const Evidence& evidence);

}  // namespace chromeball::detecting
