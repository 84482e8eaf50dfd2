#include "detect/wish.h"

#include <cmath>

#include "detect/shape.h"

namespace chromeball::detecting {

Wish wish_of(const DetectOptions& options, const Photo& photo) {
    Wish wish{options.near, options.radius_range, options.start, options.motion,
              options.expected || options.start};
    if (wish.near) *wish.near -= V2d(photo.window.x, photo.window.y);
    if (wish.start) {
        wish.start->cx -= photo.window.x;
        wish.start->cy -= photo.window.y;
    }
    return wish;
}

Wish scaled(const Wish& wish, double scale) {
    Wish other = wish;
    if (other.near) *other.near *= scale;
    if (other.radius_range)
        for (double& radius : *other.radius_range) radius *= scale;
    if (other.start) other.start = scaled(*other.start, scale, scale);
    if (other.motion) *other.motion *= scale;
    return other;
}

bool wanted(const Outline& o, const Wish& wish, double tolerance) {
    const double r = radius(o);
    if (const auto& range = wish.radius_range)
        if (r < (*range)[0] * (1 - tolerance) || r > (*range)[1] * (1 + tolerance)) return false;
    if (!wish.near) return true;
    return std::hypot(wish.near->x - o.cx, wish.near->y - o.cy) <= r * (1 + tolerance);
}

}  // namespace chromeball::detecting
