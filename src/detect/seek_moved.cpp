#include "detect/seek_moved.h"

#include <algorithm>
#include <utility>

#include "detect/moving.h"

namespace chromeball::detecting {
namespace {

Draft draft_of(const MovedBall& ball) {
    Draft draft;
    draft.outline = ball.outline;
    draft.motion = ball.motion;
    draft.covariance = ball.covariance;
    draft.rim.visible = ball.visible;
    draft.score = ball.chance;
    draft.moved_signs = ball.signs;
    return draft;
}

}  // namespace

std::vector<Draft> seek_moved(const std::vector<Draft>& rough, const Picture& picture) {
    constexpr double kHopelessInside = 1e-3;
    constexpr double kLeastPromise = 0.01;  // of the best place's
    constexpr std::size_t kMostPlaces = 12;
    constexpr double kClear = 0.25;  // clarity of streaks; more does not say more
    constexpr double kSameHope = 0.06;
    constexpr double kSameThing = 0.4;
    constexpr std::size_t kMostFits = 5;
    std::vector<std::pair<double, Outline>> places;  // with what speaks for a ball there
    for (const Draft& draft : rough)
        if (const double inside = score_inside(draft); inside >= kHopelessInside)
            places.emplace_back(inside * draft.rim.coverage, draft.outline);
    std::stable_sort(places.begin(), places.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::pair<double, MovedStart>> hopes;  // with how promising they are
    std::vector<Outline> seen;
    for (const auto& [promise, place] : places) {
        if (seen.size() == kMostPlaces || promise < kLeastPromise * places.front().first) break;
        if (std::any_of(seen.begin(), seen.end(),
                        [&](const Outline& o) { return same(o, place, kSameHope); }))
            continue;
        seen.push_back(place);
        if (const auto start = moved_start(picture.levels, place))
            hopes.emplace_back(std::min(start->clarity, kClear) * promise, *start);
    }
    std::stable_sort(hopes.begin(), hopes.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    // One thing moves one way: what lies over each other has the motion that shows best.
    std::vector<MovedStart> starts;
    for (std::size_t i = 0; i < std::min(hopes.size(), kMostFits); ++i) {
        MovedStart start = hopes[i].second;
        for (const auto& [promise, other] : hopes)
            if (other.clarity > start.clarity && same(other.outline, start.outline, kSameThing))
                start.motion = other.motion, start.clarity = other.clarity;
        starts.push_back(start);
    }
    std::vector<Draft> found;
    for (const MovedBall& ball : moved_balls(picture.grey, picture.levels, starts, picture.exact))
        if (!lost(ball.outline, picture.grey.pixels.size)) found.push_back(draft_of(ball));
    return found;
}

std::vector<Draft> follow_moved(const Outline& start, const V2d& motion, const Picture& picture) {
    constexpr double kShift = 0.03;  // of the radius
    constexpr double kClear = 1;
    std::vector<MovedStart> starts;
    for (const double side : {-1.0, 0.0, 1.0}) {
        Outline one = start;
        // Across its way, along which the rim is smeared.
        const V2d way = motion / motion.length();
        one.cx -= side * kShift * start.a * way.y;
        one.cy += side * kShift * start.a * way.x;
        one.a *= 1 + side * kShift;
        one.b *= 1 + side * kShift;
        starts.push_back({one, motion, kClear});
    }
    std::vector<Draft> found;
    for (const MovedBall& ball :
         moved_balls(picture.grey, picture.levels, starts, picture.exact, start))
        if (!lost(ball.outline, picture.grey.pixels.size)) found.push_back(draft_of(ball));
    sort_by_score(found);
    return found;
}

}  // namespace chromeball::detecting
