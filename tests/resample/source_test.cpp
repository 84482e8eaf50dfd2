#include "resample/source.h"

#include <gtest/gtest.h>

#include "resample/tap.h"
#include "support/world.h"

namespace chromeball {
namespace {

TEST(NeededWindow, IsTheOutlinesBoxWithAMargin) {
    const Window photo{0, 0, {1000, 800}};
    EXPECT_EQ(needed_window({500.5, 400.25, 100, 100, 0}, photo), (Window{398, 298, {205, 205}}));
    const Window upright = needed_window({500, 400, 100, 50, 90}, photo);
    EXPECT_LE(upright.size.width, 106);
    EXPECT_GE(upright.size.height, 204);
    for (const double angle : {0.0, 30.0, 77.0, 145.0}) {
        const Outline outline{500, 400, 100, 50, angle};
        const Window window = needed_window(outline, photo);
        for (int i = 0; i < 100; ++i) {
            const V2d p = rim_point(outline, i * 0.063);
            EXPECT_GE(p.x, window.x + 1.5);  // room for a bilinear tap on the rim
            EXPECT_GE(p.y, window.y + 1.5);
            EXPECT_LE(p.x, window.x + window.size.width - 1.5);
            EXPECT_LE(p.y, window.y + window.size.height - 1.5);
        }
    }
}

TEST(NeededWindow, IsCutToWhatThereIs) {
    const Window data{100, 50, {300, 200}};
    EXPECT_EQ(needed_window({100, 50, 40, 40, 0}, data), (Window{100, 50, {42, 42}}));
    EXPECT_EQ(needed_window({400, 250, 40, 40, 0}, data), (Window{358, 208, {42, 42}}));
    EXPECT_EQ(needed_window({250, 150, 1000, 1000, 0}, data), data);
    EXPECT_EQ(needed_window({-500, 150, 40, 40, 0}, data).size.pixels(), 0U);
    EXPECT_EQ(needed_window({1e12, -1e12, 40, 40, 0}, data).size.pixels(), 0U);
}

TEST(BallSource, DropsEveryPixelThatIsNotPurelyBall) {
    const Outline outline{52.3, 49.1, 40, 30, 25};
    const Image photo({110, 100}, 3);
    const Source source = ball_source(photo, MirrorBall(outline), Affine{});
    const double turn = radians(outline.angle);
    int kept = 0;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 110; ++x) {
            bool pure = true;
            for (const double i : {0.0, 1.0})
                for (const double j : {0.0, 1.0}) {
                    const V2d p(x + i - outline.cx, y + j - outline.cy);
                    const double u = (p.x * std::cos(turn) + p.y * std::sin(turn)) / outline.a,
                                 v = (p.y * std::cos(turn) - p.x * std::sin(turn)) / outline.b;
                    // 0.001: the distance from the rim is of first order, a hundredth of a pixel
                    pure = pure && u * u + v * v <= 1.001;
                }
            const float weight = source.pixels.pixel(x + 1, y + 1)[3];
            EXPECT_TRUE(weight == 0 || pure) << x << " " << y;
            kept += weight > 0;
        }
    // All but a rim of about a pixel's width: four sides of the box around it, in number.
    EXPECT_GT(kept, area(outline) - 4 * (outline.a + outline.b) * 1.1);
}

TEST(BallSource, IsTheSameMadeOfBandsInAnyOrder) {
    // Inside the photo, cut by its edges, and with bands of which some have alpha.
    for (const V2d& centre : {V2d(60, 50), V2d(5, 4), V2d(115, 98)}) {
        const MirrorBall ball(Outline{centre.x, centre.y, 40, 33, 25});
        Image rgb({120, 100}, 3), rgba({120, 100}, 4);
        for (int y = 0; y < 100; ++y)
            for (int x = 0; x < 120; ++x) {
                const float values[] = {static_cast<float>(x), static_cast<float>(y), 1, 1};
                std::copy_n(values, 3, rgb.pixel(x, y));
                std::copy_n(values, 4, rgba.pixel(x, y));
            }
        const Source whole = ball_source(rgb, ball, Affine{}, 0.7);
        BallSourceMaker maker(rgb.size(), ball, Affine{}, 0.7);
        for (const auto& [first, last] : {std::pair{37, 100}, {0, 1}, {1, 30}, {30, 37}}) {
            const ImageView<const float> all = first == 1 ? rgba.view() : rgb.view();
            maker.add(first, {all.row(first), {120, last - first}, all.channels, all.stride});
        }
        const Source banded = maker.finish();
        ASSERT_EQ(banded.pixels.size(), whole.pixels.size());
        EXPECT_TRUE(std::equal(whole.pixels.row(0),
                               whole.pixels.row(0) + whole.pixels.size().pixels() * 4,
                               banded.pixels.row(0)));
        EXPECT_EQ(banded.ball, whole.ball);
        EXPECT_EQ(banded.right, whole.right);
        EXPECT_EQ(banded.mean_solid_angle, whole.mean_solid_angle);
        const Image &strip = whole.rim.pixels(), &made = banded.rim.pixels();
        ASSERT_EQ(made.size(), strip.size());
        EXPECT_TRUE(
            std::equal(strip.row(0), strip.row(0) + strip.size().pixels() * 4, made.row(0)));
    }
}

TEST(BallSource, TakesThePhotosOwnAlpha) {
    Image photo({40, 40}, 4);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) photo.pixel(x, y)[3] = x == 20 && y == 20 ? 0.0F : 1.0F;
    const Source source = ball_source(photo, MirrorBall(Outline{20, 20, 15, 15, 0}), Affine{});
    EXPECT_EQ(source.pixels.pixel(21, 21)[3], 0.0F);
    EXPECT_EQ(source.pixels.pixel(22, 21)[3], 1.0F);
}

/// Prepared pixels, borders too, against the world that lies there.
TEST(MapSource, HasABorderThatHoldsWhatLiesBeyondTheSeam) {
    const int n = 32;
    for (const Layout& layout : layouts()) {
        if (!std::holds_alternative<Cube>(layout.projection)) continue;
        const Source source = map_source(painted_map(layout, n, smooth_world), layout);
        const int padded = n + 2 * source.border;
        ASSERT_EQ(source.pixels.size(), (Size{padded, 6 * padded})) << layout.name;
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < padded; ++y)
                for (int x = 0; x < padded; ++x) {
                    const V3d d = Cube().direction_on(face, 2 * (x - source.border + 0.5) / n - 1,
                                                      2 * (y - source.border + 0.5) / n - 1);
                    const float* p = source.pixels.pixel(x, face * padded + y);
                    const V3d off = V3d(p[0], p[1], p[2]) - smooth_world(d);
                    // In a border clamped to the last half pixel of the next face: 1.2 a radian
                    // times up to half a pixel of 3.6 degrees at a corner
                    EXPECT_LT(off.length(), 0.04) << layout.name << face << " " << x << " " << y;
                    EXPECT_EQ(p[3], 1.0F);
                }
    }
}

TEST(MapSource, GoesRoundAndOverThePolesOfALatLong) {
    const Layout& layout = *find_layout("latlong");
    Image map({8, 4}, 3);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x) map.pixel(x, y)[0] = static_cast<float>(10 * y + x);
    const Source source = map_source(map, layout);
    ASSERT_EQ(source.border, 2);
    const auto at = [&](int x, int y) { return source.pixels.pixel(x + 2, y + 2)[0]; };
    EXPECT_EQ(at(3, 1), 13.0F);
    EXPECT_EQ(at(-1, 1), 17.0F);
    EXPECT_EQ(at(-2, 1), 16.0F);
    EXPECT_EQ(at(8, 2), 20.0F);
    EXPECT_EQ(at(9, 2), 21.0F);
    EXPECT_EQ(at(1, -1), 5.0F);  // beyond the zenith, on the other side
    EXPECT_EQ(at(1, -2), 15.0F);
    EXPECT_EQ(at(6, 4), 32.0F);
    EXPECT_EQ(at(6, 5), 22.0F);
    EXPECT_EQ(at(-1, -1), 3.0F);
}

TEST(MapSource, FillsWhatLiesBeyondTheEdgeOfAnAngularMap) {
    const Layout& layout = *find_layout("angular");
    // A background that nothing may pick up
    const Image map =
        painted(Angular{}, {64, 64}, scale(1 / 64.0, 1 / 64.0), smooth_world, V3d(1e6, 1e6, 1e6));
    const Source source = map_source(map, layout);
    const Lookup<Angular> lookup(source);
    for (const V3d& d : directions_on_sphere(2000)) {
        const auto tap = lookup.tap(lookup.locate(d).value());
        ASSERT_TRUE(tap);
        // Up to two and a half pixels of 5.6 degrees inside the edge, of a world that rises by 1.2
        // a radian
        EXPECT_LT((V3d(tap->r, tap->g, tap->b) - smooth_world(d)).length(), 0.3) << d;
    }
}

TEST(BilinearTap, IsAPixelsValueInItsMiddleAndTheMeanBetweenFour) {
    Image image({3, 3}, 4);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) {
            image.pixel(x, y)[0] = static_cast<float>(x + 10 * y);
            image.pixel(x, y)[3] = 1;
        }
    EXPECT_EQ(bilinear_tap(image.view(), {1.5, 1.5}).r, 11.0F);
    EXPECT_EQ(bilinear_tap(image.view(), {1, 1}).r, 5.5F);
    EXPECT_EQ(bilinear_tap(image.view(), {1.75, 0.5}).r, 1.25F);
    EXPECT_EQ(bilinear_tap(image.view(), {0.5, 1.75}).r, 12.5F);
    EXPECT_EQ(bilinear_tap(image.view(), {1.2, 1.3}).w, 1.0F);
}

TEST(Lookup, KnowsWhereASeamIsNear) {
    const Layout& layout = *find_layout("openexr");
    const Source source = map_source(painted_map(layout, 16, smooth_world), layout);
    const Lookup<Cube> lookup(source);
    EXPECT_TRUE(lookup.whole(*lookup.locate(V3d(0, 0, 1)), {3, 3}));
    EXPECT_FALSE(lookup.whole(*lookup.locate(V3d(0, 0, 1)), {12, 3}));
    EXPECT_FALSE(lookup.whole(*lookup.locate(V3d(0.99, 0, 1)), {3, 3}));
    EXPECT_FALSE(lookup.whole(*lookup.locate(V3d(0, 0.99, 1)), {3, 3}));
    EXPECT_TRUE(lookup.whole(*lookup.locate(V3d(0, 0.99, 1)), {3, 1}));
}

}  // namespace
}  // namespace chromeball
