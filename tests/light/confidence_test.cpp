#include "light/confidence.h"

#include <gtest/gtest.h>

#include <numbers>

#include "light/view_cube.h"
#include "support/views.h"

namespace chromeball {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Image grey({240, 240}, 3);

float one(const View& view, double finest, V3d d) {
    float value = -1;
    confidence(view, finest, {&d, 1}, {&value, 1});
    return value;
}

V3d away(double degrees) { return {std::sin(degrees * kDegree), 0, std::cos(degrees * kDegree)}; }

TEST(Confidence, OfADistantBallIsHowMuchItsPixelsAreDrawnOut) {
    const MirrorBall ball(Outline{120, 120, 110, 110, 0});
    const View view{ball_source(grey, ball, {}), std::nullopt};
    const double finest = finest_pixel(view.source);
    // theta = 2 asin(s): a pixel towards the rim spans 2 / (r cos(theta / 2)).
    for (const double theta : {0.0, 40.0, 90.0, 140.0})
        EXPECT_NEAR(one(view, finest, away(theta)), std::cos(0.5 * theta * kDegree), 1e-3);
    // Twice as fine a view exists.
    EXPECT_NEAR(one(view, 0.5 * finest, away(40)), 0.5 * std::cos(20 * kDegree), 1e-3);
}

TEST(Confidence, IsNoneInTheHiddenConeAndLittleAtTheRim) {
    Camera camera;
    camera.focal = 110 * std::sqrt(6.0 * 6 - 1);
    camera.principal = V2d(120, 120);
    const MirrorBall ball(camera, cone_of({120, 120, 110, 110, 0}, camera));
    const View view{ball_source(grey, ball, {}), std::nullopt};
    const double finest = finest_pixel(view.source), hidden = ball.hidden_half_angle() / kDegree;
    EXPECT_EQ(one(view, finest, away(180)), 0);
    EXPECT_EQ(one(view, finest, away(180.5 - hidden)), 0);
    const float at_rim = one(view, finest, away(179.5 - hidden));
    EXPECT_GT(at_rim, 0);
    EXPECT_LT(at_rim, 0.02);
    EXPECT_GT(one(view, finest, away(120)), 0.4);
}

TEST(Confidence, FallsWherePixelsAreClippedOrMasked) {
    const MirrorBall ball(Outline{120, 120, 110, 110, 0});
    Image photo({240, 240}, 3);
    for (int y = 0; y < 240; ++y)
        for (int x = 120; x < 240; ++x) photo.pixel(x, y)[2] = 1;
    Image trust = trust_of(photo, 0.99F);
    ASSERT_TRUE(any_doubt(trust));
    EXPECT_FALSE(any_doubt(trust_of(grey, 0.99F)));
    for (int y = 0; y < 60; ++y) std::fill_n(trust.row(y), 3 * 240, 0.0F);
    const View view{ball_source(photo, ball, {}), ball_source(trust, ball, {})};
    const double finest = finest_pixel(view.source);
    EXPECT_NEAR(one(view, finest, away(-60)), std::cos(30 * kDegree), 1e-3);
    EXPECT_NEAR(one(view, finest, away(60)), kClipped * std::cos(30 * kDegree), 1e-3);
    EXPECT_EQ(one(view, finest, V3d(0, 0.95, 0.3).normalized()), 0);
}

TEST(Confidence, OfAMapIsItsAlpha) {
    const Layout& latlong = *find_layout("latlong");
    Image map(latlong.picture(64), 4);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) map.pixel(x, y)[3] = y < 32 ? 1.0F : 0.25F;
    const View view{map_source(map, latlong), std::nullopt};
    const double finest = finest_pixel(view.source);
    EXPECT_GT(one(view, finest, V3d(0.1, 0.5, 0.4).normalized()), 0.7);
    EXPECT_NEAR(one(view, finest, V3d(0.1, -0.5, 0.4).normalized()) /
                    one(view, finest, V3d(0.1, 0.5, 0.4).normalized()),
                0.25, 0.01);
}

}  // namespace
}  // namespace chromeball
