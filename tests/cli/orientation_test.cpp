#include <gtest/gtest.h>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"

// Which way up and which way round the map comes out, against the synthetic world.

namespace chromeball {
namespace {

using namespace test;

class Orientation : public testing::Test {
protected:
    Orientation() {
        write_exr(folder / "ball.exr", ball_photo({160, 160}, distant_ball(80, 80, 72)));
    }
    static Words ball(const std::string& target, const Words& more) {
        Words words{"convert", "ball.exr", "--ball", "80,80,72", "--orthographic",
                    "--float", "--size",   "32",     "-o",       target};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    TempFolder folder;
    const Layout& latlong = *find_layout("latlong");
};

// 2.5e-2: a ball 144 pixels across, off the coarse rim.
constexpr double kTolerance = 2.5e-2;

TEST_F(Orientation, AnglesTurnTheWorldInTheContractsOrder) {
    struct Case {
        Words words;
        Rotation rotation;
    };
    const double m[9] = {0, 0, -1, 0, 1, 0, 1, 0, 0};
    const Rotation told = *Rotation::nearest(m);
    const std::vector<Case> cases{
        {{}, {}},
        {{"--yaw", "180"}, Rotation::about_y(180)},
        {{"--yaw", "90"}, Rotation::about_y(90)},
        {{"--yaw=-37.5"}, Rotation::about_y(-37.5)},
        {{"--pitch", "30"}, Rotation::about_x(30)},
        {{"--roll", "-45"}, Rotation::about_z(-45)},
        {{"--roll", "10", "--yaw", "20", "--pitch", "30"},
         Rotation::about_y(20) * Rotation::about_x(30) * Rotation::about_z(10)},
        {{"--camera-to-world", "0,0,-1,0,1,0,1,0,0"}, told},
        {{"--camera-to-world", "0,0,-1,0,1,0,1,0,0", "--pitch", "30"},
         Rotation::about_x(30) * told}};
    std::vector<Words> commands;
    for (std::size_t i = 0; i < cases.size(); ++i)
        commands.push_back(ball(fmt::format("{}.exr", i), cases[i].words));
    const auto outcomes = run_all(folder, commands);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(text_of(cases[i].words));
        ASSERT_EQ(outcomes[i].status, 0) << outcomes[i].err;
        const Image map = read_floats(folder / fmt::format("{}.exr", i));
        EXPECT_LT(difference(map, latlong, cases[i].rotation, -0.8).worst, kTolerance);
    }
}

TEST_F(Orientation, Yaw180PutsWhatTheCameraLooksAtIntoTheMiddle) {
    write_exr(folder / "world.exr", world_map(latlong, 64));
    const Outcome outcome = run(folder, {"convert", "world.exr", "--from", "latlong", "--yaw",
                                         "180", "--size", "32", "-o", "map.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Image map = read_floats(folder / "map.exr");
    const float* middle = map.pixel(32, 16);
    EXPECT_NEAR(middle[2], 0, 0.01);  // -Z is black in blue
    // And then what the camera has to its right is at three quarters.
    EXPECT_NEAR(map.pixel(48, 16)[0], 1, 0.01);
}

/// The matrix as EXR files hold it: row vectors, world to camera.
Metadata world_to_camera(const Rotation& camera_to_world) {
    Attribute attribute{"worldToCamera", "m44f", {}, {}};
    // p' = p M with M the transpose of the inverse, that is camera_to_world itself.
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            attribute.numbers.push_back(row < 3 && column < 3 ? camera_to_world.at(row, column)
                                        : row == column       ? 1
                                                              : 0);
    attribute.numbers[12] = 5;  // where the camera stands does not matter
    Metadata metadata;
    metadata.set(attribute);
    return metadata;
}

TEST_F(Orientation, TheFilesWorldToCameraIsUsedUnlessTold) {
    const Rotation pose = Rotation::yaw_pitch_roll(70, -20, 10);
    write_exr(folder / "ball.exr", ball_photo({160, 160}, distant_ball(80, 80, 72)),
              world_to_camera(pose));
    const auto outcomes =
        run_all(folder, {ball("file.exr", {}), ball("yaw.exr", {"--yaw", "90"}),
                         ball("told.exr", {"--camera-to-world", "1,0,0,0,1,0,0,0,1"}),
                         ball("cv.exr", {"--camera-axes", "opencv"})});
    for (const Outcome& outcome : outcomes) ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcomes[0].says("worldToCamera")) << outcomes[0].err;
    const auto worst = [&](const std::string& name, const Rotation& rotation) {
        return difference(read_floats(folder / name), latlong, rotation, -0.8).worst;
    };
    EXPECT_LT(worst("file.exr", pose), kTolerance);
    EXPECT_LT(worst("yaw.exr", Rotation::about_y(90) * pose), kTolerance);
    EXPECT_LT(worst("told.exr", {}), kTolerance);
    EXPECT_LT(worst("cv.exr", pose * Rotation::about_x(180)), kTolerance);
}

TEST_F(Orientation, AMapIsNotTurnedAgainByThePoseOfItsPhoto) {
    const Rotation pose = Rotation::yaw_pitch_roll(70, -20, 10);
    write_exr(folder / "ball.exr", ball_photo({160, 160}, distant_ball(80, 80, 72)),
              world_to_camera(pose));
    ASSERT_EQ(run(folder, ball("map.exr", {})).status, 0);
    const Outcome again = run(folder, {"convert", "map.exr", "--from", "latlong", "--float",
                                       "--size", "32", "-o", "again.exr"});
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_LT(difference(read_floats(folder / "again.exr"), latlong, pose, -0.75).worst, 4e-2);
}

TEST_F(Orientation, ExifOrientationIsUndoneAndOptionsDescribeTheUprightPhoto) {
    // Stored lying on its side: orientation 6 asks for a quarter turn clockwise.
    const Image upright = ball_photo({100, 140}, distant_ball(45, 80, 40));
    Image stored({140, 100}, 3);
    for (int y = 0; y < 140; ++y)
        for (int x = 0; x < 100; ++x) std::copy_n(upright.pixel(x, y), 3, stored.pixel(y, 99 - x));
    OIIO::ImageSpec spec(140, 100, 3, OIIO::TypeDesc::FLOAT);
    spec.attribute("Orientation", 6);
    const auto output = OIIO::ImageOutput::create("tiff");
    ASSERT_TRUE(output && output->open(folder / "side.tif", spec) &&
                output->write_image(OIIO::TypeDesc::FLOAT, stored.row(0)) && output->close());
    const Outcome outcome =
        run(folder, {"convert", "side.tif", "--ball", "45,80,40", "--orthographic", "--float",
                     "--size", "32", "-o", "map.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("100x140")) << outcome.err;
    EXPECT_LT(difference(read_floats(folder / "map.exr"), latlong, {}, -0.8).worst, 4e-2);
    // In a picture that lies on its side that ball would be partly outside.
    EXPECT_FALSE(outcome.says("outside")) << outcome.err;
}

TEST_F(Orientation, ANearBallOffTheAxisStaysInTheFrameOfTheCamerasAxes) {
    const Size size{340, 240};
    const MirrorBall near = near_ball(size, {0.35, 0.1, -1}, 4, 240);
    write_exr(folder / "near.exr", ball_photo(size, near));
    const Outline e = near.outline();
    const Outcome outcome =
        run(folder, {"convert", "near.exr", "--ellipse",
                     fmt::format("{},{},{},{},{}", e.cx, e.cy, e.a, e.b, e.angle), "--focal-px",
                     "240", "--float", "--size", "32", "-o", "map.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_FALSE(outcome.says("warning")) << outcome.err;
    EXPECT_TRUE(outcome.says("4.00 radii away")) << outcome.err;
    const Difference d = difference(read_floats(folder / "map.exr"), latlong, {}, -0.6);
    EXPECT_LT(d.worst, kTolerance);
    // Within asin(1/4) of straight behind the ball nothing was seen: 1.6 % of the sphere.
    const V3d behind = near.axis();
    const V2d at = *LatLong{}.to_position(behind);
    const Image map = read_floats(folder / "map.exr");
    EXPECT_EQ(map.pixel(static_cast<int>(at.x * 64) % 64, static_cast<int>(at.y * 32))[3], 0);
    // A circle told instead is made the cone's ellipse, and that is said.
    const Outcome circle =
        run(folder,
            {"convert", "near.exr", "--ball", fmt::format("{},{},{}", e.cx, e.cy, (e.a + e.b) / 2),
             "--focal-px", "240", "--float", "--size", "32", "-o", "circle.exr"});
    EXPECT_TRUE(circle.says("warning: near.exr: seen off the optical axis")) << circle.err;
    EXPECT_TRUE(circle.says("--ellipse")) << circle.err;
}

}  // namespace
}  // namespace chromeball
