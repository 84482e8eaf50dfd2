#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"
#include "detect/painted.h"

// What detect prints, draws and cuts out.

namespace chromeball {
namespace {

using namespace test;
using nlohmann::json;

constexpr Size kSize{640, 360};
const std::string kPhotos = std::string(CHROMEBALL_DATA) + "/photos/";

/// A folder with a photo of a ball, a wall without one, and a file that is no picture.
class Detect : public testing::Test {
protected:
    Detect() {
        Image wall(kSize, 3);
        for (int y = 0; y < kSize.height; ++y)
            for (int x = 0; x < kSize.width; ++x)
                for (int c = 0; c < 3; ++c)
                    wall.pixel(x, y)[c] =
                        static_cast<float>(0.04 + 0.01 * std::sin(0.2 * x) * std::cos(0.13 * y));
        write_encoded(folder / "ball.png", shrunk(read_floats(kPhotos + "interior.jpg"), 3));
        write_picture(folder / "wall.png", wall);
        write_bytes(folder / "notes.png", "no picture");
    }

    TempFolder folder;
};

void expect_outline(const json& found, double cx, double cy, double r, double tolerance) {
    const json& e = found.at("outline");
    EXPECT_NEAR(e.at("cx"), cx, tolerance);
    EXPECT_NEAR(e.at("cy"), cy, tolerance);
    EXPECT_NEAR(std::sqrt(e.at("a").get<double>() * e.at("b").get<double>()), r, tolerance);
}

TEST_F(Detect, OnePhotoPrintsTheContractsObject) {
    const Outcome outcome = run(folder, {"detect", "ball.png", "--focal-px", "900"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json found = json::parse(outcome.out);
    EXPECT_EQ(found.at("photo"), "ball.png");
    EXPECT_EQ(found.at("width"), 640);
    EXPECT_EQ(found.at("height"), 360);
    EXPECT_EQ(found.at("found"), true);
    EXPECT_GE(found.at("confidence"), 0.5);
    expect_outline(found, 300.6, 179.9, 86.7, 1);
    EXPECT_EQ(found.at("camera").at("focal_px"), 900);
    EXPECT_EQ(found.at("camera").at("principal"), json({320.0, 180.0}));
    EXPECT_EQ(found.at("camera").at("source"), "--focal-px");
    // The cone of a circle of 86.7 pixels: D = sqrt(900^2 + 86.7^2) / 86.7.
    EXPECT_NEAR(found.at("ball").at("distance_radii"), 10.43, 0.15);
    EXPECT_NEAR(found.at("ball").at("hidden_half_angle_degrees"), 5.5, 0.08);
    EXPECT_EQ(found.at("ball").at("center_direction").size(), 3U);
    EXPECT_NEAR(found.at("ball").at("center_direction")[0], -19.4 / 900, 1e-3);
    EXPECT_GT(found.at("visible_rim"), 0.5);
    EXPECT_EQ(found.at("warnings"), json::array());
}

TEST_F(Detect, WithoutAFocalLengthTheCameraIsOrthographicAndOneWarningSaysSo) {
    const Outcome outcome = run(folder, {"detect", "ball.png"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json found = json::parse(outcome.out);
    EXPECT_TRUE(found.at("camera").at("focal_px").is_null());
    EXPECT_TRUE(found.at("ball").at("distance_radii").is_null());
    EXPECT_EQ(found.at("warnings").size(), 1U);
    EXPECT_EQ(outcome.lines_with("warning: ball.png: the focal length is not known"), 1U);
}

TEST_F(Detect, AnEllipseOffTheAxisTellsTheFocalLengthAndHowSure) {
    painted::Scene scene;
    scene.camera.focal = 600;
    scene.centre = {2, -1, -6};
    const Photo photo = painted::camera_photo(scene);
    Image image(scene.size, 3);
    std::transform(photo.pixels.begin(), photo.pixels.end(), image.row(0), [](std::byte value) {
        return static_cast<float>(std::to_integer<int>(value)) / 255;
    });
    write_encoded(folder / "aside.png", image);
    const Outcome outcome = run(folder, {"detect", "aside.png"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json told = json::parse(outcome.out).at("camera");
    EXPECT_EQ(told.at("source"), "estimated from the outline");
    const double deviation = told.at("focal_px_deviation");
    EXPECT_LT(deviation, 60);
    EXPECT_NEAR(told.at("focal_px"), 600, 3 * deviation);
    EXPECT_EQ(outcome.lines_with("warning: aside.png: the focal length is not known; the outline"),
              1U);
    const Outcome far = run(folder, {"detect", "aside.png", "--orthographic"});
    EXPECT_TRUE(json::parse(far.out).at("camera").at("focal_px").is_null());
}

TEST_F(Detect, TheStatusTellsWhatBecameOfManyPhotos) {
    struct Case {
        Words photos;
        int status;
    };
    const std::vector<Case> cases{{{"ball.png"}, 0},

                                  {{"wall.png"}, 4},
                                  {{"ball.png", "wall.png"}, 4},
                                  {{"ball.png", "notes.png"}, 3},
                                  {{"wall.png", "gone.png", "ball.png"}, 3},
                                  {{"notes.png"}, 1},
                                  {{"notes.png", "gone.png"}, 1}};
    std::vector<Words> commands;
    for (const Case& one : cases) {
        commands.push_back({"detect", "--quiet"});
        commands.back().insert(commands.back().end(), one.photos.begin(), one.photos.end());
    }
    const auto outcomes = run_all(folder, commands);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(text_of(cases[i].photos));
        EXPECT_EQ(outcomes[i].status, cases[i].status) << outcomes[i].err;
        const json all = json::parse(outcomes[i].out);
        const json list = cases[i].photos.size() == 1 ? json::array({all}) : all;
        ASSERT_EQ(list.size(), cases[i].photos.size());
        std::size_t unreadable = 0;
        for (std::size_t k = 0; k < list.size(); ++k) {
            const std::string& photo = cases[i].photos[k];
            EXPECT_EQ(list[k].at("photo"), photo);  // in the order asked for
            EXPECT_EQ(list[k].at("found"), photo == "ball.png");
            EXPECT_EQ(list[k].contains("reason"), photo != "ball.png");
            EXPECT_TRUE(list[k].at("confidence").is_number());
            unreadable += photo == "notes.png" || photo == "gone.png";
        }
        EXPECT_EQ(outcomes[i].lines_with("error: "), unreadable) << outcomes[i].err;
    }
}

TEST_F(Detect, JsonLinesPrintsAnObjectALine) {
    const Outcome outcome =
        run(folder, {"detect", "--json-lines", "ball.png", "wall.png", "notes.png"});
    EXPECT_EQ(outcome.status, 3);
    std::istringstream lines(outcome.out);
    std::vector<json> all;
    for (std::string line; std::getline(lines, line);) all.push_back(json::parse(line));
    ASSERT_EQ(all.size(), 3U);
    EXPECT_EQ(all[1].at("photo"), "wall.png");
    const Outcome one = run(folder, {"detect", "--json-lines", "ball.png"});
    EXPECT_EQ(std::count(one.out.begin(), one.out.end(), '\n'), 1);
}

TEST_F(Detect, ANameThatIsNoUtf8DoesNotBreakTheJson) {
    const std::string name = "b\xff\"all.png";
    std::filesystem::copy(folder / "ball.png", folder / name);
    const Outcome outcome = run(folder, {"detect", name});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(json::accept(outcome.out)) << outcome.out;
}

TEST_F(Detect, AnOverlayIsThePhotoWithTheOutlineOnIt) {
    ASSERT_EQ(run(folder, {"detect", "ball.png", "--overlay", "look.png"}).status, 0);
    const Image look = read_floats(folder / "look.png"), photo = read_floats(folder / "ball.png");
    ASSERT_EQ(look.size(), photo.size());
    EXPECT_GT(largest_difference(look, photo), 0.3);
    // Far from the ball nothing is drawn.
    EXPECT_NEAR(look.pixel(5, 350)[0], photo.pixel(5, 350)[0], 0.02);
    // Without a ball the picture is still there, to see what was looked at.
    EXPECT_EQ(run(folder, {"detect", "wall.png", "--overlay", "wall-look.png"}).status, 4);
    EXPECT_EQ(read_floats(folder / "wall-look.png").size(), photo.size());
}

TEST_F(Detect, OverlaysAndCropsOfManyGoIntoAFolder) {
    const Outcome outcome = run(folder, {"detect", "ball.png", "wall.png", "notes.png", "--overlay",
                                         "looks", "--crop", "crops"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_EQ(folder.content(), (std::vector<std::string>{
                                    "ball.png", "crops/", "crops/ball.exr", "looks/",
                                    "looks/ball.png", "looks/wall.png", "notes.png", "wall.png"}));
}

TEST_F(Detect, PhotosOfOneNameDoNotOverwriteEachOthersOverlays) {
    std::filesystem::create_directory(folder / "b");
    std::filesystem::copy(folder / "ball.png", folder / "b/ball.png");
    const Outcome outcome = run(folder, {"detect", "ball.png", "b/ball.png", "--overlay", "looks"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(outcome.says("looks/ball.png")) << outcome.err;
}

TEST_F(Detect, AnOverlayThatCannotBeWrittenIsToldBeforeTheSearch) {
    expect_refusal(folder, {"detect", "ball.png", "--overlay", "gone/look.png"}, 1,
                   {"gone/look.png", "no folder gone"});
    expect_refusal(folder, {"detect", "ball.png", "--crop", "gone/crop.exr"}, 1, {"gone/crop.exr"});
    expect_refusal(folder, {"detect", "ball.png", "--overlay", "look"}, 2, {"look", ".png"});
    expect_refusal(folder, {"detect", "ball.png", "wall.png", "--overlay", "notes.png"}, 1,
                   {"notes.png", "is a file"});
}

TEST_F(Detect, AFoundBallStaysFoundWhenItsOverlayFailsToBeWritten) {
    Circumstances little;
    little.file_size_bytes = 2000;
    const Outcome outcome = run(folder, {"detect", "ball.png", "--overlay", "look.png"}, little);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(json::parse(outcome.out).at("found"), true);
    EXPECT_TRUE(outcome.says("error: look.png: cannot be written")) << outcome.err;
    EXPECT_FALSE(exists(folder / "look.png"));
    EXPECT_FALSE(exists(folder / ".look.png.part"));
}

/// Convert of a crop against convert of the whole photo with the same outline.
void expect_crop_equals_photo(const TempFolder& folder, const Words& ball, double tolerance) {
    Words crop{"detect", "photo.exr", "--crop", "crop.exr", "--crop-size", "200"};
    Words whole{"convert", "photo.exr", "--size", "32", "--float", "-o", "whole.exr"};
    crop.insert(crop.end(), ball.begin(), ball.end());
    whole.insert(whole.end(), ball.begin(), ball.end());
    const Outcome cut = run(folder, crop);
    ASSERT_EQ(cut.status, 0) << cut.err;
    const Image square = read_floats(folder / "crop.exr");
    EXPECT_EQ(square.size(), (Size{200, 200}));
    ASSERT_EQ(square.channels(), 4);
    EXPECT_EQ(square.pixel(3, 3)[3], 0);
    EXPECT_NEAR(square.pixel(100, 100)[3], 1, 1e-3);
    const Outcome photo = run(folder, whole);
    ASSERT_EQ(photo.status, 0) << photo.err;
    const Outcome cropped = run(folder, {"convert", "crop.exr", "--cropped", "--size", "32",
                                         "--float", "-o", "cropped.exr"});
    ASSERT_EQ(cropped.status, 0) << cropped.err;
    const Image a = read_floats(folder / "whole.exr"), b = read_floats(folder / "cropped.exr");
    ASSERT_EQ(a.size(), b.size());
    double worst = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x)
            if (a.pixel(x, y)[3] > 0.99F && b.pixel(x, y)[3] > 0.99F)
                for (int c = 0; c < 3; ++c)
                    worst = std::max(
                        worst, std::abs(static_cast<double>(a.pixel(x, y)[c]) - b.pixel(x, y)[c]));
    EXPECT_LT(worst, tolerance);
    EXPECT_LT(difference(b, *find_layout("latlong"), {}, -0.7).worst, 4e-2);
}

TEST_F(Detect, ACropGivesTheMapOfTheWholePhoto) {
    write_exr(folder / "photo.exr", ball_photo({240, 200}, distant_ball(130, 90, 70)));
    // 4e-2: resampled twice; at the rim a pixel spans many degrees.
    expect_crop_equals_photo(folder, {"--ball", "130,90,70", "--orthographic"}, 4e-2);
}

TEST_F(Detect, ACropOfANearBallFarFromTheAxisGivesTheMapOfTheWholePhoto) {
    const Size size{340, 240};
    const MirrorBall ball = near_ball(size, {0.35, 0.1, -1}, 4, 240);
    const Outline e = ball.outline();
    ASSERT_GT(e.a - e.b, 2);  // clearly no circle
    write_exr(folder / "photo.exr", ball_photo(size, ball));
    std::ostringstream ellipse;
    ellipse.precision(12);
    ellipse << e.cx << ',' << e.cy << ',' << e.a << ',' << e.b << ',' << e.angle;
    expect_crop_equals_photo(folder, {"--ellipse", ellipse.str(), "--focal-px", "240"}, 5e-2);
}

TEST_F(Detect, ATakenOutBallThatKnowsNoCameraIsOrthographic) {
    write_exr(folder / "square.exr", ball_photo({128, 128}, distant_ball(64, 64, 64)));
    const Outcome outcome =
        run(folder, {"convert", "square.exr", "--cropped", "--size", "32", "-o", "map.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("orthographic")) << outcome.err;
    EXPECT_LT(difference(read_floats(folder / "map.exr"), *find_layout("latlong"), {}, -0.8).worst,
              3e-2);
}

TEST_F(Detect, BallsInPhotographsAreFound) {
    const Outcome outcome = run(
        folder, {"detect", kPhotos + "city.jpg", kPhotos + "interior.jpg", kPhotos + "garden.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json all = json::parse(outcome.out);
    // Renders: 2 % of the radius is what counts as right.
    expect_outline(all.at(0), 960, 518, 300, 6);
    expect_outline(all.at(1), 902, 539.5, 260, 5);
    expect_outline(all.at(2), 804, 485, 220, 4.5);
    EXPECT_NE(all.at(1).at("camera").at("source").get<std::string>().find("exif"),
              std::string::npos);
    EXPECT_NE(all.at(2).at("camera").at("source").get<std::string>().find("exr"),
              std::string::npos);
}

TEST_F(Detect, AllListsEveryCandidateBestFirst) {
    const Outcome outcome = run(folder, {"detect", "ball.png", "--all", "--overlay", "all.png"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json found = json::parse(outcome.out);
    const json& candidates = found.at("candidates");
    ASSERT_GE(candidates.size(), 1U);
    EXPECT_EQ(candidates[0].at("outline"), found.at("outline"));
    for (std::size_t i = 1; i < candidates.size(); ++i)
        EXPECT_LE(candidates[i].at("confidence"), candidates[i - 1].at("confidence"));
    EXPECT_GT(found.at("outline_deviation").at("cx"), 0);
    EXPECT_LT(found.at("outline_deviation").at("cx"), 3);
    EXPECT_TRUE(exists(folder / "all.png"));
    EXPECT_FALSE(json::parse(run(folder, {"detect", "ball.png"}).out).contains("candidates"));
}

TEST_F(Detect, NearAndRadiusRangeSayWhichBallIsMeant) {
    const auto outcomes = run_all(folder, {{"detect", "ball.png", "--near", "300,180"},
                                           {"detect", "ball.png", "--near", "20,20"},
                                           {"detect", "ball.png", "--radius-range", "60,120"},
                                           {"detect", "ball.png", "--radius-range=150,300"}});
    EXPECT_EQ(outcomes[0].status, 0) << outcomes[0].err;
    EXPECT_EQ(outcomes[1].status, 4) << outcomes[1].out;
    EXPECT_EQ(outcomes[2].status, 0) << outcomes[2].err;
    EXPECT_EQ(outcomes[3].status, 4) << outcomes[3].out;
    expect_refusal(folder, {"detect", "ball.png", "--near", "300"}, 2, {"--near 300", "X,Y"});
    expect_refusal(folder, {"detect", "ball.png", "--radius-range", "90,20"}, 2,
                   {"--radius-range 90,20", "MIN < MAX"});
}

TEST_F(Detect, AContactSheetShowsAllPhotosAndTheUnreadableToo) {
    const Outcome outcome = run(
        folder, {"detect", "ball.png", "wall.png", "notes.png", "--contact-sheet", "sheet.png"});
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    const Image sheet = read_floats(folder / "sheet.png");
    // Two rows of two cells of 360 x 240, a line of caption under each.
    EXPECT_GT(sheet.width(), 2 * 360);
    EXPECT_GT(sheet.height(), 2 * 264);
    EXPECT_LT(sheet.height(), 3 * 264);
    // The ball's cell holds its picture: 360 wide, so 202 high, in the middle of the cell.
    EXPECT_GT(sheet.pixel(8 + 180, 8 + 120)[0] + sheet.pixel(8 + 180, 8 + 60)[0], 0.05F);
    expect_refusal(folder, {"detect", "ball.png", "--contact-sheet", "ball.png"}, 2, {"ball.png"});
    expect_refusal(folder, {"detect", "ball.png", "--contact-sheet", "sheet.txt"}, 2,
                   {"sheet.txt"});
}

/// A street with a ball that moves up by `motion` pixels while the shutter is open.
Image moving_ball(double motion) {
    painted::Scene scene;
    scene.size = {480, 320};
    scene.camera = {700.0, {240, 160}};
    scene.centre = {-0.3, 0.2, -6};
    scene.samples = 1;
    constexpr int kTimes = 16;
    const V3d middle = scene.centre;
    Image mean(scene.size, 3);
    for (int time = 0; time < kTimes; ++time) {
        const double part = (time + 0.5) / kTimes - 0.5;
        scene.centre = middle + V3d(0, part * motion * -middle.z / 700, 0);
        const std::vector<float> light = scene.light();
        for (std::size_t i = 0; i < light.size(); ++i)
            mean.pixel(static_cast<int>(i / 3 % 480), static_cast<int>(i / 3 / 480))[i % 3] +=
                std::min(light[i], 1.0F) / kTimes;
    }
    return mean;
}

TEST_F(Detect, ABallThatMovedIsSaidToHave) {
    write_encoded(folder / "moving.png", moving_ball(14));
    const Outcome outcome = run(folder, {"detect", "moving.png", "--all"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json found = json::parse(outcome.out);
    expect_outline(found, 204, 136, 118.3, 4);
    EXPECT_NEAR(found.at("motion")[0].get<double>(), 0, 2.5);
    EXPECT_NEAR(std::abs(found.at("motion")[1].get<double>()), 14, 2.5);
    EXPECT_EQ(found.at("candidates")[0].at("motion"), found.at("motion"));
    EXPECT_FALSE(json::parse(run(folder, {"detect", "ball.png"}).out).contains("motion"));
}

TEST_F(Detect, LensTermsNeedAFocalLength) {
    expect_refusal(folder, {"detect", "ball.png", "--k1", "-0.1"}, 2, {"--k1", "--focal-px"});
    const Outcome straight = run(folder, {"detect", "ball.png", "--focal-px", "900"});
    const Outcome bent = run(folder, {"detect", "ball.png", "--focal-px", "900", "--k1=-0.3"});
    ASSERT_EQ(bent.status, 0) << bent.err;
    // Barrel distortion makes the ball look smaller than it is, so it is nearer.
    EXPECT_LT(json::parse(bent.out).at("ball").at("distance_radii"),
              json::parse(straight.out).at("ball").at("distance_radii"));
}

}  // namespace
}  // namespace chromeball
