#include "detect/detect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "detect/finished.h"
#include "detect/moving.h"
#include "detect/seek_moved.h"
#include "detect/still.h"
#include "detect/unfocused.h"
#include "detect/wish.h"

namespace chromeball {
namespace {

using namespace detecting;

constexpr int kFinestLevel = 1200;  // long side of the finest level

/// The camera's part in the shape of outlines, in pixels of the photo's window.
Lens lens_of(const Photo& photo, const DetectOptions& options) {
    if (options.camera && options.camera->focal)
        return {*options.camera->focal, options.camera->principal.x - photo.window.x,
                options.camera->principal.y - photo.window.y, true};
    V2d principal(0.5 * photo.display.width, 0.5 * photo.display.height);
    if (options.camera) principal = options.camera->principal;
    // 1.4 picture widths is 40 degrees across: a usual lens for a ball on a set.
    return {1.4 * std::max(photo.display.width, photo.display.height), principal.x - photo.window.x,
            principal.y - photo.window.y, false};
}

/// Whether the middle of one lies inside the other: not two balls, as a rule.
bool overlap(const Outline& one, const Outline& other) {
    return std::hypot(one.cx - other.cx, one.cy - other.cy) < std::max(one.b, other.b);
}

/// Where a ball may have moved or not only the likelier way is told.
void drop_other_ways(std::vector<Candidate>& balls) {
    std::vector<Candidate> kept;
    for (const Candidate& ball : balls)
        if (std::none_of(kept.begin(), kept.end(), [&](const Candidate& better) {
                return overlap(better.outline, ball.outline) &&
                       (better.motion.length2() > 0 || ball.motion.length2() > 0);
            }))
            kept.push_back(ball);
    balls = std::move(kept);
}

/// Of outlines that overlap at most one is a ball's; each confidence is given that the better ones
/// are wrong.
void share_doubt(std::vector<Candidate>& balls) {
    for (std::size_t i = balls.size(); i-- > 1;)
        for (std::size_t j = 0; j < i; ++j)
            if (overlap(balls[i].outline, balls[j].outline))
                balls[i].confidence *= 1 - balls[j].confidence;
}

void tell(const Watch& watch, double part) {
    if (watch.progress) watch.progress(part);
}

/// Best first, and how sure of them given each other.
std::vector<Candidate> told(std::vector<Candidate> balls) {
    sort_by_confidence(balls);
    drop_other_ways(balls);
    share_doubt(balls);
    sort_by_confidence(balls);
    return balls;
}

/// Whether something else needs to be sought: no ball is there that clearly stood still, or is
/// followed as one that did.
template <class Ball>
bool unsettled(const Picture& picture, const Wish& wish, const std::vector<Ball>& balls,
               double Ball::*sure) {
    const double enough = wish.motion ? kWorthSettling : kFound;
    return std::none_of(balls.begin(), balls.end(), [&](const Ball& ball) {
        return ball.*sure >= enough &&
               (wish.motion || !may_have_moved(picture.levels, ball.outline));
    });
}

/// All balls of a picture, best first, each place told once.
std::vector<Candidate> all_balls(const Picture& picture, const Wish& wish, const Watch& watch) {
    if (wish.motion && wish.motion->length2() > 0)
        return told(
            finished(follow_moved(*wish.start, *wish.motion, picture), picture, wish, watch));
    Found found = still_balls(picture, wish, watch);
    std::vector<Candidate> soft;
    if (unsettled(picture, wish, found.drafts, &Draft::score)) {
        watch.check();
        if (found.drafts.empty() || found.drafts.front().score < kFound)
            soft = unfocused_balls(picture, wish, watch);
        // Seeking moved ones costs as much as all else.
        if (unsettled(picture, wish, soft, &Candidate::confidence))
            for (const Draft& ball : seek_moved(found.rough, picture)) found.drafts.push_back(ball);
        sort_by_score(found.drafts);
    }
    std::vector<Candidate> balls = finished(std::move(found.drafts), picture, wish, watch);
    balls.insert(balls.end(), soft.begin(), soft.end());
    return told(std::move(balls));
}

}  // namespace

std::vector<Candidate> find_balls(const Photo& photo, const DetectOptions& options,
                                  const Watch& watch) {
    watch.check();
    const Size size = photo.window.size;
    if (std::min(size.width, size.height) < 16) return {};  // no ball of 12 pixels' radius shows
    const Lens lens = lens_of(photo, options);
    Lens hint = lens;
    hint.known = false;
    Picture picture{grey_of(photo), {}, hint, lens};
    picture.levels = pyramid(picture.grey.pixels, kFinestLevel);

    std::vector<Candidate> balls = all_balls(picture, wish_of(options, photo), watch);
    for (Candidate& ball : balls) {
        ball.outline.cx += photo.window.x;
        ball.outline.cy += photo.window.y;
    }
    tell(watch, 1);
    return balls;
}

}  // namespace chromeball
