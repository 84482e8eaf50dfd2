#pragma once

#include <vector>

#include "core/outline.h"
#include "detect/grey.h"
#include "detect/shape.h"
#include "map/camera.h"

namespace chromeball::detecting {

/// Where the edges that moved along were in the middle of the exposure, and so which outline holds
/// them.
///
/// Of what moved by L every edge appears twice, half of L to either side of where it was in the
/// middle of the exposure, with opposite signs (see streaks.cpp). So the second derivative along
/// the motion, multiplied by itself L further on, is negative where an edge of the ball was, its
/// rim too, and anything on the average where nothing moved. That is a picture of the ball alone,
/// sharp, in the middle of the exposure; the outline sought is the one that has it inside.
class Pairs {
public:
    /// `start` and `motion` in pixels of the level; outlines wrong by up to a quarter of the radius
    /// are told apart.
    Pairs(const Level& level, const Outline& start, const V2d& motion);

    /// How much speaks for an outline, against others; natural logarithm.
    double evidence(const Shape& shape) const;
    /// How sharply the moved edges end at the start's rim: how many more there are right inside
    /// than right outside, over how many there are inside. About 1 if that is the outline.
    double ending() const { return ending_; }

private:
    Shape base_;
    std::vector<Ray> rays_;
    double ending_ = 0;
    int half_ = 0;               ///< offsets to either side
    std::vector<float> inside_;  ///< by ray and offset: what is gained by having all up to there
};

}  // namespace chromeball::detecting
