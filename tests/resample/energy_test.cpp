// Single bright pixels: where energy leaks first.
#include <gtest/gtest.h>

#include "resample/resample.h"
#include "support/world.h"

namespace chromeball {
namespace {

/// Directions far apart, some of them on seams, poles and corners of cubes.
std::vector<V3d> spots() {
    std::vector<V3d> all;
    const auto add = [&](V3d d) {
        d = d.normalized();
        for (const V3d& other : all)
            if (angle_between(d, other) < radians(34)) return;
        all.push_back(d);
    };
    for (const V3d& d : cube_directions()) add(d);
    for (const V3d& d : directions_on_sphere(200)) add(d);
    return all;
}

std::size_t nearest(const std::vector<V3d>& directions, V3d d) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < directions.size(); ++i)
        if (directions[i].dot(d) > directions[best].dot(d)) best = i;
    return best;
}

/// Per spot, the red light around it.
std::vector<double> light_around(const Image& map, const Layout& layout,
                                 const std::vector<V3d>& directions) {
    std::vector<double> light(directions.size());
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const float* p = map.pixel(x, y);
            if (p[0] == 0) continue;
            const Shown shown = shown_by_pixel(layout, map.size(), x, y, [](V3d d) { return d; });
            light[nearest(directions, shown.color)] += p[0] * shown.solid_angle;
        }
    return light;
}

/// Whether a layout draws a direction out so far that a pixel there is no pixel: the back of the
/// ball, and the edge of an angular map.
bool drawn_out(const Layout& layout, V3d d) {
    if (std::holds_alternative<MirrorBall>(layout.projection)) return d.z < -0.8;
    return std::holds_alternative<Angular>(layout.projection) && d.z > 0.9;
}

/// A lat-long's pixel is the plain mean of its positions: in the row at a pole a light far smaller
/// than the pixel counts too much. Of lights as large as itself, as other maps' pixels are, it does
/// not.
bool at_a_pole(const Layout& from, const Layout& to, V3d d) {
    return std::holds_alternative<MirrorBall>(from.projection) &&
           std::holds_alternative<LatLong>(to.projection) && std::abs(d.y) > 0.99;
}

/// A map with a bright pixel at each spot, everything else black.
Image bright_pixels(const Layout& layout, int size, const std::vector<V3d>& directions) {
    Image map = painted_map(layout, size, [](V3d) { return V3d(0, 0, 0); });
    for (const V3d& d : directions) {
        const V2d p =
            std::visit([&](const auto& m) { return m.to_position(d).value(); }, layout.projection);
        const int x = std::min(static_cast<int>(p.x * map.width()), map.width() - 1),
                  y = std::min(static_cast<int>(p.y * map.height()), map.height() - 1);
        map.pixel(x, y)[0] = 1;
    }
    return map;
}

/// Of a ball so many that its rim, which has taps of its own, is where it draws pixels out.
int size_for(const Layout& layout) {
    if (std::holds_alternative<MirrorBall>(layout.projection)) return 160;
    return layout.directed_area() > 2 ? 24 : 48;
}

TEST(Energy, OfSingleBrightPixelsIsKeptFromEveryMapToEveryOther) {
    const std::vector<V3d> all = spots();
    ASSERT_GT(all.size(), 20U);
    for (const Layout& from : layouts())
        for (const Layout& to : layouts()) {
            std::vector<V3d> used;
            for (const V3d& d : all)
                if (!drawn_out(from, d) && !drawn_out(to, d) && !at_a_pole(from, to, d))
                    used.push_back(d);
            const Image before_map = bright_pixels(from, size_for(from), used);
            const Image after_map = resample(map_source(before_map, from), to, size_for(to));
            const auto before = light_around(before_map, from, used),
                       after = light_around(after_map, to, used);
            double sum_before = 0, sum_after = 0;
            for (std::size_t i = 0; i < used.size(); ++i) {
                sum_before += before[i];
                sum_after += after[i];
                // Taps two thirds of a pixel apart see a tent of height 1 as 8/9 to 10/9, in each
                // of two directions; at a pole the tent reaches over it, which is a quarter more.
                EXPECT_NEAR(after[i] / before[i], 1, 0.3)
                    << from.name << " to " << to.name << " at " << used[i];
            }
            // In the mean of some twenty spots these cancel, to three times 0.11 / sqrt(20).
            EXPECT_NEAR(sum_after / sum_before, 1, 0.075) << from.name << " to " << to.name;
        }
}

/// Five hundred directions all over the sphere, seams, poles and corners included, each a bright
/// pixel of a map.
Image five_hundred_suns(const Layout& layout, int size) {
    std::vector<V3d> directions = directions_on_sphere(474);
    for (const V3d& d : cube_directions()) directions.push_back(d.normalized());
    return bright_pixels(layout, size, directions);
}

TEST(Energy, OfFiveHundredBrightPixelsIsKeptToATenthOfAPercent) {
    for (const char* from_name : {"latlong", "cross-h", "angular"})
        for (const char* to_name : {"latlong", "openexr"}) {
            const Layout &from = *find_layout(from_name), &to = *find_layout(to_name);
            const Image suns = five_hundred_suns(from, from.directed_area() > 2 ? 64 : 128);
            const double before = energy_of(suns, from).light.x;
            const Source source = map_source(suns, from);
            const auto change = [&](int size) {
                const Image map = resample(source, to, to.directed_area() > 2 ? size / 2 : size);
                return energy_of(map, to).light.x / before - 1;
            };
            EXPECT_NEAR(change(200), 0, 1e-3) << from_name << " magnified to " << to_name;
            EXPECT_NEAR(change(50), 0, 1e-3) << from_name << " reduced to " << to_name;
        }
}

}  // namespace
}  // namespace chromeball
