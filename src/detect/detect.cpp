#include "detect/detect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "detect/candidates.h"
#include "detect/deviation.h"
#include "detect/draft.h"
#include "detect/follow.h"
#include "detect/grey.h"
#include "detect/moving.h"
#include "detect/rim.h"
#include "detect/score.h"
#include "detect/seek_moved.h"

namespace chromeball {
namespace {

using namespace detecting;

constexpr int kFinestLevel = 1200;  // long side of the finest level
constexpr std::size_t kMostCandidates = 8;
constexpr std::size_t kMostFollowed = 28;
constexpr std::size_t kMostCandidatesExpected = 3;  // the same where a ball is expected
constexpr std::size_t kMostFollowedExpected = 8;
constexpr std::size_t kMostCandidatesKnown = 3;  // where it is known but for a sixth of its radius
constexpr double kWorthTelling = 0.05;  // candidates below it are only clutter, but for the best
constexpr double kFound = 0.5;
constexpr double kHopeless = 1e-4;
constexpr std::size_t kMostEscaping = 6;
constexpr double kNested = 0.25;  // of the radius: so near, only one of two rims is a ball's

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

/// Of rims around nearly the same place the best: the outer ones before the inner, which may be
/// reflections, if they are at all as sure.
void drop_nested(std::vector<Draft>& drafts) {
    const auto value = [](const Draft& d) { return d.rim.coverage * radius(d.outline); };
    std::vector<Draft> kept;
    std::stable_sort(drafts.begin(), drafts.end(),
                     [&](const Draft& a, const Draft& b) { return value(a) > value(b); });
    for (const Draft& draft : drafts) {
        const bool beaten = std::any_of(drafts.begin(), drafts.end(), [&](const Draft& other) {
            return same(other.outline, draft.outline, kNested) &&
                   draft.rim.significance < 0.15 * other.rim.significance;
        });
        if (!beaten && std::none_of(kept.begin(), kept.end(), [&](const Draft& k) {
                return same(k.outline, draft.outline, kNested);
            }))
            kept.push_back(draft);
    }
    drafts = std::move(kept);
}

/// Whether it can be the ball that the options ask for, with a tolerance for a first rough outline.
bool wanted(const Outline& o, const Photo& photo, const DetectOptions& options, double tolerance) {
    const double r = radius(o);
    if (const auto& range = options.radius_range)
        if (r < (*range)[0] * (1 - tolerance) || r > (*range)[1] * (1 + tolerance)) return false;
    if (!options.near) return true;
    return std::hypot(options.near->x - photo.window.x - o.cx,
                      options.near->y - photo.window.y - o.cy) <= r * (1 + tolerance);
}

/// Whether the middle of one lies inside the other: not two balls, as a rule.
bool overlap(const Outline& one, const Outline& other) {
    return std::hypot(one.cx - other.cx, one.cy - other.cy) < std::max(one.b, other.b);
}

void sort_by_confidence(std::vector<Candidate>& balls) {
    std::stable_sort(balls.begin(), balls.end(), [](const Candidate& a, const Candidate& b) {
        return a.confidence > b.confidence;
    });
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

/// Around where the ball must be, close enough for the first pass to find the rim from one of them.
std::vector<Outline> starts_around(const Outline& start) {
    std::vector<Outline> starts{start};
    const auto add = [&](double size, double shift, double turn) {
        starts.push_back({start.cx + shift * start.a * std::cos(turn),
                          start.cy + shift * start.a * std::sin(turn), size * start.a,
                          size * start.b, start.angle});
    };
    // No larger ones: what they find outside of the ball would count as its rim.
    add(0.93, 0, 0);
    constexpr int kDirections = 6;
    constexpr double kShift = 0.15;
    for (int i = 0; i < kDirections; ++i) add(1, kShift, 2 * std::numbers::pi * i / kDirections);
    return starts;
}

/// Where rims are followed from, in pixels of the photo's window.
std::vector<Outline> starts_of(const Picture& picture, const Photo& photo,
                               const DetectOptions& options, const Watch& watch) {
    if (options.start) {
        Outline start = *options.start;
        start.cx -= photo.window.x;
        start.cy -= photo.window.y;
        return starts_around(start);
    }
    std::vector<Outline> starts;
    for (const Seed& seed : find_seeds(picture.levels, options.radius_range, watch))
        starts.push_back({seed.x, seed.y, seed.radius, seed.radius, 0});
    return starts;
}

std::vector<Draft> drafts_of(const Picture& picture, const Photo& photo,
                             const DetectOptions& options, const Watch& watch) {
    const auto& motion = options.start ? options.motion : std::nullopt;
    if (motion && motion->length2() > 0)
        return follow_moved(starts_of(picture, photo, options, watch).front(), *motion, picture);
    const Size size = picture.grey.pixels.size;
    const bool expected = options.expected || options.start;
    const std::size_t followed = expected ? kMostFollowedExpected : kMostFollowed;
    const std::size_t kept = options.start ? kMostCandidatesKnown
                             : expected    ? kMostCandidatesExpected
                                           : kMostCandidates;
    std::vector<Draft> drafts;
    for (const Outline& start : starts_of(picture, photo, options, watch)) {
        Draft draft;
        draft.outline = start;
        if (!wanted(draft.outline, photo, options, 0.25)) continue;
        follow(draft, picture, kPasses[0]);
        drafts.push_back(draft);
    }
    thin_out(drafts, 0.03, followed, size);
    watch.check();
    tell(watch, 0.4);
    for (Draft& draft : drafts) follow(draft, picture, kPasses[1]);
    thin_out(drafts, 0.015, followed, size);
    for (Draft& draft : drafts) judge(draft, picture);
    sort_by_score(drafts);
    const std::vector<Draft> rough = drafts;
    if (drafts.size() > kept) drafts.resize(kept);
    // What shows nothing of a mirror ball is not worth the finer passes; two always get them.
    while (drafts.size() > 2 && drafts.back().score < kHopeless) drafts.pop_back();
    for (std::size_t i = 0; i < drafts.size(); ++i) {
        watch.check();
        tell(watch, 0.5 + 0.4 * double(i) / double(drafts.size()));
        Draft& draft = drafts[i];
        if (i < kMostEscaping) escape(draft, picture);
        follow(draft, picture, kPasses[2]);
    }
    thin_out(drafts, 0.015, kept, size);
    for (Draft& draft : drafts) judge(draft, picture);
    drop_nested(drafts);
    // Seeking costs as much as all else: not where a ball is found that clearly stood still, or is
    // followed as one that did.
    const double enough = motion ? kWorthSettling : kFound;
    if (std::none_of(drafts.begin(), drafts.end(), [&](const Draft& d) {
            return d.score >= enough && (motion || !may_have_moved(picture.levels, d.outline));
        })) {
        watch.check();
        for (const Draft& ball : seek_moved(rough, picture)) drafts.push_back(ball);
    }
    sort_by_score(drafts);
    return drafts;
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

    std::vector<Candidate> balls;
    for (Draft& draft : drafts_of(picture, photo, options, watch)) {
        watch.check();
        if (draft.score < kWorthTelling && !balls.empty()) break;
        if (draft.motion.length2() == 0) finish(draft, picture, balls.empty());
        if (!wanted(draft.outline, photo, options, 0.01)) continue;
        Candidate ball;
        ball.outline = draft.outline;
        ball.deviation =
            deviation_of(ball.outline, draft.covariance.value_or(rough_covariance(draft)));
        ball.outline.cx += photo.window.x;
        ball.outline.cy += photo.window.y;
        ball.confidence = draft.score;
        ball.signs = draft.moved_signs;
        if (draft.motion.length2() == 0) {
            ball.signs = signs_of(draft.evidence, draft.last);
            ball.confidence = chance_of(weights(), ball.signs);
        }
        ball.visible_rim = draft.rim.visible;
        ball.rim_blur = draft.rim.blur;
        ball.focal = draft.focal;
        ball.motion = draft.motion;
        balls.push_back(ball);
    }
    sort_by_confidence(balls);
    drop_other_ways(balls);
    share_doubt(balls);
    sort_by_confidence(balls);
    tell(watch, 1);
    return balls;
}

}  // namespace chromeball
