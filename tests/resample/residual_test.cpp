#include "resample/residual.h"

#include <gtest/gtest.h>

#include <cmath>

#include "resample/resample.h"

namespace chromeball {
namespace {

constexpr int kSide = 240;

/// A ball as it looks in a world of stripes, seen through a camera.
Image painted(const MirrorBall& ball) {
    Image photo({kSide, kSide}, 3);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const auto d = ball.to_direction(V2d(x + 0.5, y + 0.5));
            float* p = photo.pixel(x, y);
            for (int c = 0; c < 3; ++c)
                p[c] = d ? static_cast<float>(1 + 0.5 * std::sin(9 * d->x + c) * std::sin(9 * d->y))
                         : 0.2F;
        }
    return photo;
}

MirrorBall near_ball(double radius) {
    const Outline outline{120, 120, radius, radius, 0};
    Camera camera;
    camera.principal = V2d(120, 120);
    camera.focal = focal_from_distance(outline, camera.principal, 8);
    return {camera, cone_of(outline, camera)};
}

Residual residual_with(const MirrorBall& truth, const MirrorBall& used) {
    const Image photo = painted(truth);
    const Layout& latlong = *find_layout("latlong");
    const Source map = map_source(resample(ball_source(photo, used, {}), latlong, 256), latlong);
    return residual_of(photo, render_ball(map, used, {0, 0, {kSide, kSide}}));
}

TEST(Residual, OfTheRightOutlineIsSmall) {
    const Residual right = residual_with(near_ball(100), near_ball(100));
    EXPECT_GT(right.pixels, 25000U);  // most of pi 100^2
    EXPECT_LT(right.median_stops, 0.01);
    EXPECT_LT(right.p95_stops, 0.1);
}

TEST(Residual, OfATooLargeOutlineShowsAtTheRim) {
    const Residual right = residual_with(near_ball(100), near_ball(100));
    const Residual wrong = residual_with(near_ball(100), near_ball(106));
    EXPECT_GT(wrong.p95_stops, 2 * right.p95_stops);
}

TEST(Residual, KnowsBrighterFromDarkerAndOneStopFromTwo) {
    Image photo({2, 1}, 3), render({2, 1}, 4);
    for (int c = 0; c < 3; ++c) {
        photo.pixel(0, 0)[c] = photo.pixel(1, 0)[c] = 1;
        render.pixel(0, 0)[c] = 2;     // a stop brighter
        render.pixel(1, 0)[c] = 0.5F;  // a stop darker
    }
    render.pixel(0, 0)[3] = render.pixel(1, 0)[3] = 1;
    const Residual r = residual_of(photo, render);
    EXPECT_EQ(r.pixels, 2U);
    EXPECT_NEAR(r.median_stops, 1, 1e-6);
    EXPECT_NEAR(r.picture.pixel(0, 0)[0], 1, 1e-6);  // red
    EXPECT_NEAR(r.picture.pixel(1, 0)[2], 1, 1e-6);  // blue
}

TEST(Residual, LeavesOutWhatIsNotWhollyBall) {
    Image photo({2, 1}, 4), render({2, 1}, 4);
    render.pixel(0, 0)[3] = 0.5F;
    photo.pixel(0, 0)[3] = 1;
    render.pixel(1, 0)[3] = 1;  // a hole in the photo
    EXPECT_EQ(residual_of(photo, render).pixels, 0U);
}

}  // namespace
}  // namespace chromeball
