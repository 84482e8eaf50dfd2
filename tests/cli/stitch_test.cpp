#include <gtest/gtest.h>

#include <OpenImageIO/imageio.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"
#include "io/read.h"
#include "io/write.h"
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

TEST(Stitch, WarnsOfOppositeSides) {
    const TempFolder folder;
    write_exr(folder / "a.exr", photo(Place(7), {}));
    write_exr(folder / "b.exr", photo(Place(7), Rotation::yaw_pitch_roll(178, 5, 3)));
    const Outcome result = run(folder, stitch({}));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(result.says("warning: a.exr and b.exr are taken from opposite sides"))
        << result.err;
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

/// A lat-long of a place: pixels of direction d are light(d), with the confidence sure(d).
template <class Light, class Sure>
void write_map(const std::string& path, int size, const Light& light, const Sure& sure,
               bool channel) {
    Image map({2 * size, size}, channel ? 4 : 3);
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const V3d d =
                *LatLong().to_direction(V2d((x + 0.5) / map.width(), (y + 0.5) / map.height()));
            const V3d rgb = light(d);
            for (int c = 0; c < 3; ++c) map.pixel(x, y)[c] = static_cast<float>(rgb[c]);
            if (channel) map.pixel(x, y)[3] = static_cast<float>(sure(d));
        }
    WriteOptions options;
    options.full_float = true;
    options.confidence = channel;
    if (path.ends_with(".tif")) options.format = FileFormat::tif;
    write_image(path, map.view(), options);
}

/// The channel's values, as OpenEXR's layouts have them; empty where there is none.
std::vector<float> confidence_in(const std::string& path) {
    const auto photo = read_channel(path, "confidence");
    if (!photo) return {};
    std::vector<float> values(photo->window.size.pixels());
    const auto file = OIIO::ImageInput::open(path);
    const int last = file->spec().nchannels - 1;
    EXPECT_EQ(file->spec().channelnames[static_cast<std::size_t>(last)], "confidence");
    EXPECT_TRUE(file->read_image(0, 0, last, last + 1, OIIO::TypeFloat, values.data()));
    return values;
}

TEST(Confidence, OfMapsIsWhatStitchWeighsThemBy) {
    const TempFolder folder;
    const Place place(7);
    // One map is wrong on one side, and its channel knows.
    const auto wrong = [&](V3d d) { return place(d) * (d.x > 0 ? 4 : 1); };
    const auto knows = [](V3d d) { return d.x > 0 ? 0 : 1; };
    write_map(folder / "good.exr", 64, place, knows, false);
    write_map(folder / "wrong.exr", 64, wrong, knows, true);
    write_map(folder / "proud.exr", 64, wrong, knows, false);
    const std::string same = "1,0,0,0,1,0,0,0,1";
    const auto stitch = [&](const std::string& other, const std::string& out) {
        return Words{"stitch",      other,
                     "good.exr",    "--from",
                     "latlong",     "--size",
                     "64",          "-o",
                     out,           "--camera-to-world",
                     same,          "--camera-to-world",
                     same,          "--float",
                     "--confidence"};
    };
    const auto results =
        run_all(folder, {stitch("wrong.exr", "out.exr"), stitch("proud.exr", "bad.exr")});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_LT(part_off(read_floats(folder / "out.exr"), place), 0.02);
    EXPECT_GT(part_off(read_floats(folder / "bad.exr"), place), 0.2);
}

TEST(Confidence, GoesAlongWhenAMapIsTurnedIntoAnother) {
    const TempFolder folder;
    const auto sure = [](V3d d) { return 0.5 + 0.5 * d.z; };
    write_map(folder / "map.exr", 64, Place(7), sure, true);
    const Words convert{"convert", "map.exr", "--from", "latlong", "--size", "32"};
    const auto to = [&](const Words& more) {
        Words words = convert;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    const auto results =
        run_all(folder, {to({"--layout", "openexr", "--yaw", "90", "-o", "cube.exr"}),
                         to({"--layout", "faces", "-o", "faces"}), to({"-o", "flat.hdr"})});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    const auto cube = confidence_in(folder / "cube.exr");
    ASSERT_EQ(cube.size(), 32U * 6 * 32);
    const auto middle = [&](std::size_t face) { return cube[(face * 32 + 16) * 32 + 16]; };
    EXPECT_NEAR(middle(0), 1, 0.02F);  // +Z is now +X
    EXPECT_NEAR(middle(1), 0, 0.02F);
    EXPECT_NEAR(middle(2), 0.5F, 0.04F);
    // And once more, from six files.
    const Outcome again = run(folder, {"convert", "faces", "--from", "faces", "--size", "16", "-o",
                                       "again.exr", "--float"});
    ASSERT_EQ(again.status, 0) << again.err;
    const auto values = confidence_in(folder / "again.exr");
    ASSERT_EQ(values.size(), 32U * 16);
    EXPECT_NEAR(values[8 * 32 + 16], 1, 0.03F);  // +Z, in the middle
    EXPECT_NEAR(values[8 * 32], 0, 0.03F);
}

TEST(Confidence, OfAMergedPhotoIsKeptByWhatIsMadeOfIt) {
    const TempFolder folder;
    Image light = photo(Place(7), {});
    Image merged(light.size(), 4);
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 200; ++x) {
            std::copy_n(light.pixel(x, y), 3, merged.pixel(x, y));
            const bool burnt = std::hypot(x - 100.0, y - 100.0) < 12;
            merged.pixel(x, y)[3] = burnt ? 0.0F : 1.0F;
        }
    WriteOptions options;
    options.confidence = true;
    write_image(folder / "merged.exr", merged.view(), options);
    const Outcome result = run(folder, {"convert", "merged.exr", "-o", "map.exr", "--ball", kBall,
                                        kFar, "--size", "64", "--confidence"});
    ASSERT_EQ(result.status, 0) << result.err;
    const auto values = confidence_in(folder / "map.exr");
    ASSERT_EQ(values.size(), 128U * 64);
    EXPECT_LT(values[32 * 128 + 64], 0.15F);  // towards the camera: burnt in all exposures
    EXPECT_GT(values[32 * 128 + 84], 0.7F);   // 56 degrees beside it
}

TEST(Confidence, WhatNobodyBelievesInIsNoBlackSpotInAPreview) {
    const TempFolder folder;
    const auto light = [](V3d d) { return d.z > 0.6 ? V3d(0, 0, 0) : V3d(0.5, 0.5, 0.5); };
    const auto sure = [](V3d d) { return d.z > 0.6 ? 0 : 1; };
    write_map(folder / "told.exr", 64, light, sure, true);
    write_map(folder / "silent.exr", 64, light, sure, false);
    const auto preview = [](const std::string& map, const std::string& out) {
        return Words{"preview", map,      "--from", "latlong",   "--mesh", "sphere", "--orbit",
                     "0,0",     "--size", "48",     "--samples", "4",      "-o",     out};
    };
    const auto results =
        run_all(folder, {preview("told.exr", "told-p.exr"), preview("silent.exr", "silent-p.exr")});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    const Image told = read_floats(folder / "told-p.exr"),
                silent = read_floats(folder / "silent-p.exr");
    EXPECT_LT(silent.pixel(24, 24)[1], 0.01F);
    EXPECT_NEAR(told.pixel(24, 24)[1], 0.5F, 0.02F);
    EXPECT_NEAR(told.pixel(34, 24)[1], silent.pixel(34, 24)[1], 0.02F);
}

TEST(Confidence, OfATiffIsAsGoodAsThatOfAnExr) {
    const TempFolder folder;
    const Place place(7);
    const auto wrong = [&](V3d d) { return place(d) * (d.x > 0 ? 4 : 1); };
    const auto knows = [](V3d d) { return d.x > 0 ? 0 : 1; };
    write_map(folder / "good.exr", 64, place, knows, false);
    write_map(folder / "wrong.exr", 64, wrong, knows, true);
    const auto light = [](V3d d) { return d.z > 0.6 ? V3d(0, 0, 0) : V3d(0.5, 0.5, 0.5); };
    const auto sure = [](V3d d) { return d.z > 0.6 ? 0 : 1; };
    write_map(folder / "spot.tif", 64, light, sure, true);
    const Outcome converted =
        run(folder, {"convert", "wrong.exr", "--from", "latlong", "--size", "64", "--output-space",
                     "acescg", "--float", "--confidence", "-o", "wrong.tif"});
    ASSERT_EQ(converted.status, 0) << converted.err;
    const std::string same = "1,0,0,0,1,0,0,0,1";
    const auto results = run_all(
        folder,
        {{"stitch", "wrong.tif", "good.exr", "--from", "latlong", "--size", "64", "-o", "out.exr",
          "--camera-to-world", same, "--camera-to-world", same, "--input-space", "acescg",
          "--float"},
         {"preview", "spot.tif", "--from", "latlong", "--mesh", "sphere", "--orbit", "0,0",
          "--size", "48", "--samples", "4", "-o", "spot-p.exr", "--input-space", "acescg"}});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_LT(part_off(read_floats(folder / "out.exr"), place), 0.02);
    EXPECT_NEAR(read_floats(folder / "spot-p.exr").pixel(24, 24)[1], 0.5F, 0.02F);
}

TEST(Confidence, OfAMergedPhotoOfAnyTypeIsKept) {
    const TempFolder folder;
    Image light = photo(Place(7), {});
    Image merged(light.size(), 4);
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 200; ++x) {
            for (int c = 0; c < 3; ++c)  // no number but the channel says that it is burnt
                merged.pixel(x, y)[c] = std::min(0.9F, light.pixel(x, y)[c]);
            const bool burnt = std::hypot(x - 100.0, y - 100.0) < 12;
            merged.pixel(x, y)[3] = burnt ? 0.0F : 1.0F;
        }
    for (const int bits : {8, 16, 32}) {
        WriteOptions options;
        options.format = FileFormat::tif;
        options.confidence = true;
        options.full_float = bits == 32;
        options.bits = bits == 8 ? 8 : 16;
        write_image(folder / "merged.tif", merged.view(), options);
        const Outcome result = run(folder, {"convert", "merged.tif", "-o", "map.exr", "--ball",
                                            kBall, kFar, "--size", "64", "--confidence"});
        ASSERT_EQ(result.status, 0) << result.err;
        const auto values = confidence_in(folder / "map.exr");
        ASSERT_EQ(values.size(), 128U * 64);
        EXPECT_LT(values[32 * 128 + 64], 0.15F) << bits;
        EXPECT_GT(values[32 * 128 + 84], 0.7F) << bits;
    }
}

TEST(Stitch, DoesNotWarnOfALensThatTheViewsTell) {
    const TempFolder folder;
    const Place place(6);
    const MirrorBall ball = near_ball({200, 200}, V3d(0, 0, -1), 6, 95 * std::sqrt(35.0));
    const auto write = [&](const std::string& name, const Rotation& turn) {
        write_exr(folder / name,
                  ball_view({200, 200}, ball, turn, [&](V3d world, V3d) { return place(world); }));
    };
    write("a.exr", {});
    write("b.exr", kSide);
    const auto results = run_all(
        folder, {{"stitch", "a.exr", "b.exr", "-o", "env.exr", "--ball", "100,100,95", "--ball",
                  "100,100,95", "--size", "32"},
                 {"stitch", "a.exr", "-o", "one.exr", "--ball", "100,100,95", "--size", "32"}});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_FALSE(results[0].says("focal length is not known")) << results[0].err;
    EXPECT_TRUE(results[0].says("--distance-radii 6.0") || results[0].says("--distance-radii 5.9"))
        << results[0].err;
    EXPECT_TRUE(results[1].says("warning: a.exr: the focal length is not known")) << results[1].err;
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
