#include "light/clipped_regions.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace chromeball {
namespace {

/// Clipped pixels that touch each other, as regions.
std::vector<ClippedRegion> connected(const BallPicture& mirror, std::vector<char> clipped) {
    const int width = mirror.pixels->width(), height = mirror.pixels->height();
    std::vector<double> steradians(clipped.size());
    std::vector<V3d> direction(clipped.size());
    for_ball(mirror, [&](int x, int y, const ShownByBall& shown) {
        const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x);
        steradians[at] = shown.steradians;
        direction[at] = shown.direction;
    });
    std::vector<ClippedRegion> regions;
    for (std::size_t start = 0; start < clipped.size(); ++start) {
        if (!clipped[start] || !(steradians[start] > 0)) continue;
        ClippedRegion region;
        V3d sum(0, 0, 0);
        region.pixels.push_back(start);
        clipped[start] = 0;
        for (std::size_t n = 0; n < region.pixels.size(); ++n) {
            const std::size_t at = region.pixels[n];
            sum += direction[at] * steradians[at];
            region.steradians += steradians[at];
            const int x = static_cast<int>(at % static_cast<std::size_t>(width));
            const int y = static_cast<int>(at / static_cast<std::size_t>(width));
            for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j)
                for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i) {
                    const auto next =
                        static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(i);
                    if (!clipped[next] || !(steradians[next] > 0)) continue;
                    clipped[next] = 0;
                    region.pixels.push_back(next);
                }
        }
        region.direction = sum.normalized();
        regions.push_back(std::move(region));
    }
    return regions;
}

void absorb(ClippedRegion& into, const ClippedRegion& other) {
    into.direction =
        (into.direction * into.steradians + other.direction * other.steradians).normalized();
    into.steradians += other.steradians;
    into.pixels.insert(into.pixels.end(), other.pixels.begin(), other.pixels.end());
}

/// A diffuse ball blurs what is closer than this; such regions share one unknown.
std::vector<ClippedRegion> told_apart(std::vector<ClippedRegion> regions) {
    constexpr double kCosine = 0.94;  // 20 degrees
    constexpr std::size_t kMost = 6;
    std::ranges::sort(regions, std::greater{}, &ClippedRegion::steradians);
    std::vector<ClippedRegion> kept;
    for (const ClippedRegion& region : regions) {
        const auto nearest = std::ranges::max_element(kept, {}, [&](const ClippedRegion& one) {
            return one.direction.dot(region.direction);
        });
        const bool near =
            nearest != kept.end() && nearest->direction.dot(region.direction) > kCosine;
        if (near || (nearest != kept.end() && kept.size() >= kMost))
            absorb(*nearest, region);
        else
            kept.push_back(region);
    }
    return kept;
}

}  // namespace

std::vector<ClippedRegion> clipped_regions(const BallPicture& mirror, std::vector<char> clipped) {
    return told_apart(connected(mirror, std::move(clipped)));
}

Rays region_rays(const BallPicture& mirror, const ClippedRegion& region) {
    const auto width = static_cast<std::size_t>(mirror.pixels->width());
    const Affine back = mirror.to_pixels.inverse();
    const double area = std::abs(back.determinant());
    Rays rays;
    const float one[] = {1, 1, 1};
    for (const std::size_t at : region.pixels) {
        const V2d position = back(Vec2<double>(static_cast<double>(at % width) + 0.5,
                                               static_cast<double>(at / width) + 0.5));
        if (const auto d = mirror.ball.to_direction(position))
            rays.add(V3d(*d).normalized(), one, mirror.ball.solid_angle(position) * area);
    }
    return rays;
}

}  // namespace chromeball
