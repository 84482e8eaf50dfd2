#include "render/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/directions.h"
#include "support/world.h"

namespace chromeball {
namespace {

using std::numbers::pi;

Environment painted_environment(const char* layout, int size, const World& world) {
    const Layout& shape = *find_layout(layout);
    return {painted_map(shape, size, world), shape};
}

TEST(Environment, ShowsAWorldWhereItIsInEveryLayout) {
    for (const char* layout :
         {"latlong", "openexr", "faces", "strip-h", "cross-v", "angular", "mirror-ball"}) {
        const Environment light = painted_environment(layout, 96, direction_as_color);
        // The rim of a mirror ball has few pixels.
        const bool ball = std::string(layout) == "mirror-ball";
        for (const V3d& d : directions_on_sphere(500)) {
            if (ball && d.z < -0.7) continue;
            const V3f seen = light.radiance(V3f(d));
            const V3d wanted = direction_as_color(d);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(seen[c], wanted[c], ball ? 0.03 : 6e-3)
                    << layout << " " << d.x << " " << d.y << " " << d.z;
        }
        EXPECT_NEAR(light.covered(), 1, 1e-3) << layout;
    }
}

TEST(Environment, IsAveragedOverTheFootprint) {
    // Stripes a degree wide: 90 of them side by side are grey, one alone is not.
    const auto stripes = [](V3d d) {
        const double lon = std::atan2(d.x, d.z) * 180 / pi;
        return V3d(1, 1, 1) * (std::abs(std::fmod(lon + 400, 2.0)) < 1 ? 1.0 : 0.0);
    };
    const Environment light = painted_environment("latlong", 540, stripes);
    const float degree = static_cast<float>(pi / 180);
    const V3f ahead(0, 0, 1), across(1, 0, 0), up(0, 1, 0);
    // A round footprint of two stripes, and of many.
    EXPECT_NEAR(light.radiance(ahead, across * (16 * degree), up * (16 * degree)).x, 0.5, 0.02);
    // A long and narrow one along a stripe stays on it.
    const V3f on = V3f(std::sin(0.5F * degree), 0, std::cos(0.5F * degree));
    const float level = light.radiance(on).x;
    EXPECT_TRUE(level > 0.99F || level < 0.01F);
    EXPECT_NEAR(light.radiance(on, across * (0.25F * degree), up * (4 * degree)).x, level, 0.02);
    EXPECT_NEAR(light.radiance(on, up * (4 * degree), across * (0.25F * degree)).x, level, 0.02)
        << "whichever step is which";
    // Across the stripes it averages them.
    EXPECT_NEAR(light.radiance(on, across * (8 * degree), up * (0.25F * degree)).x, 0.5, 0.08);
    // Steps that are not perpendicular: a diamond whose long side runs along the stripe.
    EXPECT_NEAR(light
                    .radiance(on, up * (3 * degree) + across * (0.12F * degree),
                              up * (3 * degree) - across * (0.12F * degree))
                    .x,
                level, 0.05);
}

TEST(Environment, HasNoSeamsAndNoPoles) {
    for (const char* layout : {"latlong", "openexr"}) {
        const Environment light = painted_environment(layout, 64, smooth_world);
        for (const V3d& d :
             {V3d(0, 0, -1), V3d(1e-5, 0, -1), V3d(-1e-5, 0, -1), V3d(0, 1, 0), V3d(0, -1, 0),
              V3d(1e-4, 1, 1e-4), V3d(1, 1, 0), V3d(-1, 1, 1), V3d(1, -1, -1)}) {
            const V3f r = V3f(d.normalized());
            const V3f side = r.cross(V3f(0.3F, 0.2F, 0.9F)).normalized() * 0.03F;
            const V3f seen = light.radiance(r, side, r.cross(side));
            const V3d wanted = smooth_world(d.normalized());
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(seen[c], wanted[c], 0.01) << layout << d.x << d.y << d.z;
        }
    }
}

TEST(Environment, OfALargePatchIsItsMean) {
    const Environment light = painted_environment("latlong", 64, smooth_world);
    // Nearly everything: the world's mean is 1.
    const V3f all = light.radiance(V3f(0, 0, 1), static_cast<float>(4 * pi));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(all[c], 1, 0.35);
    const V3f grey = painted_environment("openexr", 16, [](V3d) {
                         return V3d(0.5, 2, 7);
                     }).radiance(V3f(0.6F, 0, 0.8F), 3.0F);
    EXPECT_NEAR(grey.x, 0.5, 1e-4);
    EXPECT_NEAR(grey.z, 7, 1e-3);
}

TEST(Environment, LightsMatteSurfacesByTheCosine) {
    // L = 1 + a d.z gives E / pi = 1 + 2/3 a n.z; second-degree terms are weighted by 1/4.
    for (const char* layout : {"latlong", "openexr"}) {
        const Environment light = painted_environment(
            layout, 96, [](V3d d) { return V3d(1 + 0.9 * d.z, 1 + 0.6 * d.y, 1 + d.x * d.y); });
        for (const V3d& n : directions_on_sphere(200)) {
            const V3f matte = light.matte(V3f(n));
            EXPECT_NEAR(matte.x, 1 + 0.6 * n.z, 5e-3);
            EXPECT_NEAR(matte.y, 1 + 0.4 * n.y, 5e-3);
            EXPECT_NEAR(matte.z, 1 + 0.25 * n.x * n.y, 5e-3);
        }
    }
}

TEST(Environment, IsFilledInWhereTheMapShowsNothing) {
    const Layout& latlong = *find_layout("latlong");
    Image map = painted_map(latlong, 64, smooth_world);
    std::size_t emptied = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            const V3d d = *LatLong().to_direction(V2d((x + 0.5) / 128, (y + 0.5) / 64));
            if (d.z > -0.95) continue;
            std::fill_n(map.pixel(x, y), 4, 0.0F);
            ++emptied;
        }
    ASSERT_GT(emptied, 50u);
    const Environment light(map, latlong);
    EXPECT_NEAR(light.covered(), 0.975, 0.002) << "a cap of 2 pi (1 - 0.95) is missing";
    const V3f seen = light.radiance(V3f(0, 0, -1));
    const V3d around = smooth_world(V3d(0, 0, -1));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], around[c], 0.25);
    // What is shown stays as it is.
    const V3d elsewhere = smooth_world(V3d(0.6, 0, 0.8));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(light.radiance(V3f(0.6F, 0, 0.8F))[c], elsewhere[c], 0.01);
}

TEST(Environment, CanBeOfAnySize) {
    for (const int size : {1, 2, 3, 5, 7, 31}) {
        const Environment light =
            painted_environment("latlong", size, [](V3d) { return V3d(1, 2, 3); });
        EXPECT_NEAR(light.radiance(V3f(0.36F, 0.48F, 0.8F), 0.5F).y, 2, 1e-4) << size;
        const Environment cube =
            painted_environment("faces", size, [](V3d) { return V3d(1, 2, 3); });
        EXPECT_NEAR(cube.radiance(V3f(0.36F, 0.48F, 0.8F), 0.5F).y, 2, 1e-4) << size;
    }
}

}  // namespace
}  // namespace chromeball
