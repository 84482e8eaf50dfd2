#include "detect/follow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chromeball::detecting {
namespace {

RimSearch search_of(const Pass& pass, double r) {
    const int independent = static_cast<int>(2 * std::numbers::pi * r / 1.5);
    return {.rays = std::clamp(independent, 24, pass.rays),
            .reach = std::max(pass.reach * r, 4.0),
            .step = 0.5,
            .smooth = 1.0,
            .loose = std::max(pass.loose * r, 1.2),
            .tight = std::max(pass.tight * r, 0.6)};
}

/// The rim from one start, in pixels of the photo. blur: of the rim as far as it is known, of the
/// photo; a level on which it is wider than a few pixels only shows how noisy it is.
Rim followed(const Picture& picture, const Outline& start, const Pass& pass, double blur) {
    constexpr double kWidest = 1.6, kLeastRadius = 60;  // pixels of the level
    const double r = radius(start);
    const double largest =
        std::min(pass.largest_radius, std::max(kLeastRadius, kWidest * r / std::max(blur, 1e-3)));
    if (r <= largest)
        return fit_rim(picture.grey, Tone::compressed, start, search_of(pass, r), picture.lens);
    const Level& level = level_for(picture.levels, r, largest);
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
    // A rim out of focus looks to the mirror's model as a sharp one further out: how soft it is has
    // to be told.
    constexpr double kSoft = 1.1;  // pixels
    double step = std::max(kFinestStep, 0.5 * draft.rim.blur);
    double blur = draft.rim.blur > kSoft ? draft.rim.blur : 0;
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

}  // namespace

void follow(Draft& draft, const Picture& picture, const Pass& pass) {
    const Outline first = draft.outline;
    const double blur = draft.rim.blur;
    double best = -1;
    for (const double factor : pass.starts) {
        if (factor == 0) continue;
        Outline start = first;
        start.a *= factor;
        start.b *= factor;
        keep_if_better(draft, best, followed(picture, start, pass, blur));
    }
}

void escape(Draft& draft, const Picture& picture) {
    constexpr int kDirections = 8;
    constexpr double kShift = 0.045;  // of the radius: about what the first pass may be wrong by
    const Pass pass{350, 160, 0.09, 0.035, 0.006, {1}};
    const Outline first = draft.outline;
    const double r = radius(first);
    const double blur = draft.rim.blur;
    double best = followed(picture, first, pass, blur).significance;
    for (int i = 0; i < kDirections; ++i) {
        const double turn = 2 * std::numbers::pi * i / kDirections;
        const Outline start{first.cx + kShift * r * std::cos(turn),
                            first.cy + kShift * r * std::sin(turn), first.a * (1 + kShift),
                            first.b * (1 + kShift), first.angle};
        keep_if_better(draft, best, followed(picture, start, pass, blur));
    }
}

void finish(Draft& draft, const Picture& picture, bool always) {
    const Outline before = draft.outline;
    follow_finely(draft, picture);
    draft.last.coverage = draft.rim.coverage;
    draft.last.visible = draft.rim.visible / std::max(draft.rim.inside_picture, 0.1);
    if (always || draft.score >= kWorthSettling) settle_edge(draft, picture);
    draft.last.change = rim_deviation(draft.outline, before);
}

}  // namespace chromeball::detecting
