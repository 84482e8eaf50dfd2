#pragma once

#include <optional>
#include <vector>

#include "detect/edge.h"
#include "detect/focal.h"
#include "detect/grey.h"
#include "detect/rim.h"
#include "detect/score.h"

namespace chromeball::detecting {

constexpr double kWorthSettling = 0.15;  ///< the score from which the last fits may change a fate

/// What candidates are sought in.
struct Picture {
    Grey grey;
    std::vector<Level> levels;
    Lens lens;   ///< for the search: only a hint, for a wrong start must be free to bend away
    Lens exact;  ///< for the last fits: exact where the camera is known
};

/// A candidate on its way; outline in pixels of the photo's pixel window.
struct Draft {
    Outline outline;
    Rim rim;
    Evidence evidence;
    LastFit last;
    double score = 0;
    V2d motion{0, 0};                           ///< during the exposure, pixels
    std::vector<double> moved_signs;            ///< where it moved
    std::optional<ShapeCovariance> covariance;  ///< of the outline as a Shape
    std::optional<FocalEstimate> focal;
};

/// Same ball: outlines nearly on top of each other.
bool same(const Outline& one, const Outline& other, double tolerance);

/// Nothing a ball's outline could be: lost, too small, almost all outside the picture.
bool lost(const Outline& o, Size size);

/// Weighs what a draft shows of a mirror ball: evidence and score.
void judge(Draft& draft, const Picture& picture);

/// What a draft would be worth if its rim were perfect.
double score_inside(const Draft& draft);

void sort_by_score(std::vector<Draft>& drafts);

/// Best first, one for each ball, at most `most`.
void thin_out(std::vector<Draft>& drafts, double tolerance, std::size_t most, Size size);

}  // namespace chromeball::detecting
