#include "shot/segments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/statistics.h"

namespace chromeball {
namespace {

constexpr double kJump = 4;          // overruled sightings that a jump is worth
constexpr double kJumpFromKey = 16;  // the same from or to what a hand placed, alone
constexpr std::size_t kBack = 32;    // waypoints that may be overruled in a row
constexpr double kCertain = 1e9;

double apart(const Waypoint& a, const Waypoint& b) {
    return std::hypot(a.x - b.x, a.y - b.y, a.radius - b.radius);
}

/// The usual distance from one waypoint to the next around each, pixels a frame.
std::vector<double> usual_speeds(const std::vector<Waypoint>& points) {
    constexpr std::size_t kAround = 6;
    std::vector<double> steps;
    for (std::size_t i = 1; i < points.size(); ++i)
        steps.push_back(apart(points[i - 1], points[i]) / (points[i].frame - points[i - 1].frame));
    std::vector<double> usual;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t from = i > kAround ? i - kAround : 0;
        const std::size_t to = std::min(steps.size(), i + kAround);
        usual.push_back(median({steps.begin() + static_cast<std::ptrdiff_t>(std::min(from, to)),
                                steps.begin() + static_cast<std::ptrdiff_t>(to)}));
    }
    return usual;
}

double overruling(const Waypoint& point) { return point.certain ? kCertain : point.trust; }

}  // namespace

std::vector<int> pieces_of(const std::vector<Waypoint>& points) {
    const std::size_t count = points.size();
    if (count == 0) return {};
    const std::vector<double> usual = usual_speeds(points);

    /// How far the way from one to the other is beyond what is usual; above 1 it is a jump.
    const auto strain = [&](std::size_t from, std::size_t to) {
        const double radius = std::min(points[from].radius, points[to].radius);
        const double speed = std::max(0.12 * radius, 3 * std::max(usual[from], usual[to]));
        return apart(points[from], points[to]) / (speed * (points[to].frame - points[from].frame));
    };

    struct Step {
        double cost = std::numeric_limits<double>::infinity();
        std::ptrdiff_t from = -1;
        bool jump = false;
    };
    std::vector<Step> best(count);
    double before = 0;  // of overruling all so far
    for (std::size_t to = 0; to < count; ++to) {
        best[to].cost = before;
        double between = 0;
        for (std::size_t back = 1; back <= std::min(to, kBack); ++back) {
            const std::size_t from = to - back;
            const double s = strain(from, to);
            // A little for any strain, so that of two ways the smoother one wins.
            // Where a hand says that the ball is, a jump away rather is a wrong sighting.
            const bool from_key = points[from].certain != points[to].certain;
            const double link = s > 1 ? (from_key ? kJumpFromKey : kJump) : 0.3 * s * s;
            const double cost = best[from].cost + between + link;
            if (cost < best[to].cost) best[to] = {cost, std::ptrdiff_t(from), s > 1};
            between += overruling(points[from]);
        }
        before += overruling(points[to]);
    }
    std::size_t last = 0;
    double least = std::numeric_limits<double>::infinity(), after = 0;
    for (std::size_t i = count; i-- > 0; after += overruling(points[i]))
        if (best[i].cost + after < least) {
            least = best[i].cost + after;
            last = i;
        }

    std::vector<int> pieces(count, -1);
    int piece = 0;
    for (auto i = static_cast<std::ptrdiff_t>(last); i >= 0;) {
        const auto at = static_cast<std::size_t>(i);
        pieces[at] = piece;
        piece += best[at].jump;
        i = best[at].from;
    }
    for (int& one : pieces)  // counted from the end
        if (one >= 0) one = piece - one;
    return pieces;
}

}  // namespace chromeball
