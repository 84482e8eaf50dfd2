#include "light/view.h"

#include <gtest/gtest.h>

#include <numbers>

#include "light/view_cube.h"
#include "map/layouts.h"
#include "support/views.h"

namespace chromeball {
namespace {

using std::numbers::pi;

TEST(ViewPyramid, ShowsTheWorldWhereItIs) {
    const test::Place place(1);
    const Rotation to_world = Rotation::yaw_pitch_roll(30, 50, -80);
    Camera camera;
    camera.focal = 1100;
    camera.principal = V2d(120, 120);
    for (const MirrorBall& ball : {MirrorBall(Outline{120, 120, 110, 110, 0}),
                                   MirrorBall(camera, cone_of({120, 120, 110, 110, 0}, camera))}) {
        const Image photo = test::ball_view({240, 240}, ball, to_world,
                                            [&](V3d world, V3d) { return place(world); });
        const ViewPyramid view({ball_source(photo, ball, {}), std::nullopt});
        const auto world = fibonacci_directions(500);
        std::vector<ViewPyramid::Sample> samples(world.size());
        view.sample(world, to_world, 2.0 / 110, samples);
        // Values are relative to the median light: one factor is free.
        std::vector<double> factors;
        for (std::size_t i = 0; i < world.size(); ++i)
            if (samples[i].weight > 0.3F)
                factors.push_back((std::exp2(static_cast<double>(samples[i].value[1])) - 0.02) /
                                  place(world[i]).y);
        ASSERT_GT(factors.size(), 300u);
        std::sort(factors.begin(), factors.end());
        // A pixel's mean is not its middle's value; half a pixel off would be 10 %.
        EXPECT_NEAR(factors[factors.size() / 20] / factors[factors.size() / 2], 1, 0.02);
        EXPECT_NEAR(factors[factors.size() * 19 / 20] / factors[factors.size() / 2], 1, 0.02);
    }
}

TEST(ViewPyramid, TellsPlacesAsTheProjectionDoes) {
    Camera camera;
    camera.focal = 500;
    camera.principal = V2d(90, 130);
    const MirrorBall ball(camera, cone_of({120, 120, 110, 109, 20}, camera));
    const Image photo({240, 240}, 3);
    const Source source = ball_source(photo, ball, {});
    const ViewPyramid view({source, std::nullopt});
    const auto world = fibonacci_directions(400);
    std::vector<V2d> places(world.size());
    view.places(world, {}, places);
    int compared = 0;
    for (std::size_t i = 0; i < world.size(); ++i) {
        if (!std::isfinite(places[i].x)) continue;
        const auto exact = ball.to_position(world[i]);
        ASSERT_TRUE(exact);
        EXPECT_LT((source.to_pixels(*exact) - places[i]).length(), 1e-3);  // of a table
        ++compared;
    }
    EXPECT_GT(compared, 350);
}

TEST(ViewPyramid, KnowsTheShortWayRoundAMap) {
    const Layout& latlong = *find_layout("latlong");
    Image map(latlong.picture(64), 4);
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) std::fill_n(map.pixel(x, y), 4, 1.0F);
    const ViewPyramid view({map_source(map, latlong), std::nullopt});
    const std::vector<V3d> beside{V3d(-0.01, 0, -1).normalized(), V3d(0.01, 0, -1).normalized()};
    std::vector<V2d> places(2);
    view.places(beside, {}, places);
    EXPECT_GT(std::abs(places[0].x - places[1].x), 500);
    EXPECT_NEAR(std::abs(view.way(places[0], places[1]).x), 1024 * 0.02 / (2 * pi), 0.01);
}

TEST(BallOf, IsTheBallThatStandsSoFarAway) {
    Camera unknown;
    unknown.principal = V2d(150, 100);
    const BallModel model{{130, 90, 50, 50, 0}, unknown, false, 1};
    const auto ball = ball_of(model, {1, -2, 0.1, 1 / 12.0});
    ASSERT_TRUE(ball);
    EXPECT_NEAR(ball->distance(), 12, 0.01);
    EXPECT_NEAR(ball->outline().cx, 131, 0.2);
    EXPECT_NEAR(ball->outline().cy, 88, 0.2);
    EXPECT_NEAR(ball->outline().b, 55, 0.2);
    ASSERT_TRUE(ball_of(model, {}));
    EXPECT_TRUE(ball_of(model, {})->orthographic());
}

TEST(ViewCube, KnowsItsNeighboursOverEdges) {
    const ViewCube cube(16);
    double sphere = 0;
    for (std::size_t i = 0; i < cube.cells(); ++i) {
        sphere += cube.solid_angle(i);
        for (const std::uint32_t n : cube.neighbours(i)) {
            EXPECT_NE(n, i);
            EXPECT_LT(std::acos(std::min(1.0, cube.direction(i).dot(cube.direction(n)))),
                      1.5 * cube.cell_angle());
        }
    }
    EXPECT_NEAR(sphere, 4 * pi, 0.02);  // each cell's middle stands for all of it
}

}  // namespace
}  // namespace chromeball
