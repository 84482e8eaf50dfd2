#include "render/view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace chromeball {
namespace {

using std::numbers::pi;

void expect_near(const V3d& a, const V3d& b, double tolerance) {
    EXPECT_LT((a - b).length(), tolerance)
        << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " " << b.z;
}

TEST(Orbit, StandsWhereItIsToldAndLooksAtTheMiddle) {
    const Size size{320, 180};
    expect_near(View::orbit(size, 0, 0, 4, 30).eye(), V3d(0, 0, 4), 1e-12);
    expect_near(View::orbit(size, 90, 0, 4, 30).eye(), V3d(4, 0, 0), 1e-12);
    expect_near(View::orbit(size, 0, 90, 4, 30).eye(), V3d(0, 4, 0), 1e-12);
    expect_near(View::orbit(size, 0, 0, 4, 30, V3d(1, 2, 3)).eye(), V3d(1, 2, 7), 1e-12);
    for (const double azimuth : {0.0, 30.0, 200.0})
        for (const double elevation : {-60.0, 0.0, 45.0}) {
            const View view = View::orbit(size, azimuth, elevation, 4, 30);
            expect_near(V3d(view.beam(160, 90, 1).direction), view.eye() * -0.25, 1e-6);
            EXPECT_GE(V3d(view.beam(160, 0, 1).direction).y, view.beam(160, 180, 1).direction.y)
                << "up is up";
        }
    // At 0, 0 the picture's right is +X.
    EXPECT_GT(View::orbit(size, 0, 0, 4, 30).beam(320, 90, 1).direction.x, 0);
}

TEST(Orbit, HasTheFieldOfViewFromTopToBottom) {
    const View view = View::orbit({320, 180}, 10, 20, 4, 40);
    const V3f top = view.beam(160, 0, 1).direction, bottom = view.beam(160, 180, 1).direction;
    EXPECT_NEAR(std::acos(top.dot(bottom)) * 180 / pi, 40, 1e-3);
}

TEST(View, TellsHowItsRaysChange) {
    Camera lens;
    lens.focal = 300;
    lens.principal = V2d(100, 70);
    Camera bent = lens;
    bent.distortion.k1 = -0.1;
    for (const Camera& camera : {lens, bent}) {
        const View view({200, 160}, camera, V3d(1, 2, 3), Rotation::yaw_pitch_roll(20, 30, 40));
        const Beam at = view.beam(150, 30, 1), right = view.beam(151, 30, 1),
                   below = view.beam(150, 31, 1);
        EXPECT_LT((right.direction - at.direction - at.direction_x).length(), 2e-5F);
        EXPECT_LT((below.direction - at.direction - at.direction_y).length(), 2e-5F);
        EXPECT_LT((view.beam(150, 30, 0.25F).direction_x * 4.0F - at.direction_x).length(), 1e-7F);
    }
}

/// Rays hit the ball where its projection says, and are mirrored as it says.
TEST(ViewOfBall, AgreesWithTheBallsProjection) {
    Camera lens;
    lens.focal = 500;
    lens.principal = V2d(320, 240);
    const Cone cone{V3d(0.2, -0.1, -1).normalized(), std::asin(1 / 6.0)};
    const MirrorBall near_ball(lens, cone);
    const MirrorBall distant_ball(Outline{300, 200, 80, 70, 30});
    const Rotation turn = Rotation::yaw_pitch_roll(50, -20, 10);
    for (const MirrorBall& ball : {near_ball, distant_ball}) {
        const View view =
            View::of_ball({640, 480}, ball.orthographic() ? Camera{} : lens, ball, turn);
        const Outline& e = ball.outline();
        for (int i = 0; i < 12; ++i)
            for (const double r : {0.0, 0.5, 0.95, 1.05}) {
                const V2d rim = rim_point(e, 2 * pi * i / 12);
                const V2d at = V2d(e.cx, e.cy) + (rim - V2d(e.cx, e.cy)) * r;
                const Beam beam = view.beam(at.x, at.y, 1);
                const V3d o(beam.origin), d(beam.direction);
                const double middle = -o.dot(d), room = 1 - (o + d * middle).length2();
                const auto mirrored = ball.to_direction(at);
                ASSERT_EQ(mirrored.has_value(), room > 0);
                if (!mirrored) continue;
                const V3d n = o + d * (middle - std::sqrt(room));
                expect_near(d - n * (2 * d.dot(n)), turn * *mirrored, 1e-3);
            }
    }
}

}  // namespace
}  // namespace chromeball
