#pragma once

#include "detect/detect.h"
#include "detect/draft.h"

namespace chromeball::detecting {

/// What is known of an outline of which only single edges' scatter is.
ShapeCovariance rough_covariance(const Draft& draft);

/// Standard deviations of an outline's numbers from what is known of it as a Shape.
OutlineDeviation deviation_of(const Outline& o, const ShapeCovariance& c);

}  // namespace chromeball::detecting
