#include "resample/resample.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/parallel.h"
#include "resample/keep_light.h"
#include "resample/pass.h"
#include "resample/plan.h"
#include "resample/scalar.h"

namespace chromeball {
namespace {

/// A ball in a part of a photo, as a target: that part is the unit square.
class BallInRegion {
public:
    BallInRegion(const MirrorBall& ball, const Window& region) : ball_(ball), region_(region) {}

    template <class T>
    std::optional<Vec3<T>> to_direction(const Vec2<T>& p) const {
        return ball_.to_direction(Vec2<T>(p.x * T(region_.size.width) + T(region_.x),
                                          p.y * T(region_.size.height) + T(region_.y)));
    }
    bool curved(V3d d) const { return ball_.curved(d); }

private:
    const MirrorBall& ball_;
    Window region_;
};

/// A cubic lookup where all 16 pixels can be used; nothing elsewhere.
std::optional<Rgbw> pure_cubic_tap(ImageView<const float> pixels, V2d p) {
    const int x0 = static_cast<int>(std::floor(p.x - 0.5)) - 1,
              y0 = static_cast<int>(std::floor(p.y - 0.5)) - 1;
    if (x0 < 0 || y0 < 0 || x0 + 4 > pixels.size.width || y0 + 4 > pixels.size.height)
        return std::nullopt;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            if (pixels.pixel(x0 + i, y0 + j)[3] < 1) return std::nullopt;
    return cubic_tap(pixels, p);
}

/// A picture as large as that leaves nothing of itself in caches that are shared with others.
constexpr std::size_t kCacheBytes = std::size_t{32} << 20;

/// Draws into pixels that are 0 wherever the layout shows nothing.
void draw(const Source& source, const Layout& layout, ImageView<float> out,
          const ResampleOptions& options, const Watch& watch) {
    const int size = out.size.width / layout.width_units;
    assert(out.channels == 4 && out.size == layout.picture(size));
    const auto plan = plan_of(source, layout, size, options);
    if (!plan) return scalar::resample(source, layout, out, options, watch);
    const bool large = out.size.pixels() * 16 > kCacheBytes && out.stride % 4 == 0 &&
                       reinterpret_cast<std::uintptr_t>(out.data) % 16 == 0;
    for_each_band(
        static_cast<int>(plan->tiles.size()), 1,
        [&](int first, int last) {
            for (int i = first; i < last; ++i) {
                const PlannedTile& planned = plan->tiles[static_cast<std::size_t>(i)];
                kernel::Tile tile = planned.tile;
                tile.out = out.pixel(planned.cell_x + tile.x0, planned.cell_y + tile.y0);
                tile.stride = out.stride;
                tile.large = large;
                kernel::draw(plan->job, tile);
            }
        },
        watch);
    if (options.filter == Filter::adaptive && options.keeps_light)
        keep_light(source, layout, *plan, out, options.rotation, watch);
}

}  // namespace

Image resample(const Source& source, const Layout& layout, int size, const ResampleOptions& options,
               const Watch& watch) {
    Image out(layout.picture(size), 4);
    draw(source, layout, out.view(), options, watch);
    return out;
}

void resample(const Source& source, const Layout& layout, ImageView<float> out,
              const ResampleOptions& options, const Watch& watch) {
    if (layout.directed_area() < layout.width_units * layout.height_units)
        for (int y = 0; y < out.size.height; ++y)
            std::fill_n(out.row(y), 4 * static_cast<std::ptrdiff_t>(out.size.width), 0.0F);
    draw(source, layout, out, options, watch);
}

Image render_ball(const Source& map, const MirrorBall& ball, const Window& region,
                  const Rotation& rotation, const Watch& watch) {
    Image out(region.size, 4);
    const BallInRegion target(ball, region);
    std::visit(
        [&]<class P>(const P&) {
            const Lookup<P> lookup(map);
            const Pass<BallInRegion, P> pass(target, out.size(), rotation, lookup);
            for_each_pixel(out.view(), watch, [&](int x, int y) { return pass.adaptive(x, y); });
        },
        map.projection);
    return out;
}

int natural_size(const Source& source, const Layout& layout) {
    const double wanted =
        std::sqrt(4 * std::numbers::pi / (layout.directed_area() * source.mean_solid_angle));
    const double power = std::clamp(std::round(std::log2(wanted)), 6.0, 12.0);
    return 1 << static_cast<int>(power);
}

Image crop_ball(const Image& pixels, const Outline& outline, const Affine& to_pixels, int size,
                const Watch& watch) {
    const Source source = ball_source(pixels, MirrorBall(outline), to_pixels);
    const Lookup<MirrorBall> lookup(source);
    const Affine to_photo = crop_of(outline, size).inverse();
    Image out({size, size}, 4);
    for_each_pixel(out.view(), watch, [&](int x, int y) {
        // Alpha is the part of the pixel inside the circle; colour is the ball's throughout.
        constexpr int kGrid = 4;
        int inside = 0;
        for (int k = 0; k < kGrid * kGrid; ++k) {
            const double dx = x + (k % kGrid + 0.5) / kGrid - 0.5 * size;
            const double dy = y + (k / kGrid + 0.5) / kGrid - 0.5 * size;
            inside += dx * dx + dy * dy <= 0.25 * size * size;
        }
        Sum sum;
        sum.total = 1;
        if (inside == 0) return sum;
        const V2d at = source.to_pixels(to_photo(V2d(x + 0.5, y + 0.5)));
        auto tap = pure_cubic_tap(source.pixels.view(), at);
        if (!tap) tap = lookup.tap(at);
        sum.total = 0;
        sum.add(1, tap);
        const double part = static_cast<double>(inside) / (kGrid * kGrid);
        return Sum{sum.r * part, sum.g * part, sum.b * part, sum.alpha * part, 1};
    });
    return out;
}

}  // namespace chromeball
