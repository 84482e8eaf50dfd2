#include "detect/draft.h"

#include <algorithm>
#include <cmath>

namespace chromeball::detecting {
namespace {

void sort_by_significance(std::vector<Draft>& drafts) {
    std::stable_sort(drafts.begin(), drafts.end(), [](const Draft& a, const Draft& b) {
        return a.rim.significance > b.rim.significance;
    });
}

}  // namespace

bool same(const Outline& one, const Outline& other, double tolerance) {
    const double r = std::min(radius(one), radius(other));
    return std::hypot(one.cx - other.cx, one.cy - other.cy) < tolerance * r &&
           std::abs(radius(one) - radius(other)) < tolerance * r;
}

bool lost(const Outline& o, Size size) {
    const double r = radius(o);
    if (!(o.b > 0) || !(r >= 6) || !(r < 2.0 * std::max(size.width, size.height))) return true;
    return o.cx < -0.7 * r || o.cy < -0.7 * r || o.cx > size.width + 0.7 * r ||
           o.cy > size.height + 0.7 * r || o.b < 0.75 * o.a;
}

void judge(Draft& draft, const Picture& picture) {
    const Level& level = level_for(picture.levels, radius(draft.outline), kScoredRadius);
    draft.evidence =
        evidence_of(level, scaled(draft.outline, 1 / level.scale_x, 1 / level.scale_y), draft.rim);
    draft.evidence.photo_radius = radius(draft.outline);
    draft.score = score_of(draft.evidence);
}

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

}  // namespace chromeball::detecting
