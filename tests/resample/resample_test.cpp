// From map to map, and what holds for all of them.
#include "resample/resample.h"

#include <gtest/gtest.h>

#include <cstring>

#include "core/parallel.h"
#include "support/world.h"

namespace chromeball {
namespace {

const Layout& layout_named(std::string_view name) { return *find_layout(name); }

/// Disks finer, since they have fewest pixels where they draw them out most.
int size_for(const Layout& layout) {
    return layout.directed_area() > 2 ? 40 : layout.directed_area() > 1 ? 64 : 128;
}

/// The largest difference of colour between a map and the formula, over wholly shown pixels; of
/// directions that a ball in between would draw out only up to 150 degrees.
double largest_error(const Image& map, const Layout& layout, const World& world,
                     double up_to_degrees = 180) {
    double largest = 0;
    int compared = 0;
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const Shown shown = shown_by_pixel(layout, map.size(), x, y, world);
            if (!shown.direction || !shown.whole) continue;
            if (angle_between(*shown.direction, {0, 0, 1}) > radians(up_to_degrees)) continue;
            ++compared;
            const float* p = map.pixel(x, y);
            EXPECT_GT(p[3], 0.85F) << layout.name << x << " " << y;  // 8/9: a disk's edge
            largest = std::max(largest, (V3d(p[0], p[1], p[2]) / p[3] - shown.color).length());
        }
    EXPECT_GT(compared, 500) << layout.name;
    return largest;
}

bool is_disk(const Layout& layout) { return layout.directed_area() < 1; }

TEST(MapToMap, AgreesWithTheFormulaFromEveryLayoutToEveryOther) {
    // Seams and corners too: a pixel from a neighbour that does not join is off by 0.3 and more.
    for (const Layout& from : layouts()) {
        const Source source = map_source(painted_map(from, size_for(from), smooth_world), from);
        const bool ball = std::holds_alternative<MirrorBall>(from.projection);
        for (const Layout& to : layouts()) {
            const Image map = resample(source, to, size_for(to));
            const double error = largest_error(map, to, smooth_world, ball ? 150 : 180);
            // Pixels of 2.5 degrees (0.04), averaged and interpolated, of a world that bends by 1.5
            // a radian squared: 0.04^2 x 1.5 twice is 0.005; in a disk they are drawn out to
            // several times that at its edge.
            EXPECT_LT(error, is_disk(from) || is_disk(to) ? 0.05 : 0.006)
                << from.name << " to " << to.name;
        }
    }
}

TEST(MapToMap, FastFilterAgreesToo) {
    for (const char* from_name : {"latlong", "cross-v", "strip-h"}) {
        const Layout& from = layout_named(from_name);
        const Source source = map_source(painted_map(from, 64, smooth_world), from);
        for (const char* to_name : {"latlong", "cross-v"}) {
            const Layout& to = layout_named(to_name);
            const Image map = resample(source, to, 40, {.filter = Filter::fast, .rotation = {}});
            EXPECT_LT(largest_error(map, to, smooth_world), 0.02) << from_name << to_name;
        }
    }
}

TEST(MapToMap, CopiesPixelForPixelWhereNothingChanges) {
    for (const Layout& layout : layouts()) {
        if (is_disk(layout)) continue;
        const Image map = painted_map(layout, 32, smooth_world);
        const Image copy =
            resample(map_source(map, layout), layout, 32, {.filter = Filter::fast, .rotation = {}});
        for (int y = 0; y < map.height(); ++y)
            for (int x = 0; x < map.width(); ++x) {
                if (copy.pixel(x, y)[3] == 0) continue;
                for (int c = 0; c < 3; ++c)  // 1e-5: rounding of directions
                    ASSERT_NEAR(copy.pixel(x, y)[c], map.pixel(x, y)[c], 1e-5) << layout.name;
            }
    }
}

TEST(MapToMap, TurnsByTheRotation) {
    const Layout& layout = layout_named("cross-h");
    const Source source = map_source(painted_map(layout, 64, smooth_world), layout);
    ResampleOptions options;
    options.rotation = Rotation::yaw_pitch_roll(20, 50, -110);
    const World turned = [&](V3d d) { return smooth_world(options.rotation.inverse() * d); };
    const Image map = resample(source, layout_named("latlong"), 64, options);
    EXPECT_LT(largest_error(map, layout_named("latlong"), turned), 0.006);  // as above
}

TEST(MapToMap, LeavesEmptyCellsAndCornersTransparentBlack) {
    const Layout& from = layout_named("latlong");
    const Source source = map_source(painted_map(from, 64, [](V3d) { return V3d(1, 2, 3); }), from);
    for (const Layout& to : layouts()) {
        const Image map = resample(source, to, 32);
        int empty = 0;
        for (int y = 0; y < map.height(); ++y)
            for (int x = 0; x < map.width(); ++x) {
                const Shown shown = shown_by_pixel(to, map.size(), x, y, smooth_world);
                const float* p = map.pixel(x, y);
                if (shown.solid_angle == 0) {
                    ++empty;
                    EXPECT_EQ(p[0] + p[1] + p[2] + p[3], 0.0F) << to.name << x << " " << y;
                } else if (shown.whole) {
                    EXPECT_GE(p[3], 0.9F) << to.name << x << " " << y;
                }
            }
        const double expected =
            static_cast<double>(map.size().pixels()) - to.directed_area() * 32 * 32;
        // Pixels cut by a disk's edge, some four a pixel of its radius, are not empty.
        EXPECT_NEAR(empty, expected, is_disk(to) ? 100 : 0) << to.name;
    }
}

TEST(MapToMap, KeepsFlatMapsFlatAndMeansWithinATenthOfAPercent) {
    for (const Layout& from : layouts()) {
        const int size = 2 * size_for(from);
        const Source flat =
            map_source(painted_map(from, size, [](V3d) { return V3d(0.3, 0.3, 0.3); }), from);
        const Source smooth = map_source(painted_map(from, size, smooth_world), from);
        const bool ball = std::holds_alternative<MirrorBall>(from.projection);
        for (const char* to_name : {"latlong", "faces"}) {
            const Layout& to = layout_named(to_name);
            const Image map = resample(flat, to, 32);
            for (int y = 0; y < map.height(); ++y)
                for (int x = 0; x < map.width(); ++x) {
                    const float* p = map.pixel(x, y);  // 1e-6: a few roundings of floats
                    EXPECT_NEAR(p[0], 0.3F * p[3], 1e-6) << from.name;
                }
            const V3d mean = energy_of(resample(smooth, to, 32), to).mean();
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(mean[c], 1, ball ? 1.5e-3 : 1e-3) << from.name << to.name << c;
        }
    }
}

TEST(MapToMap, HasNoJumpsAtSeams) {
    // Steps between neighbours of a lat-long, also round its ends and over its poles, are those of
    // the world: checked by the second difference along each row, far finer than the source.
    for (const Layout& from : layouts()) {
        if (is_disk(from)) continue;
        const Source source = map_source(painted_map(from, 32, smooth_world), from);
        const Image map =
            resample(source, layout_named("latlong"), 96, {.filter = Filter::fast, .rotation = {}});
        for (int y = 0; y < 96; ++y)
            for (int x = 0; x < 192; ++x) {
                const float *left = map.pixel(x, y), *right = map.pixel((x + 1) % 192, y);
                // 0.033 radians of a world that rises by at most 1.2 a radian, and bilinear steps
                // up to twice as steep near a corner of the source's 3 degree pixels
                EXPECT_LT(std::abs(left[0] - right[0]), 0.05) << from.name << x << " " << y;
                EXPECT_LT(std::abs(left[2] - right[2]), 0.05) << from.name << x << " " << y;
            }
    }
}

TEST(RoundTrip, FromBallOverLatLongAndCubeToLatLong) {
    const MirrorBall ball(camera_for(8, 200, {320, 240}), cone_at(8, 10, 30));
    const BallPhoto photo(ball, smooth_world);
    const Layout &latlong = layout_named("latlong"), &cross = layout_named("cross-h");
    const Image first = resample(photo.source(), latlong, 128);
    const Image second = resample(map_source(first, latlong), cross, 64);
    const Image third = resample(map_source(second, cross), latlong, 128);
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            const Shown shown = shown_by_pixel(latlong, third.size(), x, y, smooth_world);
            const double away = angle_between(*shown.direction, ball.axis());
            const float* p = third.pixel(x, y);
            if (away > ball.hidden_half_angle() + radians(6)) {
                EXPECT_NEAR(p[3], 1, 1e-4) << x << " " << y;  // more than any filter's reach
            }
            if (away < ball.hidden_half_angle() - radians(6)) {
                EXPECT_EQ(p[3], 0) << x << y;
            }
            if (away < radians(30)) continue;
            const double error = (V3d(p[0], p[1], p[2]) - shown.color).length();
            EXPECT_LT(error, 0.004) << x << " " << y;  // three times pixels of 1.4 degrees
        }
}

TEST(RoundTrip, FromMapToBallAndBack) {
    const Layout &latlong = layout_named("latlong"), &ball = layout_named("mirror-ball");
    const Source source = map_source(painted_map(latlong, 128, smooth_world), latlong);
    const Image back = resample(map_source(resample(source, ball, 256), ball), latlong, 64);
    EXPECT_LT(largest_error(back, latlong, smooth_world, 150), 0.01);  // pixels of 3 degrees there
}

TEST(RoundTrip, ThereAndBackByARotation) {
    const Layout& latlong = layout_named("latlong");
    const Rotation rotation = Rotation::yaw_pitch_roll(33, -75, 10);
    const Image there = resample(map_source(painted_map(latlong, 64, smooth_world), latlong),
                                 latlong, 64, {.filter = Filter::adaptive, .rotation = rotation});
    const Image back = resample(map_source(there, latlong), latlong, 64,
                                {.filter = Filter::adaptive, .rotation = rotation.inverse()});
    EXPECT_LT(largest_error(back, latlong, smooth_world), 0.01);  // twice that of one way
}

bool same_bytes(const Image& a, const Image& b) {
    return a.size() == b.size() &&
           std::memcmp(a.row(0), b.row(0), a.size().pixels() * 4 * sizeof(float)) == 0;
}

TEST(Resample, GivesTheSameBytesForAnyNumberOfThreads) {
    const MirrorBall ball(camera_for(5, 80, {160, 120}), cone_at(5, 10, 30));
    const BallPhoto photo(ball, smooth_world);
    const Layout& layout = layout_named("cross-h");
    const auto convert = [&](int threads) {
        const ThreadLimit limit(threads);
        return resample(photo.source(), layout, 50);
    };
    const Image one = convert(1);
    EXPECT_TRUE(same_bytes(one, convert(2)));
    EXPECT_TRUE(same_bytes(one, convert(0)));
}

TEST(Resample, StopsWhenAsked) {
    const Layout& layout = layout_named("latlong");
    const Source source = map_source(painted_map(layout, 16, smooth_world), layout);
    const std::atomic<bool> stop = true;
    const auto kind = [&](const auto& work) {
        try {
            work();
        } catch (const Error& e) {
            return e.kind();
        }
        return Error::Kind::failed;
    };
    EXPECT_EQ(kind([&] { resample(source, layout, 64, {}, {.stop = &stop}); }),
              Error::Kind::interrupted);
    const Image photo({64, 64}, 3);
    EXPECT_EQ(kind([&] {
                  crop_ball(photo, {32, 32, 20, 20, 0}, Affine{}, 40, {.stop = &stop});
              }),
              Error::Kind::interrupted);
}

TEST(Resample, TellsProgressUpToOne) {
    const Layout& layout = layout_named("latlong");
    const Source source = map_source(painted_map(layout, 16, smooth_world), layout);
    double last = 0;
    Watch watch;
    watch.progress = [&](double part) {
        EXPECT_GT(part, last);
        last = part;
    };
    resample(source, layout, 64, {}, watch);
    EXPECT_DOUBLE_EQ(last, 1);
}

TEST(NaturalSize, IsThePowerOfTwoWhosePixelsShowAsMuchAsTheSources) {
    const Layout &latlong = layout_named("latlong"), &faces = layout_named("faces");
    const auto map_of = [](const Layout& layout, int size) {
        return map_source(Image(layout.picture(size), 3), layout);
    };
    EXPECT_EQ(natural_size(map_of(latlong, 512), latlong), 512);
    EXPECT_EQ(natural_size(map_of(latlong, 512), faces), 256);  // 296 by area
    EXPECT_EQ(natural_size(map_of(faces, 128), latlong), 256);  // 222
    EXPECT_EQ(natural_size(map_of(faces, 128), layout_named("cross-v")), 128);
    EXPECT_EQ(natural_size(map_of(latlong, 100), layout_named("mirror-ball")), 128);  // 160
    // A distant ball has its area's pixels: pi 200^2 = 2 x 251^2.
    const MirrorBall ball(Outline{210, 210, 200, 200, 0});
    const Image photo({420, 420}, 3);
    EXPECT_EQ(natural_size(ball_source(photo, ball, Affine{}), latlong), 256);
    EXPECT_NEAR(ball_source(photo, ball, Affine{}).mean_solid_angle, 4.0 / (200 * 200), 1e-12);
    // A near one shows less, in the same pixels.
    const MirrorBall near(camera_for(1.1, 200, {210, 210}), cone_at(1.1));
    const double shown = 2 * std::numbers::pi * (1 + std::cos(std::asin(1 / 1.1)));
    EXPECT_NEAR(ball_source(photo, near, Affine{}).mean_solid_angle,
                shown / (std::numbers::pi * 200 * 200), 1e-12);
}

TEST(NaturalSize, StaysBetween64And4096) {
    Source source;
    source.projection = LatLong{};
    source.mean_solid_angle = 1;
    EXPECT_EQ(natural_size(source, layout_named("latlong")), 64);
    source.mean_solid_angle = 1e-12;
    EXPECT_EQ(natural_size(source, layout_named("latlong")), 4096);
}

TEST(CropBall, TouchesTheFourEdgesAndIsClearOutside) {
    for (const auto& [name, ball] : balls_in_photos()) {
        if (ball.outline().a < 1) continue;
        const BallPhoto photo(
            ball, [](V3d) { return V3d(0.5, 0.5, 0.5); }, V3d(9, 9, 9));
        const Image crop = crop_ball(photo.pixels, ball.outline(), photo.to_pixels(), 64);
        ASSERT_EQ(crop.size(), (Size{64, 64}));
        for (int i = 31; i <= 32; ++i)
            for (const float* p :
                 {crop.pixel(i, 0), crop.pixel(i, 63), crop.pixel(0, i), crop.pixel(63, i)})
                EXPECT_GT(p[3], 0.9F) << name;
        double inside = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const float* p = crop.pixel(x, y);
                inside += p[3];
                EXPECT_NEAR(p[0], 0.5F * p[3], 1e-6) << name;  // the ball's colour throughout
                const double r = std::hypot(x + 0.5 - 32, y + 0.5 - 32);
                if (r > 33) {
                    EXPECT_EQ(p[3], 0.0F) << name << x << " " << y;
                }
                if (r < 31) {
                    EXPECT_EQ(p[3], 1.0F) << name << x << " " << y;
                }
            }
        EXPECT_NEAR(inside, std::numbers::pi * 32 * 32, 5) << name;  // 4 x 4 samples a pixel
    }
}

TEST(CropBall, ShowsTheBallUprightAndCentred) {
    for (const auto& [name, ball] : balls_in_photos()) {
        if (ball.outline().a < 1) continue;
        const BallPhoto photo(ball, direction_as_color);
        const Image crop = crop_ball(photo.pixels, ball.outline(), photo.to_pixels(), 256);
        const Affine to_photo = crop_of(ball.outline(), 256).inverse();
        for (int y = 0; y < 256; y += 5)
            for (int x = 0; x < 256; x += 5) {
                if (std::hypot(x + 0.5 - 128, y + 0.5 - 128) > 115) continue;
                const V3d d = ball.to_direction(to_photo(V2d(x + 0.5, y + 0.5))).value();
                // A seventh of the photo's pixel, which spans at most 2.5 degrees there
                EXPECT_LT(degrees(angle_between(color_as_direction(crop.pixel(x, y)), d)), 0.35)
                    << name << x << " " << y;
            }
    }
}

TEST(CropBall, IsClearWhereThePhotoEnds) {
    const Image photo =
        painted(MirrorBall(Outline{60, 110, 100, 100, 0}), {220, 220}, Affine{}, smooth_world);
    const Image crop = crop_ball(photo, {60, 110, 100, 100, 0}, Affine{}, 100);
    EXPECT_EQ(crop.pixel(15, 50)[3], 0.0F);  // 29.5 pixels left of the photo's edge
    EXPECT_EQ(crop.pixel(25, 50)[3], 1.0F);
}

}  // namespace
}  // namespace chromeball
