#pragma once

#include <optional>

#include "detect/detect.h"
#include "detect/edge.h"
#include "detect/shape.h"

namespace chromeball::detecting {

/// The focal length that an outline's shape tells, where it is measurably longer towards the
/// principal point than across; nothing where it is not, or is longer in another direction, as on
/// pictures that were cropped.
///
/// shape, covariance   the outline as its rim alone gives it (EdgeFit::free)
/// lens                only the principal point counts
std::optional<FocalEstimate> focal_of(const Shape& shape, const ShapeCovariance& covariance,
                                      const Lens& lens);

}  // namespace chromeball::detecting
