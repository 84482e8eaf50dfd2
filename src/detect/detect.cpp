#include "detect/detect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "detect/candidates.h"
#include "detect/edge.h"
#include "detect/focal.h"
#include "detect/grey.h"
#include "detect/moving.h"
#include "detect/rim.h"
#include "detect/score.h"

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
constexpr double kWorthSettling = 0.15;
constexpr double kFound = 0.5;
constexpr double kHopeless = 1e-4;
constexpr std::size_t kMostEscaping = 6;
constexpr double kNested = 0.25;  // of the radius: so near, only one of two rims is a ball's

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
bool same(const Outline& one, const Outline& other, double tolerance) {
    const double r = std::min(radius(one), radius(other));
    return std::hypot(one.cx - other.cx, one.cy - other.cy) < tolerance * r &&
           std::abs(radius(one) - radius(other)) < tolerance * r;
}

/// Nothing a ball's outline could be: lost, too small, almost all outside the picture.
bool lost(const Outline& o, Size size) {
    const double r = radius(o);
    if (!(o.b > 0) || !(r >= 6) || !(r < 2.0 * std::max(size.width, size.height))) return true;
    return o.cx < -0.7 * r || o.cy < -0.7 * r || o.cx > size.width + 0.7 * r ||
           o.cy > size.height + 0.7 * r || o.b < 0.75 * o.a;
}

/// How a rim is followed at one scale: everything in parts of the radius, but never finer than the
/// pixels allow.
struct Pass {
    double largest_radius;  ///< of the level used
    int rays;
    double reach, loose, tight;
    std::array<double, 3> starts;  ///< radii to start from; the true rim is rarely further inside
};
constexpr Pass kPasses[] = {{72, 80, 0.22, 0.08, 0.02, {1}},
                            {130, 160, 0.10, 0.04, 0.010, {1, 1.04, 1.08}},
                            {350, 256, 0.05, 0.016, 0.005, {1, 1.012, 1.025}}};

/// What candidates are sought in.
struct Picture {
    Grey grey;
    std::vector<Level> levels;
    Lens lens;   ///< for the search: only a hint, for a wrong start must be free to bend away
    Lens exact;  ///< for the last fits: exact where the camera is known
};

RimSearch search_of(const Pass& pass, double r) {
    const int independent = static_cast<int>(2 * std::numbers::pi * r / 1.5);
    return {.rays = std::clamp(independent, 24, pass.rays),
            .reach = std::max(pass.reach * r, 4.0),
            .step = 0.5,
            .smooth = 1.0,
            .loose = std::max(pass.loose * r, 1.2),
            .tight = std::max(pass.tight * r, 0.6)};
}

/// The rim from one start, in pixels of the photo.
Rim followed(const Picture& picture, const Outline& start, const Pass& pass) {
    const double r = radius(start);
    if (r <= pass.largest_radius)
        return fit_rim(picture.grey, Tone::compressed, start, search_of(pass, r), picture.lens);
    const Level& level = level_for(picture.levels, r, pass.largest_radius);
    const double sx = level.scale_x, sy = level.scale_y;
    Rim rim = fit_rim(level.grey, scaled(start, 1 / sx, 1 / sy), search_of(pass, r / level.scale()),
                      picture.lens.scaled(1 / sx, 1 / sy));
    rim.outline = scaled(rim.outline, sx, sy);
    rim.blur *= level.scale();
    rim.scatter *= level.scale();
    return rim;
}

/// Takes a rim over if it is more significant than the best so far.
void keep_if_better(Draft& draft, double& best, const Rim& rim) {
    if (rim.significance <= best) return;
    best = rim.significance;
    draft.rim = rim;
    draft.outline = rim.outline;
}

/// Follows the rim from several starts and keeps the most significant: close inside of a mirror
/// ball's rim its reflections make weaker rims of their own.
void follow(Draft& draft, const Picture& picture, const Pass& pass) {
    const Outline first = draft.outline;
    double best = -1;
    for (const double factor : pass.starts) {
        if (factor == 0) continue;
        Outline start = first;
        start.a *= factor;
        start.b *= factor;
        keep_if_better(draft, best, followed(picture, start, pass));
    }
}

/// Starts from circles that touch the draft's on the far side, all around it: a false rim often
/// shares a part of the true one and cuts through the ball elsewhere.
void escape(Draft& draft, const Picture& picture) {
    constexpr int kDirections = 8;
    constexpr double kShift = 0.045;  // of the radius: about what the first pass may be wrong by
    const Pass pass{350, 160, 0.09, 0.035, 0.006, {1}};
    const Outline first = draft.outline;
    const double r = radius(first);
    double best = followed(picture, first, pass).significance;
    for (int i = 0; i < kDirections; ++i) {
        const double turn = 2 * std::numbers::pi * i / kDirections;
        const Outline start{first.cx + kShift * r * std::cos(turn),
                            first.cy + kShift * r * std::sin(turn), first.a * (1 + kShift),
                            first.b * (1 + kShift), first.angle};
        keep_if_better(draft, best, followed(picture, start, pass));
    }
}

/// On the photo's own pixels, with a window as wide as the blur asks for.
void follow_finely(Draft& draft, const Picture& picture) {
    for (int round = 0; round < 3; ++round) {
        const double r = radius(draft.outline), blur = std::max(0.6, draft.rim.blur);
        const double wide = round == 0 ? 1.5 : 1.0;
        const RimSearch search{
            .rays = std::clamp(static_cast<int>(2 * std::numbers::pi * r), 96, 1200),
            .reach = wide * (2 + 4 * blur),
            .step = std::max(0.25, 0.35 * blur),
            .smooth = std::max(0.6, 0.5 * blur),
            .loose = wide * (1 + blur),
            .tight = 0.5 + 0.5 * blur,
            .shade = 3 + 4 * blur};
        const Rim rim = fit_rim(picture.grey, Tone::linear, draft.outline, search, picture.exact);
        if (lost(rim.outline, picture.grey.pixels.size)) return;
        draft.outline = rim.outline;
        draft.rim = rim;
    }
}

/// The last word on the rim, where it shows well enough: by what a mirror must look like there.
void settle_edge(Draft& draft, const Picture& picture) {
    constexpr double kFinestStep = 0.7;  // pixels: finer samples share their pixels' noise
    constexpr double kLeastEvidence = 4.5;
    double step = std::max(kFinestStep, 0.5 * draft.rim.blur);
    double blur = 0;
    for (int round = 0; round < 3; ++round) {
        const double r = radius(draft.outline);
        const double spacing = std::clamp(r / 40, std::max(1.0, step), 6.0);
        const int rays = static_cast<int>(2 * std::numbers::pi * r / spacing);
        const EdgeSearch search{.rays = std::clamp(rays, 64, 448), .step = step, .blur = blur};
        const EdgeFit fit = fit_edge(picture.grey, draft.outline, search, picture.exact);
        draft.last.deviation = std::sqrt(fit.covariance[2][2]);
        if (fit.known < 0.5 || fit.evidence < kLeastEvidence) return;
        if (lost(fit.outline, picture.grey.pixels.size)) return;
        const bool done = rim_deviation(fit.outline, draft.outline) < 0.05;
        draft.outline = fit.outline;
        draft.covariance = fit.covariance;
        if (fit.free) draft.focal = focal_of(fit.free->shape, fit.free->covariance, picture.exact);
        if (done) return;
        blur = fit.blur;
        step = std::clamp(0.8 * fit.blur, std::max(kFinestStep, 0.7 * step), 1.6 * step);
    }
}

/// The finest fits. One is always settled, for something must be said of it.
void finish(Draft& draft, const Picture& picture, bool always) {
    const Outline before = draft.outline;
    follow_finely(draft, picture);
    draft.last.visible = draft.rim.visible / std::max(draft.rim.inside_picture, 0.1);
    if (always || draft.score >= kWorthSettling) settle_edge(draft, picture);
    draft.last.change = rim_deviation(draft.outline, before);
}

void sort_by_significance(std::vector<Draft>& drafts) {
    std::stable_sort(drafts.begin(), drafts.end(), [](const Draft& a, const Draft& b) {
        return a.rim.significance > b.rim.significance;
    });
}

/// Best first, one for each ball, at most `most`.
void thin_out(std::vector<Draft>& drafts, double tolerance, std::size_t most, Size size) {
    sort_by_significance(drafts);
    std::vector<Draft> kept;
    for (const Draft& draft : drafts) {
        if (kept.size() == most) break;
        if (lost(draft.outline, size)) continue;
        if (std::none_of(kept.begin(), kept.end(),
                         [&](const Draft& k) { return same(k.outline, draft.outline, tolerance); }))
            kept.push_back(draft);
    }
    drafts = std::move(kept);
}

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

void judge(Draft& draft, const Picture& picture) {
    const Level& level = level_for(picture.levels, radius(draft.outline), kScoredRadius);
    draft.evidence =
        evidence_of(level, scaled(draft.outline, 1 / level.scale_x, 1 / level.scale_y), draft.rim);
    draft.evidence.photo_radius = radius(draft.outline);
    draft.score = score_of(draft.evidence);
}

/// What a draft would be worth if its rim were perfect.
double score_inside(const Draft& draft) {
    Evidence e = draft.evidence;
    e.rim.coverage = e.rim.visible = e.rim.inside_picture = 1;
    e.rim.significance = 1000;
    return score_of(e);
}

void sort_by_score(std::vector<Draft>& drafts) {
    std::stable_sort(drafts.begin(), drafts.end(),
                     [](const Draft& a, const Draft& b) { return a.score > b.score; });
}

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

/// Balls that moved during the exposure, near the most promising drafts: those that show the world,
/// and streaks. The rim of such a ball is weak, so `rough` drafts count that were passed over.
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

/// A ball that is known to have moved, from where it must be and from closely around: where several
/// starts end says how sure that is.
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

/// What is known of an outline of which only single edges' scatter is.
ShapeCovariance rough_covariance(const Draft& draft) {
    // One independent edge every four pixels of the rim that shows.
    const double r = radius(draft.outline), shown = std::max(draft.rim.visible, 0.05);
    const double count = std::max(5.0, shown * 2 * std::numbers::pi * r / 4);
    const double variance = std::pow(std::max(draft.rim.scatter, 0.3), 2) / (count * shown);
    ShapeCovariance c{};
    c[0][0] = c[1][1] = 2 * variance;
    c[2][2] = variance;
    c[3][3] = c[4][4] = 2 * variance / (r * r);
    return c;
}

OutlineDeviation deviation_of(const Outline& o, const ShapeCovariance& c) {
    const double r = radius(o), e = (o.a - o.b) / (o.a + o.b);
    const double twice = 2 * o.angle * std::numbers::pi / 180;
    const double cos2 = std::cos(twice), sin2 = std::sin(twice);
    const auto deviation = [&](const std::array<double, 5>& u) {
        double sum = 0;
        for (std::size_t i = 0; i < 5; ++i)
            for (std::size_t j = 0; j < 5; ++j) sum += u[i] * c[i][j] * u[j];
        return std::sqrt(std::max(sum, 0.0));
    };
    const double across = deviation({0, 0, 0, -sin2, cos2});
    constexpr double kAnyAngle = 51.96;  // 180 / sqrt(12)
    const double angle = across < 2 * e ? 90 / std::numbers::pi * across / e : kAnyAngle;
    return {std::sqrt(c[0][0]), std::sqrt(c[1][1]), deviation({0, 0, 1 + e, r * cos2, r * sin2}),
            deviation({0, 0, 1 - e, -r * cos2, -r * sin2}), std::min(angle, kAnyAngle)};
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
