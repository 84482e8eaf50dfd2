#include "light/blend.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/parallel.h"
#include "light/view_cube.h"
#include "support/views.h"

namespace chromeball {
namespace {

const test::Place kPlace(21);
const Rotation kSide = Rotation::about_y(90);

/// A ball 20 radii away, 220 pixels across.
MirrorBall near_ball() {
    Camera camera;
    camera.focal = 110 * std::sqrt(20.0 * 20 - 1);
    camera.principal = V2d(120, 120);
    return MirrorBall(camera, cone_of({120, 120, 110, 110, 0}, camera));
}

PlacedView view(const Rotation& to_world, bool person, V3d tint = V3d(1, 1, 1)) {
    const MirrorBall ball = near_ball();
    const Image photo = test::ball_view({240, 240}, ball, to_world, [&](V3d world, V3d in_view) {
        const V3d light = kPlace(world);
        return (person ? test::with_photographer(light, in_view) : light) * tint;
    });
    return {{ball_source(photo, ball, {}), std::nullopt}, to_world, -ball.axis()};
}

/// How far a map is from the place: the part of the sphere that is off by more than a tenth of a
/// stop.
double part_off(const Image& map, const Layout& layout, const Rotation& to_output = {}) {
    double off = 0, all = 0;
    std::visit(
        [&](const auto& projection) {
            for (int y = 0; y < map.height(); ++y)
                for (int x = 0; x < map.width(); ++x) {
                    const V2d p((x + 0.5) / map.width(), (y + 0.5) / map.height());
                    const auto d = projection.to_direction(p);
                    if (!d) continue;
                    const double area = projection.solid_angle(p);
                    all += area;
                    const V3d truth = kPlace(to_output.inverse() * *d);
                    const float* is = map.pixel(x, y);
                    for (int c = 0; c < 3; ++c)
                        if (!(std::abs(std::log2(static_cast<double>(is[c]) / truth[c])) < 0.1)) {
                            off += area;
                            break;
                        }
                }
        },
        layout.projection);
    return off / all;
}

const Layout& latlong() { return *find_layout("latlong"); }

TEST(Blend, ShowsThePlaceWithoutPhotographers) {
    const std::vector views{view({}, true), view(kSide, true)};
    const Blended blended = blend(views, latlong(), 128);
    EXPECT_LT(part_off(blended.map, latlong()), 0.002);
    EXPECT_GT(blended.covered, 0.9999);
    // The persons are there to be removed.
    const Blended alone = blend({view({}, true)}, latlong(), 128);
    EXPECT_GT(part_off(alone.map, latlong()), 0.01);
}

TEST(Blend, FitsAnyLayoutAndOrientation) {
    const std::vector views{view({}, true), view(kSide, true)};
    BlendOptions options;
    options.to_output = Rotation::yaw_pitch_roll(40, 30, 20);
    for (const char* name : {"openexr", "cross-h"}) {
        const Layout& layout = *find_layout(name);
        const Blended blended = blend(views, layout, 64, options);
        EXPECT_LT(part_off(blended.map, layout, options.to_output), 0.002) << name;
    }
}

TEST(Blend, MatchesExposureAndTintToTheFirstView) {
    const V3d tint(0.5, 0.6, 0.45);
    const Blended blended = blend({view({}, true), view(kSide, true, tint)}, latlong(), 128);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(blended.gains[0][c], 1);
        EXPECT_NEAR(blended.gains[1][c] * tint[static_cast<int>(c)], 1, 0.005);
    }
    EXPECT_LT(part_off(blended.map, latlong()), 0.002);
}

TEST(Blend, LeavesNoSeamWhereOneViewIsBrighterToOneSide) {
    // As vignetting, or a mirror that reflects less when seen from the side.
    const MirrorBall ball = near_ball();
    const auto dimmed = [&](const Rotation& to_world) {
        const Image photo = test::ball_view({240, 240}, ball, to_world, [](V3d, V3d in_view) {
            const double light = 0.85 + 0.15 * in_view.z;
            return V3d(light, light, light);
        });
        return PlacedView{{ball_source(photo, ball, {}), std::nullopt}, to_world, -ball.axis()};
    };
    const Image map = blend({dimmed({}), dimmed(kSide)}, latlong(), 128).map;
    // Where they meet one is brighter than the other by up to a tenth over some degrees.
    double steepest = 0;
    for (int y = 16; y < 112; ++y)
        for (int x = 0; x < 256; ++x) {
            const double a = static_cast<double>(map.pixel(x, y)[0]);
            const double b = static_cast<double>(map.pixel((x + 1) % 256, y)[0]);
            steepest = std::max(steepest, std::abs(a - b) / b);
        }
    EXPECT_LT(steepest, 0.01);  // in 1.4 degrees; the views themselves change by 0.4 % there
}

TEST(Blend, KeepsTheEnergy) {
    const Blended blended = blend({view({}, true), view(kSide, true)}, latlong(), 128);
    V3d sum(0, 0, 0), truth(0, 0, 0);
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            const V2d p((x + 0.5) / 256, (y + 0.5) / 128);
            const double area = LatLong().solid_angle(p);
            const float* is = blended.map.pixel(x, y);
            sum += V3d(is[0], is[1], is[2]) * area;
            truth += kPlace(*LatLong().to_direction(p)) * area;
        }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / truth[c], 1, 0.003);
}

TEST(Blend, OfOppositeViewsHarmsNothingButThePhotographersThemselves) {
    // What is behind them is drawn out at the other's rim; what is beside them their own shows.
    const Rotation opposite = Rotation::about_y(180);
    const Image map = blend({view({}, true), view(opposite, true)}, latlong(), 128).map;
    const auto person = [](V3d d, double margin) {
        const double right = std::atan2(d.x, d.z), up = std::asin(d.y);
        return std::abs(right) < 0.1 + margin && up < 0.17 + margin && up > -0.52 - margin;
    };
    double beside = 0, all = 0, dark = 0, persons = 0;
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            const V2d p((x + 0.5) / 256, (y + 0.5) / 128);
            const V3d d = *LatLong().to_direction(p), back = opposite.inverse() * d;
            const double area = LatLong().solid_angle(p), truth = kPlace(d).y;
            const double stops = std::log2(static_cast<double>(map.pixel(x, y)[1]) / truth);
            if (person(d, 0) || person(back, 0)) {
                persons += area;
                if (stops < -2) dark += area;
            } else if (!person(d, 0.06) && !person(back, 0.06)) {
                all += area;
                if (std::abs(stops) > 0.1) beside += area;
            }
        }
    EXPECT_LT(beside / all, 0.001);
    EXPECT_LT(dark / persons, 0.02);  // they are three stops darker than anything
}

TEST(Blend, FillsWhatNoViewSawAndMarksIt) {
    const PlacedView one = view({}, false);
    const Blended filled = blend({one}, latlong(), 128);
    BlendOptions options;
    options.fill = false;
    const Blended empty = blend({one}, latlong(), 128, options);
    // Straight behind the ball, in the hidden cone of 2.9 degrees, and well beside it.
    const float *hole = filled.map.pixel(0, 64), *seen = filled.map.pixel(10, 64);
    EXPECT_EQ(hole[3], 0);
    EXPECT_EQ(seen[3], 1);
    for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(empty.map.pixel(0, 64)[c], 0);
        EXPECT_NEAR(hole[c] / seen[c], 1, 0.7);  // as bright as around, roughly
    }
    EXPECT_EQ(empty.map.pixel(0, 64)[3], 0);
    EXPECT_EQ(empty.map.pixel(10, 64)[3], 1);
    // sin^2(half angle / 2) of the sphere, D = 20.
    EXPECT_NEAR(filled.covered, 1 - 0.000626, 5e-5);
    EXPECT_NEAR(empty.covered, filled.covered, 1e-9);
}

TEST(Blend, OfOneUnfilledViewIsThatViewConverted) {
    const PlacedView one = view(kSide, false);
    BlendOptions options;
    options.fill = false;
    const Image blended = blend({one}, latlong(), 64, options).map;
    ResampleOptions how;
    how.rotation = kSide;
    const Image converted = resample(one.view.source, latlong(), 64, how);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x)
            for (int c = 0; c < 4; ++c)
                ASSERT_NEAR(blended.pixel(x, y)[c], converted.pixel(x, y)[c],
                            1e-4 * (1 + converted.pixel(x, y)[c]))
                    << x << " " << y;
}

TEST(Blend, TellsItsConfidence) {
    BlendOptions options;
    options.confidence = true;
    const Blended both = blend({view({}, false), view(kSide, false)}, latlong(), 64, options);
    ASSERT_EQ(both.confidence.size(), both.map.size());
    ASSERT_EQ(both.confidence.channels(), 1);
    const auto at = [&](V3d d) {
        const V2d p = *LatLong().to_position(d);
        return both.confidence.pixel(static_cast<int>(p.x * 128), static_cast<int>(p.y * 64))[0];
    };
    EXPECT_GT(at(V3d(0, 0.01, 1)), 0.98);  // towards either camera
    EXPECT_GT(at(V3d(1, 0.01, 0)), 0.98);
    // As far as can be from both: 135 degrees, cos(67.5 degrees).
    EXPECT_NEAR(at(V3d(-1, 0.01, -1)), 0.383, 0.03);
}

TEST(Blend, IsTheSameForAnyNumberOfThreads) {
    const std::vector views{view({}, true), view(kSide, true)};
    std::vector<Image> maps;
    for (const int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        maps.push_back(blend(views, latlong(), 64).map);
    }
    EXPECT_TRUE(std::equal(maps[0].row(0), maps[0].row(0) + 4 * 128 * 64, maps[1].row(0)));
}

}  // namespace
}  // namespace chromeball
