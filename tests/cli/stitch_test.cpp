#include <gtest/gtest.h>

#include <OpenImageIO/imageio.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"
#include "support/views.h"

namespace chromeball::test {
namespace {

using Json = nlohmann::json;

const Rotation kSide = Rotation::yaw_pitch_roll(90, 5, -10);
const std::string kBall = "100,100,90", kFar = "--orthographic";

/// A ball of a place, far away, in the middle of 200 x 200 pixels, with its photographer.
Image photo(const Place& place, const Rotation& to_world, double exposure = 1,
            Size size = {200, 200}, double radius = 90) {
    const MirrorBall ball = distant_ball(0.5 * size.width, 0.5 * size.height, radius);
    return ball_view(size, ball, to_world, [&](V3d world, V3d seen) {
        return with_photographer(place(world), seen) * exposure;
    });
}

void write_pair(const TempFolder& folder, double exposure = 1) {
    const Place place(7);
    write_exr(folder / "a.exr", photo(place, {}));
    write_exr(folder / "b.exr", photo(place, kSide, exposure));
}

Words stitch(const Words& more) {
    Words words{"stitch", "a.exr", "b.exr", "-o",     "env.exr", "--ball", kBall,
                "--ball", kBall,   kFar,    "--size", "64",      "--float"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// The part of the sphere where a lat-long is more than a fifth of a stop off a place; what is
/// transparent, too, if it must be whole.
double part_off(const Image& map, const Place& place, bool whole = true) {
    double off = 0, all = 0;
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const V2d p((x + 0.5) / map.width(), (y + 0.5) / map.height());
            const double area = LatLong().solid_angle(p);
            const V3d truth = place(*LatLong().to_direction(p));
            const float* is = map.pixel(x, y);
            if (!whole && is[3] < 0.5F) continue;
            all += area;
            if (!(std::abs(std::log2(static_cast<double>(is[1]) / truth.y)) < 0.2)) off += area;
        }
    return off / all;
}

Rotation rotation_of(const Json& view) {
    const auto numbers = view["rotation"].get<std::vector<double>>();
    return Rotation::nearest(numbers).value();
}

TEST(Stitch, FindsTheTurnAndRemovesPhotographers) {
    const TempFolder folder;
    write_pair(folder, 0.5);
    const Outcome result = run(folder, stitch({"--json"}));
    ASSERT_EQ(result.status, 0) << result.err;
    const Json told = Json::parse(result.out);
    ASSERT_EQ(told["views"].size(), 2u);
    EXPECT_EQ(told["views"][0]["file"], "a.exr");
    EXPECT_LT(degrees_between(rotation_of(told["views"][0]), {}), 1e-6);
    EXPECT_LT(degrees_between(rotation_of(told["views"][1]), kSide), 0.05);
    EXPECT_EQ(told["views"][0]["exposure_stops"], 0);
    EXPECT_NEAR(told["views"][1]["exposure_stops"].get<double>(), 1, 0.01);
    EXPECT_LT(told["views"][1]["residual_degrees"].get<double>(), 0.05);
    EXPECT_GT(told["covered"].get<double>(), 0.999);
    const Image map = read_floats(folder / "env.exr");
    ASSERT_EQ(map.size(), (Size{128, 64}));
    EXPECT_LT(part_off(map, Place(7)), 0.005);
    EXPECT_EQ(folder.content(), (std::vector<std::string>{"a.exr", "b.exr", "env.exr"}));
}

TEST(Stitch, TurnsAsConvertDoes) {
    const TempFolder folder;
    write_pair(folder);
    const std::string world = "0,0,1,0,1,0,-1,0,0";  // a quarter about +Y
    const Outcome result = run(
        folder, stitch({"--json", "--camera-to-world", world, "--yaw=20", "--layout", "openexr"}));
    ASSERT_EQ(result.status, 0) << result.err;
    const Json told = Json::parse(result.out);
    const Rotation first = Rotation::about_y(20) * Rotation::about_y(90);
    EXPECT_LT(degrees_between(rotation_of(told["views"][0]), first), 1e-6);
    EXPECT_LT(degrees_between(rotation_of(told["views"][1]), first * kSide), 0.05);
}

TEST(Stitch, TakesToldTurnsAsTheyAre) {
    const TempFolder folder;
    write_pair(folder);
    std::string side;
    for (const double number : kSide.rows()) {
        if (!side.empty()) side += ',';
        side += std::to_string(number);
    }
    const std::string same = "1,0,0,0,1,0,0,0,1";
    const auto results = run_all(
        folder, {stitch({"--json", "--camera-to-world", same, "--camera-to-world", side}),
                 stitch({"--camera-to-world", "-", "--camera-to-world", "-", "-o", "2.exr"})});
    ASSERT_EQ(results[0].status, 0) << results[0].err;
    EXPECT_LT(degrees_between(rotation_of(Json::parse(results[0].out)["views"][1]), kSide), 1e-3);
    EXPECT_LT(part_off(read_floats(folder / "env.exr"), Place(7)), 0.005);
    EXPECT_EQ(results[1].status, 2);  // -o twice
}

TEST(Stitch, TakesMapsToo) {
    const TempFolder folder;
    write_pair(folder);
    Words convert{"convert", "b.exr", "-o", "b-map.exr", "--ball", kBall, kFar, "--size", "128"};
    ASSERT_EQ(run(folder, convert).status, 0);
    const Outcome result = run(folder, {"stitch", "a.exr", "b-map.exr", "-o", "env.exr", "--ball",
                                        kBall, kFar, "--size", "64", "--float", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_LT(degrees_between(rotation_of(Json::parse(result.out)["views"][1]), kSide), 0.1);
    // Whose map it is knows where its photographer stands.
    EXPECT_LT(part_off(read_floats(folder / "env.exr"), Place(7)), 0.01);
}

TEST(Stitch, TakesPhotosOfDifferentSizes) {
    const TempFolder folder;
    const Place place(7);
    write_exr(folder / "a.exr", photo(place, {}));
    write_exr(folder / "b.exr", photo(place, kSide, 1, {420, 320}, 150));
    const Outcome result =
        run(folder, {"stitch", "a.exr", "b.exr", "-o", "env.exr", "--ball", kBall, "--ball",
                     "210,160,150", kFar, "--size", "64", "--float"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_LT(part_off(read_floats(folder / "env.exr"), place), 0.005);
}

TEST(Stitch, RefusesViewsOfDifferentPlaces) {
    const TempFolder folder;
    write_exr(folder / "a.exr", photo(Place(7), {}));
    write_exr(folder / "b.exr", photo(Place(8), kSide));
    expect_refusal(folder, stitch({}), 1, {".exr", "does not show the place", "--camera-to-world"});
}

TEST(Stitch, WarnsOfIdenticalPhotos) {
    const TempFolder folder;
    write_exr(folder / "a.exr", photo(Place(7), {}));
    write_exr(folder / "b.exr", photo(Place(7), {}));
    const Outcome result = run(folder, stitch({}));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(result.says("a.exr and b.exr are taken from the same side")) << result.err;
}

TEST(Stitch, FillsOneViewAndMarksWhatItDidNotSee) {
    const TempFolder folder;
    write_exr(folder / "a.exr", photo(Place(7), {}));
    const Words one{"stitch", "a.exr", "--ball", kBall, kFar, "--size", "64", "--float"};
    const auto with = [&](const Words& more) {
        Words words = one;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    const auto results =
        run_all(folder, {with({"-o", "1.exr"}), with({"-o", "2.exr", "--remove-photographer"})});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(results[0].says("one view")) << results[0].err;
    const Image plain = read_floats(folder / "1.exr"), guessed = read_floats(folder / "2.exr");
    // Of a person who stands at the camera 12 x 40 degrees.
    const double person = part_off(plain, Place(7));
    EXPECT_GT(person, 0.008);
    EXPECT_LT(part_off(guessed, Place(7), false), 0.5 * person);
    EXPECT_EQ(plain.pixel(64, 32)[3], 1);
    EXPECT_EQ(guessed.pixel(64, 32)[3], 0);
    EXPECT_GT(guessed.pixel(64, 32)[1], 0.05F);
}

TEST(Stitch, LeavesMasksOut) {
    const TempFolder folder;
    write_exr(folder / "a.exr", photo(Place(7), {}));
    Image mask({200, 200}, 3);
    for (int y = 80; y < 120; ++y)
        for (int x = 80; x < 120; ++x) std::fill_n(mask.pixel(x, y), 3, 1.0F);
    write_picture(folder / "mask.png", mask);
    write_picture(folder / "small.png", shrunk(mask, 2));
    const Words words{"stitch", "a.exr",  "-o", "env.exr", "--ball", kBall,
                      kFar,     "--size", "64", "--float", "--mask"};
    const auto masked = [&](const std::string& file) {
        Words all = words;
        all.push_back(file);
        return all;
    };
    ASSERT_EQ(run(folder, masked("mask.png")).status, 0);
    const Image map = read_floats(folder / "env.exr");
    EXPECT_EQ(map.pixel(64, 32)[3], 0);
    EXPECT_EQ(map.pixel(20, 32)[3], 1);
    expect_refusal(folder, masked("small.png"), 1, {"small.png", "100x100", "200x200"});
    expect_refusal(folder, masked("none.png"), 1, {"none.png"});
}

TEST(Stitch, WritesConfidence) {
    const TempFolder folder;
    write_pair(folder);
    const auto results = run_all(folder, {stitch({"--confidence", "--fill", "none"}),
                                          {"convert", "a.exr", "-o", "one.tif", "--ball", kBall,
                                           kFar, "--size", "64", "--float", "--confidence"}});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    for (const char* name : {"env.exr", "one.tif"}) {
        const auto file = OIIO::ImageInput::open(folder / name);
        ASSERT_TRUE(file) << name;
        ASSERT_EQ(file->spec().nchannels, 5) << name;
        if (name[0] == 'e') {  // TIFF names no channels
            EXPECT_EQ(file->spec().channelnames[4], "confidence");
        }
        std::vector<float> pixels(5 * 128 * 64);
        ASSERT_TRUE(file->read_image(0, 0, 0, 5, OIIO::TypeFloat, pixels.data()));
        const auto at = [&](std::size_t x, std::size_t y) { return pixels[5 * (128 * y + x) + 4]; };
        EXPECT_GT(at(64, 30), name[0] == 'o' ? 0.95F : 0.6F) << name;  // towards the camera
        EXPECT_LT(at(2, 32), name[0] == 'o' ? 0.1F : 0.9F) << name;    // away from it
    }
    expect_refusal(folder, {"convert", "a.exr", "-o", "one.png", "--ball", kBall, "--confidence"},
                   2, {"one.png", "--confidence", "EXR and TIFF"});
}

TEST(Stitch, ConvertsWithoutThePhotographer) {
    const TempFolder folder;
    write_exr(folder / "a.exr", photo(Place(7), {}));
    const Words words{"convert", "a.exr", "--ball", kBall, kFar, "--size", "64"};
    const auto to = [&](const Words& more) {
        Words all = words;
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    const auto results = run_all(folder, {to({"-o", "1.exr", "--float"}),
                                          to({"-o", "2.exr", "--float", "--remove-photographer"}),
                                          to({"-o", "2.jpg", "--remove-photographer"})});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    const Image guessed = read_floats(folder / "2.exr");
    EXPECT_LT(part_off(guessed, Place(7), false),
              0.5 * part_off(read_floats(folder / "1.exr"), Place(7)));
    EXPECT_EQ(guessed.pixel(64, 32)[3], 0);
    EXPECT_GT(guessed.pixel(64, 32)[1], 0.05F);
    // A picture without alpha is whole.
    EXPECT_GT(read_floats(folder / "2.jpg").pixel(64, 32)[1], 0.2F);
    expect_refusal(
        folder, {"convert", "1.exr", "--from", "latlong", "-o", "3.exr", "--remove-photographer"},
        2, {"--remove-photographer", "--from"});
}

TEST(Stitch, GivesTheSameBytesForAnyNumberOfThreads) {
    const TempFolder folder;
    write_pair(folder);
    std::vector<Words> commands;
    for (const char* threads : {"1", "3"}) {
        Words words = stitch({"--threads", threads, "--confidence"});
        words[4] = std::string("env") + threads + ".exr";
        commands.push_back(words);
    }
    for (const Outcome& result : run_all(folder, commands)) ASSERT_EQ(result.status, 0);
    EXPECT_EQ(read_bytes(folder / "env1.exr"), read_bytes(folder / "env3.exr"));
}

TEST(Stitch, SaysWhichViewHasNoBall) {
    const TempFolder folder;
    write_exr(folder / "a.exr", photo(Place(7), {}));
    Image empty({200, 200}, 3);
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 200; ++x)
            std::fill_n(empty.pixel(x, y), 3, 0.1F + 0.001F * static_cast<float>(x));
    write_exr(folder / "nothing.exr", empty);
    expect_refusal(folder,
                   {"stitch", "a.exr", "nothing.exr", "-o", "env.exr", "--ball", kBall, kFar}, 4,
                   {"nothing.exr", "no mirror ball"});
}

TEST(Stitch, RefusesWhatCannotBeMeant) {
    const TempFolder folder;
    write_pair(folder);
    const std::string same = "1,0,0,0,1,0,0,0,1";
    expect_refusal(folder, {"stitch", "-o", "env.exr"}, 2, {"views"});
    expect_refusal(folder, {"stitch", "a.exr", "missing.exr", "-o", "env.exr", "--ball", kBall}, 1,
                   {"missing.exr"});
    expect_refusal(folder, {"stitch", "a.exr", "b.exr", "-o", "b.exr"}, 2, {"b.exr", "input"});
    expect_refusal(folder, stitch({"--camera-to-world", "1,0,0,0,2,0,0,0,1"}), 2,
                   {"--camera-to-world", "no rotation"});
    expect_refusal(
        folder,
        stitch({"--camera-to-world", same, "--camera-to-world", same, "--camera-to-world", same}),
        2, {"--camera-to-world", "3 times", "2 views"});
    expect_refusal(folder, stitch({"--from", "rhombus"}), 2, {"rhombus"});
    expect_refusal(folder, stitch({"--ellipse", "100,100,90,90,0"}), 2, {"a.exr", "--ellipse"});
    expect_refusal(folder, stitch({"--fill", "pattern"}), 2, {"--fill"});
}

}  // namespace
}  // namespace chromeball::test
