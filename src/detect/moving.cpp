#include "detect/moving.h"

#include <algorithm>
#include <cmath>

#include "detect/motion.h"
#include "detect/pairs.h"
#include "detect/score.h"
#include "detect/streaks.h"
#include "detect/weights.h"

namespace chromeball::detecting {
namespace {

constexpr double kStreakRadius = 70;  // of the level on which streaks are sought

struct Near {
    const Level& level;
    Outline outline;  ///< pixels of the level
};

Near near_of(const std::vector<Level>& levels, const Outline& outline) {
    const Level& level = level_for(levels, radius(outline), kStreakRadius);
    return {level, scaled(outline, 1 / level.scale_x, 1 / level.scale_y)};
}

/// A fit, and what speaks for it but for whether other fits agree.
struct Found {
    MotionFit fit;
    std::vector<double> signs;
};

/// How far the length of the motion that the inside tells is from the fitted one, natural
/// logarithm. Of several lengths the nearest counts.
double disagreement(const std::vector<Streaks>& streaks, const V2d& motion) {
    constexpr double kMost = 0.5;
    double least = kMost;
    for (const Streaks& s : streaks)
        least = std::min(least, std::abs(std::log(std::max(s.motion.length(), 0.1) /
                                                  std::max(motion.length(), 0.1))));
    return least;
}

/// All but the last of moved_signs().
std::vector<double> signs_of(const std::vector<Level>& levels, const MotionFit& fit) {
    // The rim has had its say in the fit: here only the inside counts.
    Rim perfect;
    perfect.coverage = perfect.visible = perfect.inside_picture = 1;
    perfect.significance = 1000;
    const Level& level = level_for(levels, radius(fit.outline), kScoredRadius);
    const Evidence inside =
        evidence_of(level, scaled(fit.outline, 1 / level.scale_x, 1 / level.scale_y), perfect);
    const Near near = near_of(levels, fit.outline);
    const V2d motion = fit.motion / near.level.scale();
    const auto streaks = streaks_of(near.level, near.outline, 3);
    return {fit.evidence,
            fit.ends,
            fit.clear,
            fit.amiss,
            fit.certain,
            std::log(score_of(inside) + 1e-4),
            inside.detailed,
            inside.squeeze_before,
            inside.rings,
            disagreement(streaks, motion),
            streaks.empty() ? 0 : streaks.front().clarity,
            Pairs(near.level, near.outline, motion).ending(),
            smoothness_along(near.level, near.outline),
            std::log2(fit.motion.length() / radius(fit.outline)),
            std::log2(radius(fit.outline))};
}

/// What the inside tells more exactly than streaks do, on finer pixels in the end.
V2d motion_inside(const std::vector<Level>& levels, const MovedStart& start) {
    constexpr double kFineRadius = 150;
    V2d motion = start.motion;
    for (const double largest : {kStreakRadius, kStreakRadius, kFineRadius}) {
        const Level& level = level_for(levels, radius(start.outline), largest);
        const Outline outline = scaled(start.outline, 1 / level.scale_x, 1 / level.scale_y);
        motion = settled_motion(level, outline, motion / level.scale()) * level.scale();
    }
    return motion;
}

/// How near other starts led to the same place: 1 if right there.
double nearness(const Outline& o, const Outline& p, double scale = 0.03) {
    const double apart =
        std::max({std::abs(o.cx - p.cx), std::abs(o.cy - p.cy), std::abs(o.b - p.b)});
    return std::exp(-apart / (scale * o.b));
}

double agreement(const std::vector<Found>& all, const Found& one) {
    double sum = 0;
    for (const Found& other : all)
        if (&other != &one) sum += nearness(one.fit.outline, other.fit.outline);
    return sum;
}

/// The mean of a fit and those near it: what each took for the rim differs, the ball does not.
MotionFit averaged(const std::vector<Found>& all, const MotionFit& one) {
    MotionFit mean = one;
    Shape sum{0, 0, 0, 0, 0};
    double weights = 0;
    V2d motion(0);
    for (const Found& other : all) {
        const double w = nearness(one.outline, other.fit.outline);
        const Shape s = shape_of(other.fit.outline);
        sum = {sum.x + w * s.x, sum.y + w * s.y, sum.radius + w * s.radius, sum.e1 + w * s.e1,
               sum.e2 + w * s.e2};
        // Which way round a motion goes is open.
        motion += other.fit.motion * (other.fit.motion.dot(one.motion) < 0 ? -w : w);
        weights += w;
    }
    mean.outline = outline_of({sum.x / weights, sum.y / weights, sum.radius / weights,
                               sum.e1 / weights, sum.e2 / weights});
    mean.motion = motion / weights;
    return mean;
}

/// What two of three errors stay below on painted balls; much of it is not noise but what the
/// smear hides, so it grows with the motion.
ShapeCovariance covariance_of(const MotionFit& fit) {
    const double r = radius(fit.outline), length = fit.motion.length();
    const V2d way = fit.motion / std::max(length, 1e-9);
    const double along = 0.006 * r + 0.045 * length, across = 0.007 * r + 0.01 * length;
    const double larger = 0.008 * r + 0.02 * length;
    ShapeCovariance c{};
    c[0][0] = std::pow(along * way.x, 2) + std::pow(across * way.y, 2);
    c[1][1] = std::pow(along * way.y, 2) + std::pow(across * way.x, 2);
    c[0][1] = c[1][0] = (along * along - across * across) * way.x * way.y;
    c[2][2] = larger * larger;
    c[3][3] = c[4][4] = 0.002 * 0.002;  // the shape is the lens's
    return c;
}

}  // namespace

std::optional<MovedStart> moved_start(const std::vector<Level>& levels, const Outline& outline) {
    constexpr double kMostSmooth = 0.92;
    constexpr double kLeastClarity = 0.07;
    constexpr double kSmallest = 30;  // pixels; below, motions are too short to tell
    if (radius(outline) < kSmallest) return {};
    const Near near = near_of(levels, outline);
    if (smoothness_along(near.level, near.outline) > kMostSmooth) return {};
    const auto streaks = streaks_of(near.level, near.outline, 1);
    if (streaks.empty() || streaks.front().clarity < kLeastClarity) return {};
    return MovedStart{outline, streaks.front().motion * near.level.scale(),
                      streaks.front().clarity};
}

bool may_have_moved(const std::vector<Level>& levels, const Outline& outline) {
    constexpr double kClear = 0.16;
    const auto start = moved_start(levels, outline);
    return start && start->clarity >= kClear;
}

std::vector<MovedBall> moved_balls(const Grey& picture, const std::vector<Level>& levels,
                                   const std::vector<MovedStart>& starts, const Lens& lens,
                                   const std::optional<Outline>& seen) {
    constexpr double kSeenCounts = 3;
    constexpr double kBend = 0.1;  // of the radius: of a path, between where it was seen
    constexpr double kLeastEvidence = 2;
    constexpr double kSmallest = 25;
    std::vector<Found> found;
    for (const MovedStart& start : starts) {
        const Level& level = near_of(levels, start.outline).level;
        const MotionFit fit = fit_motion(picture, level, start.outline,
                                         motion_inside(levels, start), lens, kLeastEvidence);
        if (fit.evidence >= kLeastEvidence && fit.outline.b > kSmallest)
            found.push_back({fit, signs_of(levels, fit)});
    }
    std::vector<MovedBall> balls;
    for (const Found& one : found) {
        double agreed = agreement(found, one);
        if (seen) agreed += kSeenCounts * nearness(one.fit.outline, *seen, kBend);
        std::vector<double> signs = one.signs;
        signs.push_back(agreed);
        const MotionFit fit = averaged(found, one.fit);
        balls.push_back({fit.outline, fit.motion, covariance_of(fit), fit.clear,
                         chance_of(moved_weights(), signs), signs});
    }
    return balls;
}

}  // namespace chromeball::detecting
