#include "detect/unfocused.h"

#include <algorithm>

#include "detect/deviation.h"
#include "detect/finished.h"
#include "detect/follow.h"
#include "detect/score.h"
#include "detect/shape.h"
#include "detect/still.h"

namespace chromeball::detecting {
namespace {

/// The levels of a picture from one on, as a picture of its own.
Picture reduced(const Picture& picture, std::size_t from) {
    const double sx = picture.levels[from].scale_x, sy = picture.levels[from].scale_y;
    Picture small{grey_of(picture.levels[from], picture.grey.linear),
                  {},
                  picture.lens.scaled(1 / sx, 1 / sy),
                  picture.exact.scaled(1 / sx, 1 / sy)};
    for (std::size_t k = from; k < picture.levels.size(); ++k) {
        small.levels.push_back(picture.levels[k]);
        small.levels.back().scale_x /= sx;
        small.levels.back().scale_y /= sy;
    }
    return small;
}

/// A candidate in a picture that is so many times as large.
Candidate enlarged(Candidate ball, double sx, double sy) {
    const double scale = 0.5 * (sx + sy);
    ball.outline = scaled(ball.outline, sx, sy);
    for (double* pixels : {&ball.deviation.cx, &ball.deviation.cy, &ball.deviation.a,
                           &ball.deviation.b, &ball.rim_blur})
        *pixels *= scale;
    if (ball.focal)
        ball.focal = FocalEstimate{ball.focal->focal * scale, ball.focal->deviation * scale};
    return ball;
}

/// How sharp edges inside an outline are on a level.
double crispness_of(const Level& level, const Outline& outline) {
    return evidence_of(level, scaled(outline, 1 / level.scale_x, 1 / level.scale_y), {}).crispness;
}

/// The outline by the photo's own pixels, with windows as wide as the blur, where that comes out
/// near.
void refine(Candidate& ball, const Picture& picture) {
    constexpr double kNear = 0.04;  // of the radius
    Draft draft;
    draft.outline = ball.outline;
    draft.rim.blur = ball.rim_blur;
    finish(draft, picture, true);
    if (rim_deviation(draft.outline, ball.outline) > kNear * radius(ball.outline)) return;
    ball.outline = draft.outline;
    ball.rim_blur = draft.rim.blur;
    if (draft.covariance) ball.deviation = deviation_of(draft.outline, *draft.covariance);
}

}  // namespace

std::vector<Candidate> unfocused_balls(const Picture& picture, const Wish& wish,
                                       const Watch& watch) {
    constexpr int kLeastSide = 64;
    constexpr double kLeastRadius = 16, kSharp = 1.05;
    std::vector<Candidate> best;
    for (std::size_t k = 1; k < picture.levels.size(); ++k) {
        const Level& level = picture.levels[k];
        if (std::max(level.grey.size.width, level.grey.size.height) < kLeastSide) break;
        const Picture small = reduced(picture, k);
        std::vector<Candidate> balls;
        const Wish its = scaled(wish, 1 / level.scale());
        for (Candidate ball :
             finished(still_balls(small, its, {watch.stop}).drafts, small, its, watch)) {
            if (radius(ball.outline) < kLeastRadius) continue;
            ball = enlarged(ball, level.scale_x, level.scale_y);
            // What is sharp on the finer level was seen there for what it is.
            if (crispness_of(picture.levels[k - 1], ball.outline) > kSharp) continue;
            balls.push_back(ball);
        }
        if (!balls.empty() && (best.empty() || balls.front().confidence > best.front().confidence))
            best = balls;
        if (!best.empty() && best.front().confidence >= kFound) break;
    }
    for (Candidate& ball : best) refine(ball, picture);
    return best;
}

}  // namespace chromeball::detecting
