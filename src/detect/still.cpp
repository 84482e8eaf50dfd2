#include "detect/still.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "detect/candidates.h"
#include "detect/follow.h"

namespace chromeball::detecting {
namespace {

constexpr std::size_t kMostCandidates = 8;
constexpr std::size_t kMostFollowed = 28;
constexpr std::size_t kMostCandidatesExpected = 3;  // the same where a ball is expected
constexpr std::size_t kMostFollowedExpected = 8;
constexpr std::size_t kMostCandidatesKnown = 3;  // where it is known but for a sixth of its radius
constexpr double kHopeless = 1e-4;
constexpr std::size_t kMostEscaping = 6;
constexpr double kNested = 0.25;  // of the radius: so near, only one of two rims is a ball's

void tell(const Watch& watch, double part) {
    if (watch.progress) watch.progress(part);
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

/// Where rims are followed from.
std::vector<Outline> starts_of(const Picture& picture, const Wish& wish, const Watch& watch) {
    if (wish.start) return starts_around(*wish.start);
    std::vector<Outline> starts;
    for (const Seed& seed : find_seeds(picture.levels, wish.radius_range, watch))
        starts.push_back({seed.x, seed.y, seed.radius, seed.radius, 0});
    return starts;
}

}  // namespace

Found still_balls(const Picture& picture, const Wish& wish, const Watch& watch) {
    const Size size = picture.grey.pixels.size;
    const std::size_t followed = wish.expected ? kMostFollowedExpected : kMostFollowed;
    const std::size_t kept = wish.start      ? kMostCandidatesKnown
                             : wish.expected ? kMostCandidatesExpected
                                             : kMostCandidates;
    Found found;
    std::vector<Draft>& drafts = found.drafts;
    for (const Outline& start : starts_of(picture, wish, watch)) {
        Draft draft;
        draft.outline = start;
        if (!wanted(draft.outline, wish, 0.25)) continue;
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
    found.rough = drafts;
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
    sort_by_score(drafts);
    return found;
}

}  // namespace chromeball::detecting
