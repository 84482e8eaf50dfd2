// From photos of balls, painted by formula, to maps.
#include <gtest/gtest.h>

#include "resample/resample.h"
#include "support/world.h"

namespace chromeball {
namespace {

/// Balls of about 150 pixels, without the one that fills the unit square.
std::vector<NamedBall> photographed_balls() {
    auto balls = balls_in_photos();
    balls.erase(balls.begin());
    return balls;
}

const Layout& layout_named(std::string_view name) { return *find_layout(name); }

/// A size that has about as many pixels as a ball of 150 pixels shows.
int fine_size(const Layout& layout) { return layout.directed_area() > 2 ? 48 : 96; }

/// Which angle, in radians, a photo's pixel spans where it shows a direction, towards the rim and
/// the rim's last pixel included.
double angle_of_a_pixel(const MirrorBall& ball, V3d d) {
    const auto at = ball.to_position(d);
    if (!at) return std::numbers::pi;
    const V2d middle = ball.to_position(-ball.axis()).value();
    const double away = (*at - middle).length();
    if (away < 1) return 0.02;
    const V2d inwards = middle + (*at - middle) * (1 - 1 / away);
    return angle_between(d, ball.to_direction(inwards).value());
}

/// Every pixel that is wholly shown against the formula.
void expect_directions(const NamedBall& named, const BallPhoto& photo, const Layout& layout) {
    const MirrorBall& ball = named.ball;
    const Image map = resample(photo.source(), layout, fine_size(layout));
    int compared = 0;
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const float* p = map.pixel(x, y);
            const Shown shown = shown_by_pixel(layout, map.size(), x, y, direction_as_color);
            if (!shown.direction || !shown.whole || p[3] < 1) continue;
            ++compared;
            const V3d expected = (shown.color * 2.0 - V3d(1, 1, 1)).normalized();
            const double off = angle_between(color_as_direction(p), expected);
            // A photo's pixel is flat: bends of the mapping inside it are lost, a seventh of it at
            // most where it is small; at the rim, where it spans up to ten degrees and the
            // outermost half pixel cannot be used, all of it and more. A pixel of the map is taken
            // as flat too: 0.2 degrees of its 2 to 4, more where a disk draws it out.
            const double pixel = angle_of_a_pixel(ball, *shown.direction);
            const double flat = layout.directed_area() > 1 ? 0.2 : 1.2;
            const double tolerance = radians(flat) + (pixel < radians(2.5) ? 0.15 : 1.3) * pixel;
            EXPECT_LT(degrees(off), degrees(tolerance))
                << named.name << ", " << layout.name << " at " << x << " " << y << ", towards "
                << degrees(angle_between(*shown.direction, -ball.axis()));
        }
    EXPECT_GT(compared, map.width() * map.height() / 4) << named.name << layout.name;
}

TEST(BallToMap, ShowsEveryDirectionWhereItBelongs) {
    for (const auto& named : photographed_balls()) {
        const BallPhoto photo(named.ball, direction_as_color);
        for (const char* name : {"latlong", "cross-h"})
            expect_directions(named, photo, layout_named(name));
    }
}

TEST(BallToMap, ShowsEveryDirectionWhereItBelongsInEveryLayout) {
    const NamedBall named = photographed_balls()[5];
    const BallPhoto photo(named.ball, direction_as_color);
    for (const Layout& layout : layouts()) expect_directions(named, photo, layout);
}

TEST(BallToMap, ShowsItFromAPhotoWhoseBallIsCutOut) {
    // The affine map from photo to crop takes an ellipse to a circle.
    const NamedBall named = photographed_balls()[5];
    const Affine crop = crop_of(named.ball.outline(), 400);
    const Image pixels = painted(named.ball, {400, 400}, crop.inverse(), direction_as_color);
    const Source source = ball_source(pixels, named.ball, crop);
    EXPECT_NEAR(source.ball->a, 200, 1e-9);
    EXPECT_NEAR(source.ball->b, 200, 1e-9);
    const Image map = resample(source, layout_named("latlong"), 64);
    const Image whole =
        resample(BallPhoto(named.ball, direction_as_color).source(), layout_named("latlong"), 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            const float *one = map.pixel(x, y), *other = whole.pixel(x, y);
            const V3d d = LatLong{}.to_direction(V2d((x + 0.5) / 128, (y + 0.5) / 64)).value();
            if (angle_of_a_pixel(named.ball, d) > radians(3)) continue;
            ASSERT_EQ(one[3], 1.0F);
            // 0.005: a tenth of 3 degrees, in a colour of half a unit a radian
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(one[c], other[c], 0.005) << x << " " << y;
        }
}

TEST(BallToMap, TurnsTheWorldByTheRotation) {
    const Rotation rotation = Rotation::yaw_pitch_roll(40, -20, 75);
    const MirrorBall ball = photographed_balls()[4].ball;
    const Source source = BallPhoto(ball, direction_as_color).source();
    const Layout& layout = layout_named("latlong");
    ResampleOptions options;
    options.rotation = rotation;
    const Image map = resample(source, layout, 64, options);
    for (int y = 4; y < 60; ++y)
        for (int x = 0; x < 128; ++x) {
            const V3d d = LatLong{}.to_direction(V2d((x + 0.5) / 128, (y + 0.5) / 64)).value();
            const V3d in_camera = rotation.inverse() * d;
            if (angle_of_a_pixel(ball, in_camera) > radians(2)) continue;
            // The mean direction over a pixel of 2.8 degrees is that of its middle to 0.1 degrees,
            // near a pole, where it is a slice, to a degree.
            EXPECT_LT(degrees(angle_between(color_as_direction(map.pixel(x, y)), in_camera)), 1);
        }
}

TEST(BallToMap, LeavesTheHiddenConeEmptyAndFillsAllElse) {
    for (const auto& [name, ball] : photographed_balls()) {
        const Source source = BallPhoto(ball, direction_as_color).source();
        for (const char* shape : {"latlong", "mirror-ball"}) {
            const Layout& layout = layout_named(shape);
            const Image map = resample(source, layout, 32);
            for (int y = 0; y < map.height(); ++y)
                for (int x = 0; x < map.width(); ++x) {
                    // A pixel belongs where all its samples are: so ask 4 x 4 of them.
                    const auto hides = [&](V3d d) {
                        const bool h = angle_between(d, ball.axis()) < ball.hidden_half_angle();
                        return h ? V3d(1, 0, 0) : V3d(0, 0, 0);
                    };
                    const Shown shown = shown_by_pixel(layout, map.size(), x, y, hides);
                    const float* p = map.pixel(x, y);
                    if (!shown.whole) continue;
                    if (shown.color.x == 0) {
                        EXPECT_GT(p[3], 0.85) << name << shape << x << " " << y;  // a corner's bit
                    } else if (shown.color.x == 1) {
                        EXPECT_LT(p[3], 0.15) << name << shape << x << " " << y;
                    } else {
                        // 4 x 4 samples of theirs and ours at other places
                        EXPECT_NEAR(p[3], 1 - shown.color.x, 0.3) << name << shape << x << " " << y;
                    }
                    if (p[3] == 0) {
                        EXPECT_EQ(p[0] + p[1] + p[2], 0.0F);
                    }
                }
        }
    }
}

TEST(BallToMap, CountsWhatLiesOutsideTheFrameAsNotShown) {
    // A distant ball shows the same solid angle in every part of its disk: the visible part is
    // that of its area.
    const double radius = 120;
    for (const double cut : {-60.0, 0.0, 30.0, 100.0}) {
        // the frame ends `cut` pixels right of the middle
        const int width = 130 + static_cast<int>(cut);
        const MirrorBall ball(Outline{130, 130, radius, radius, 0});
        const Image pixels = painted(ball, {width, 260}, Affine{}, smooth_world);
        const Source source = ball_source(pixels, ball, Affine{});
        const Layout& layout = layout_named("latlong");
        const Image map = resample(source, layout, 96);
        const Energy energy = energy_of(map, layout);
        const double s = cut / radius, pi = std::numbers::pi;
        const double visible = (pi / 2 + std::asin(s) + s * std::sqrt(1 - s * s)) / pi;
        // 0.002: pixels of 2 degrees are cut in samples
        EXPECT_NEAR(energy.covered / (4 * pi), visible, 0.002) << cut;
        for (int y = 0; y < map.height(); ++y)
            for (int x = 0; x < map.width(); ++x) {
                const auto inside = [&](V3d d) {
                    const V2d p = ball.to_position(d).value_or(V2d(1e9, 0));
                    return V3d(p.x <= width, 0, 0);
                };
                const double part = shown_by_pixel(layout, map.size(), x, y, inside).color.x;
                const float alpha = map.pixel(x, y)[3];
                // One row in five of its own samples may lie between these four.
                if (part == 0) {
                    EXPECT_LT(alpha, 0.25);
                }
                if (part == 1) {
                    EXPECT_GT(alpha, 0.75);
                }
            }
    }
}

TEST(BallToMap, KeepsColourWhereTheFrameCutsTheBall) {
    const MirrorBall ball(Outline{130, 130, 120, 120, 0});
    const Image pixels =
        painted(ball, {160, 260}, Affine{}, [](V3d) { return V3d(0.25, 0.25, 0.25); });
    const Image map = resample(ball_source(pixels, ball, Affine{}), layout_named("latlong"), 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            const float* p = map.pixel(x, y);
            EXPECT_FLOAT_EQ(p[0], 0.25F * p[3]);
        }
}

TEST(BallToMap, NeverPicksUpTheBackground) {
    const World dark = [](V3d d) { return V3d(0.01, 0.02, 0.03) + V3d(0.05, 0.05, 0.05) * d.y; };
    for (const auto& [name, ball] : photographed_balls()) {
        const BallPhoto photo(ball, dark, V3d(1e4, 1e4, 1e4));
        const Source source = photo.source();
        for (const Filter filter : {Filter::adaptive, Filter::fast}) {
            const Image map =
                resample(source, layout_named("latlong"), 48, {.filter = filter, .rotation = {}});
            for (int y = 0; y < map.height(); ++y)
                for (int x = 0; x < map.width(); ++x)
                    for (int c = 0; c < 3; ++c)
                        EXPECT_LE(map.pixel(x, y)[c], 0.0800001F) << name << x << " " << y;
        }
        const Image crop = crop_ball(photo.pixels, ball.outline(), photo.to_pixels(), 100);
        for (int y = 0; y < 100; ++y)
            for (int x = 0; x < 100; ++x)
                for (int c = 0; c < 3; ++c) EXPECT_LE(crop.pixel(x, y)[c], 0.0800001F) << name;
    }
}

TEST(BallToMap, KeepsABlurredBackgroundOutWhenToldOfTheBlur) {
    // What a lens of that blur makes of a black ball before a white wall, to first order at the
    // rim: an error function across it.
    const double radius = 100, sigma = 1.5;
    const MirrorBall ball(Outline{110, 110, radius, radius, 0});
    Image pixels({220, 220}, 3);
    for (int y = 0; y < 220; ++y)
        for (int x = 0; x < 220; ++x) {
            const double out = std::hypot(x + 0.5 - 110, y + 0.5 - 110) - radius;
            const double wall = 0.5 * std::erfc(-out / sigma / std::sqrt(2.0));
            std::fill_n(pixels.pixel(x, y), 3, static_cast<float>(wall));
        }
    const auto leak = [&](double told) {
        const Source source = ball_source(pixels, ball, Affine{}, told);
        const Image map = resample(source, layout_named("latlong"), 64);
        float largest = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 128; ++x) {
                EXPECT_GT(map.pixel(x, y)[3], 0.99F);  // dropped taps cost no coverage
                largest = std::max(largest, map.pixel(x, y)[0]);
            }
        return largest;
    };
    EXPECT_GT(leak(0), 0.2F);
    EXPECT_LT(leak(sigma), 0.023F);  // what lies beyond two standard deviations
}

TEST(BallToMap, KeepsAFlatWorldFlatToTheLastDigit) {
    for (const auto& [name, ball] : photographed_balls()) {
        const BallPhoto photo(
            ball, [](V3d) { return V3d(0.25, 0.5, 1); }, V3d(1e4, 1e4, 1e4));
        for (const char* shape : {"latlong", "mirror-ball"}) {
            const Image map = resample(photo.source(), layout_named(shape), 48);
            for (int y = 0; y < map.height(); ++y)
                for (int x = 0; x < map.width(); ++x) {
                    const float* p = map.pixel(x, y);
                    // 2e-7: one float's rounding in the tap, one in the pixel
                    EXPECT_NEAR(p[0], 0.25F * p[3], 2e-7 * 0.25) << name;
                    EXPECT_NEAR(p[1], 0.5F * p[3], 2e-7 * 0.5) << name;
                    EXPECT_NEAR(p[2], p[3], 2e-7) << name;
                }
        }
    }
}

TEST(BallToMap, LeavesOutPixelsThatTheirAlphaExcludes) {
    // As a pixel that was not a number arrives from decoding: nothing in it, alpha 0.
    const MirrorBall ball(Outline{110, 110, 100, 100, 0});
    Image pixels = painted(ball, {220, 220}, Affine{}, [](V3d) { return V3d(1, 1, 1); });
    for (const V2d& hole : {V2d(110, 110), V2d(60, 80), V2d(150, 40), V2d(205, 110)})
        std::fill_n(pixels.pixel(static_cast<int>(hole.x), static_cast<int>(hole.y)), 4, 0.0F);
    const Source source = ball_source(pixels, ball, Affine{});
    const Image map = resample(source, layout_named("latlong"), 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) EXPECT_NEAR(map.pixel(x, y)[0], map.pixel(x, y)[3], 2e-7);
}

TEST(BallToMap, KeepsTheMeanRadianceWithinATenthOfAPercent) {
    for (const auto& [name, ball] : photographed_balls()) {
        const Source source = BallPhoto(ball, smooth_world, V3d(1e4, 1e4, 1e4)).source();
        for (const char* shape : {"latlong", "faces"}) {
            const Layout& layout = layout_named(shape);
            const Energy energy = energy_of(resample(source, layout, 48), layout);
            V3d seen(0, 0, 0);
            int count = 0;
            for (const V3d& d : directions_on_sphere(20000)) {
                if (!ball.to_position(d)) continue;
                seen += smooth_world(d);
                ++count;
            }
            // A ball so near that its rim shows directions far from straight behind has much in the
            // outermost half pixel, which the background spoils.
            const double tolerance = ball.distance() < 6 ? 3e-3 : 1e-3;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(energy.mean()[c] / (seen[c] / count), 1, tolerance) << name << shape;
        }
    }
}

TEST(BallToMap, FastFilterTakesOneTapOfTheMiddle) {
    const MirrorBall ball(Outline{160, 160, 150, 150, 0});
    const Source source =
        ball_source(painted(ball, {320, 320}, Affine{}, direction_as_color), ball, Affine{});
    const Image map =
        resample(source, layout_named("latlong"), 64, {.filter = Filter::fast, .rotation = {}});
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            const V3d d = LatLong{}.to_direction(V2d((x + 0.5) / 128, (y + 0.5) / 64)).value();
            EXPECT_EQ(map.pixel(x, y)[3], 1.0F);
            if (angle_between(d, {0, 0, -1}) < radians(30)) continue;
            // A tenth of the photo's pixel, which spans up to 3 degrees there
            EXPECT_LT(degrees(angle_between(color_as_direction(map.pixel(x, y)), d)), 0.3);
        }
}

TEST(BallToMap, FastFilterShowsAPixelOrDoesNot) {
    const MirrorBall ball(Outline{160, 160, 150, 150, 0});
    const Image half = painted(ball, {160, 320}, Affine{}, smooth_world);
    const Image map = resample(ball_source(half, ball, Affine{}), layout_named("latlong"), 64,
                               {.filter = Filter::fast, .rotation = {}});
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x)  // the photo's left half shows -X, the map's right half
            EXPECT_EQ(map.pixel(x, y)[3], x < 64 ? 0.0F : 1.0F) << x << " " << y;
}

}  // namespace
}  // namespace chromeball
