#pragma once

#include <opencv2/core.hpp>

#include "core/outline.h"
#include "detect/grey.h"

namespace chromeball::detecting {

/// What lies around the middle of an outline, turned so that `heading` (radians) points along the
/// rows; as far as `reach`, pixels. The middle is the middle pixel's centre.
struct Turned {
    cv::Mat pixels;
    cv::Mat mask;  ///< 1 where it is near enough and in the picture, else 0
};
Turned turned(const Level& level, const Outline& outline, double heading, double reach);

/// Second derivative of a Gaussian, a row.
cv::Mat bend_kernel(double sigma);

cv::Mat matrix(const Level& level);

}  // namespace chromeball::detecting
