#include "detect/finished.h"

#include <algorithm>

#include "detect/deviation.h"
#include "detect/follow.h"
#include "detect/score.h"
#include "detect/shape.h"

namespace chromeball::detecting {
namespace {

constexpr double kWorthTelling = 0.05;  // candidates below it are only clutter, but for the best

/// A draft that stood still after the finest fits, with its signs.
Candidate fitted(Draft& draft, const Picture& picture, bool always) {
    finish(draft, picture, always);
    Candidate ball;
    ball.signs = signs_of(draft.evidence, draft.last);
    ball.confidence = chance_of(weights(), ball.signs);
    return ball;
}

}  // namespace

void sort_by_confidence(std::vector<Candidate>& balls) {
    std::stable_sort(balls.begin(), balls.end(), [](const Candidate& a, const Candidate& b) {
        return a.confidence > b.confidence;
    });
}

std::vector<Candidate> finished(std::vector<Draft> drafts, const Picture& picture, const Wish& wish,
                                const Watch& watch) {
    std::vector<Candidate> balls;
    for (Draft& draft : drafts) {
        watch.check();
        if (draft.score < kWorthTelling && !balls.empty()) break;
        const bool moved = draft.motion.length2() > 0;
        Candidate ball;
        if (moved) {
            ball.confidence = draft.score;
            ball.signs = draft.moved_signs;
        } else {
            ball = fitted(draft, picture, balls.empty());
        }
        if (!wanted(draft.outline, wish, 0.01)) continue;
        ball.outline = draft.outline;
        ball.deviation =
            deviation_of(ball.outline, draft.covariance.value_or(rough_covariance(draft)));
        ball.visible_rim = draft.rim.visible;
        ball.rim_blur = draft.rim.blur;
        ball.focal = draft.focal;
        ball.motion = draft.motion;
        balls.push_back(ball);
    }
    sort_by_confidence(balls);
    return balls;
}

}  // namespace chromeball::detecting
