#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"
#include "io/facts.h"
#include "io/read.h"

// Brackets in, one scene-linear photo out.

namespace chromeball {
namespace {

using namespace test;
using nlohmann::json;

const std::string kPhotos = std::string(CHROMEBALL_DATA) + "/photos/";
const std::string kBracket = std::string(CHROMEBALL_DATA) + "/bracket/";

/// 8-bit sRGB JPEG of a linear image times a factor, with exposure tags; time 0: none.
void write_take(const std::string& path, const Image& light, double factor, double time,
                double iso = 100) {
    OIIO::ImageSpec spec(light.width(), light.height(), 3, OIIO::TypeDesc::UINT8);
    spec["CompressionQuality"] = 95;
    if (time > 0) {
        spec["ExposureTime"] = static_cast<float>(time);
        spec["FNumber"] = 8.0f;
        spec["Exif:PhotographicSensitivity"] = static_cast<int>(iso);
    }
    std::vector<float> encoded;
    for (int y = 0; y < light.height(); ++y)
        for (int i = 0; i < light.width() * 3; ++i) {
            const double v = std::clamp(static_cast<double>(light.row(y)[i]) * factor, 0.0, 1.0);
            encoded.push_back(static_cast<float>(
                v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055));
        }
    const auto out = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(out && out->open(path, spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, encoded.data()));
    ASSERT_TRUE(out->close());
}

/// A part of an image, moved.
Image cut(const Image& image, int left, int top, Size size) {
    Image part(size, 3);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            std::copy_n(image.pixel(x + left, y + top), 3, part.pixel(x, y));
    return part;
}

/// The plate in the repository that has a garden's light, at a third of its size: 600 x 340 of it.
const Image& garden() {
    static const Image plate = shrunk(read_floats(kPhotos + "garden.exr"), 3);
    return plate;
}
constexpr Size kSize{600, 340};

/// A bracket of it: a.jpg is 1/400 s, b.jpg 1/50 s, c.jpg 1/6.25 s.
class Merge : public testing::Test {
protected:
    Merge() {
        light = cut(garden(), 20, 10, kSize);
        write("a.jpg", 0, 0, 1.0 / 400);
        write("b.jpg", 0, 0, 1.0 / 50);
        write("c.jpg", 0, 0, 1.0 / 6.25);
    }
    void write(const std::string& name, int dx, int dy, double time, bool tags = true) const {
        write_take(folder / name, cut(garden(), 20 - dx, 10 - dy, kSize), 250 * time,
                   tags ? time : 0);
    }
    Outcome merge(Words words) const {
        words.insert(words.begin(), "merge");
        return run(folder, words);
    }
    /// Median of |log2(merged / light)| less the median of log2: 0 is right up to a factor.
    struct Error {
        double median = 0, scale = 0;
    };
    Error error_of(const std::string& file) const {
        const Image merged = read_floats(folder / file);
        std::vector<double> off;
        for (int y = 20; y < kSize.height - 20; ++y)
            for (int x = 20; x < kSize.width - 20; ++x)
                for (int c = 0; c < 3; ++c) {
                    const auto v = static_cast<double>(light.pixel(x, y)[c]);
                    if (v > 0.005 && v < 1)
                        off.push_back(std::log2(static_cast<double>(merged.pixel(x, y)[c]) / v));
                }
        const auto median = [](std::vector<double>& values) {
            auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
            std::nth_element(values.begin(), middle, values.end());
            return *middle;
        };
        Error error;
        error.scale = median(off);
        for (double& o : off) o = std::abs(o - error.scale);
        error.median = median(off);
        return error;
    }

    TempFolder folder;
    Image light;
};

const Words kLinear{"--output-space", "lin_rec709"};

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST_F(Merge, GivesTheLightUpToTheUnitOfTheMiddleExposure) {
    const Outcome outcome =
        merge(with({"c.jpg", "a.jpg", "b.jpg", "-o", "out.exr", "--json"}, kLinear));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Error error = error_of("out.exr");
    EXPECT_LT(error.median, 0.05);
    EXPECT_NEAR(error.scale, std::log2(250.0 / 50), 0.02);
    const json told = json::parse(outcome.out);
    ASSERT_EQ(told.at("photos").size(), 3U);
    EXPECT_EQ(told.at("photos")[0].at("file"), "c.jpg");
    EXPECT_NEAR(told.at("photos")[0].at("exposure_stops"), 3, 1e-3);
    EXPECT_NEAR(told.at("photos")[1].at("exposure_stops"), -3, 1e-3);
    EXPECT_EQ(told.at("photos")[2].at("exposure_stops"), 0);
    EXPECT_EQ(told.at("photos")[1].at("shift"), json::parse("[0.0, 0.0]"));
    EXPECT_EQ(told.at("response"), "assumed");
    EXPECT_GT(told.at("clipped_everywhere"), 0);  // the sky in the ball
    EXPECT_TRUE(outcome.says("pixels clipped in all exposures")) << outcome.err;
    EXPECT_EQ(folder.content().size(), 4U);
}

TEST_F(Merge, WritesFactsAndConfidence) {
    ASSERT_EQ(merge({"a.jpg", "b.jpg", "c.jpg", "-o", "out.exr", "--float"}).status, 0);
    const Photo photo = read_header(folder / "out.exr");
    EXPECT_EQ(photo.type, PixelType::f32);
    EXPECT_NEAR(*photo.metadata.number("expTime"), 1.0 / 50, 1e-5);  // EXIF has fractions
    EXPECT_NEAR(*photo.metadata.number("aperture"), 8, 1e-6);
    const auto origin = provenance_from(photo.metadata);
    ASSERT_TRUE(origin);
    EXPECT_EQ(origin->source, "a.jpg b.jpg c.jpg");
    const Image merged = read_floats(folder / "out.exr");
    ASSERT_EQ(merged.channels(), 4);  // R, G, B, confidence
    int unsure = 0;
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x) {
            ASSERT_TRUE(merged.pixel(x, y)[3] >= 0 && merged.pixel(x, y)[3] <= 1);
            unsure += merged.pixel(x, y)[3] == 0;
        }
    EXPECT_GT(unsure, 0);
}

TEST_F(Merge, IsTheSameWhateverTheThreads) {
    ASSERT_EQ(merge({"a.jpg", "b.jpg", "c.jpg", "-o", "one.exr", "--threads", "1"}).status, 0);
    ASSERT_EQ(merge({"a.jpg", "b.jpg", "c.jpg", "-o", "four.exr", "--threads", "4"}).status, 0);
    EXPECT_TRUE(read_bytes(folder / "one.exr") == read_bytes(folder / "four.exr"));
}

TEST_F(Merge, SolvesExposuresThatNobodyTells) {
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"})
        write(name, 0, 0, name[0] == 'a' ? 1.0 / 400 : name[0] == 'b' ? 1.0 / 50 : 1 / 6.25, false);
    const Outcome outcome =
        merge(with({"a.jpg", "b.jpg", "c.jpg", "-o", "out.exr", "--json"}, kLinear));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json photos = json::parse(outcome.out).at("photos");
    EXPECT_NEAR(photos[0].at("exposure_stops"), -3, 0.03);
    EXPECT_NEAR(photos[2].at("exposure_stops"), 3, 0.03);
    EXPECT_TRUE(photos[0].at("told_stops").is_null());
    EXPECT_TRUE(outcome.says("b.jpg: no time")) << outcome.err;
    EXPECT_LT(error_of("out.exr").median, 0.05);
}

TEST_F(Merge, NamesAWrongTagAndTheDisagreement) {
    write_take(folder / "b.jpg", light, 5, 1.0 / 12.5);  // two stops less than told
    const Outcome outcome =
        merge(with({"a.jpg", "b.jpg", "c.jpg", "-o", "out.exr", "--json"}, kLinear));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("warning: b.jpg: its exposure as told is +2.0")) << outcome.err;
    const json photos = json::parse(outcome.out).at("photos");
    EXPECT_NEAR(photos[0].at("exposure_stops"), -3, 0.05);
    EXPECT_NEAR(photos[1].at("told_stops"), 2, 0.05);
    EXPECT_LT(error_of("out.exr").median, 0.05);
}

TEST_F(Merge, TakesTimesForTags) {
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"})
        write(name, 0, 0, name[0] == 'a' ? 1.0 / 400 : name[0] == 'b' ? 1.0 / 50 : 1 / 6.25, false);
    const Outcome outcome = merge(with({"a.jpg", "b.jpg", "c.jpg", "--times", "1/400,1/50,0.16",
                                        "--anchor", "c.jpg", "-o", "out.exr", "--json"},
                                       kLinear));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NEAR(json::parse(outcome.out).at("photos")[0].at("exposure_stops"), -6, 1e-3);
    EXPECT_NEAR(error_of("out.exr").scale, std::log2(250 * 0.16), 0.02);
}

TEST_F(Merge, AnAnchorKeepsSeveralBracketsOnOneScale) {
    for (const std::string anchor : {"7.5", "b.jpg"}) {
        ASSERT_EQ(
            merge(with({"a.jpg", "b.jpg", "-o", "one.exr", "--anchor", anchor}, kLinear)).status,
            0);
        ASSERT_EQ(
            merge(with({"b.jpg", "c.jpg", "-o", "two.exr", "--anchor", anchor}, kLinear)).status,
            0);
        EXPECT_NEAR(error_of("one.exr").scale, error_of("two.exr").scale, 0.02) << anchor;
    }
    // EV 7.5 at f/8: 64 / 2^7.5 s fills the scale.
    ASSERT_EQ(merge({"a.jpg", "b.jpg", "-o", "one.exr", "--anchor", "7.5"}).status, 0);
    EXPECT_NEAR(*read_header(folder / "one.exr").metadata.number("expTime"), 64 / std::exp2(7.5),
                1e-4);
    // Without exposures there is no scale to keep.
    write("x.jpg", 0, 0, 1.0 / 400, false);
    write("y.jpg", 0, 0, 1.0 / 50, false);
    expect_refusal(folder, {"merge", "x.jpg", "y.jpg", "-o", "out.exr", "--anchor", "7.5"}, 2,
                   {"--anchor 7.5", "--times"});
}

TEST_F(Merge, LaysABumpedBracketOnItself) {
    write("a.jpg", 4, -3, 1.0 / 400);
    write("c.jpg", -7, 5, 1 / 6.25);
    const Outcome outcome =
        merge(with({"a.jpg", "b.jpg", "c.jpg", "-o", "out.exr", "--json"}, kLinear));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json photos = json::parse(outcome.out).at("photos");
    // Smeared colour and few well exposed pixels: a tenth or two of a pixel.
    EXPECT_NEAR(photos[0].at("shift")[0], 4, 0.2);
    EXPECT_NEAR(photos[0].at("shift")[1], -3, 0.2);
    EXPECT_NEAR(photos[2].at("shift")[0], -7, 0.2);
    EXPECT_NEAR(photos[2].at("shift")[1], 5, 0.2);
    EXPECT_LT(error_of("out.exr").median, 0.06);
}

TEST_F(Merge, ThePhotoWhoseBallIsLostIsLaidOnTheOthersByThePicture) {
    Image covered = cut(garden(), 20 - 3, 10 + 2, kSize);
    for (int y = 60; y < 245; ++y)  // somebody walks through before it
        for (int x = 160; x < 340; ++x) std::fill_n(covered.pixel(x, y), 3, 0.08F);
    write_take(folder / "a.jpg", covered, 250.0 / 400, 1.0 / 400);
    const Outcome outcome =
        merge(with({"a.jpg", "b.jpg", "c.jpg", "-o", "out.exr", "--json"}, kLinear));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(
        outcome.says("a.jpg: its ball is lost; it is laid on the others by the whole "
                     "picture"))
        << outcome.err;
    const json shift = json::parse(outcome.out).at("photos")[0].at("shift");
    EXPECT_NEAR(shift[0], 3, 0.5);
    EXPECT_NEAR(shift[1], -2, 0.5);
}

TEST_F(Merge, APhotoOfSomethingElseIsLeftOut) {
    Image other(kSize, 3);
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x)
            std::fill_n(other.pixel(x, y), 3,
                        0.05F + 0.02F * static_cast<float>((x / 17 * 7 + y / 13 * 5) % 11));
    write_take(folder / "a.jpg", other, 250.0 / 400, 1.0 / 400);
    const Outcome outcome =
        merge(with({"a.jpg", "b.jpg", "c.jpg", "-o", "out.exr", "--json"}, kLinear));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("a.jpg: shows something else than the others; it is left out"))
        << outcome.err;
    const json told = json::parse(outcome.out);
    EXPECT_EQ(told.at("left_out"), json::array({"a.jpg"}));
    ASSERT_EQ(told.at("photos").size(), 2U);
    EXPECT_EQ(told.at("photos")[0].at("file"), "b.jpg");
    EXPECT_LT(told.at("photos")[0].at("moved"), 0.1);
    EXPECT_LT(error_of("out.exr").median, 0.06);
    // Of two nobody can say which is the right one.
    expect_refusal(folder, with({"merge", "a.jpg", "b.jpg", "-o", "none.exr"}, kLinear), 1,
                   {".jpg: shows something else", "exposures of one view"});
}

TEST_F(Merge, TheBracketWhoseBallIsLostInOneExposureIsMerged) {
    // The one in the repository: the ball of the longest exposure is all but clipped.
    const Words words{
        "merge", kBracket + "1.jpg", kBracket + "2.jpg", kBracket + "3.jpg", "-o", "out.exr",
        "--json"};
    const Outcome outcome = run(folder, words);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json photos = json::parse(outcome.out).at("photos");
    EXPECT_NEAR(photos[0].at("shift")[0], 3, 0.1);
    EXPECT_NEAR(photos[0].at("shift")[1], -2, 0.1);
    EXPECT_NEAR(photos[2].at("shift")[0], -4.5, 0.2);
    EXPECT_NEAR(photos[2].at("shift")[1], 2.5, 0.2);
    // And it feeds convert, with the lens that the photos' EXIF tells.
    const Outcome map = run(folder, {"convert", "out.exr", "-o", "probe.exr"});
    ASSERT_EQ(map.status, 0) << map.err;
    EXPECT_TRUE(map.says("--focal-px 933.33 (chromeball)")) << map.err;
    EXPECT_EQ(map.err.find("warning"), std::string::npos) << map.err;
}

TEST_F(Merge, UndoesTheMirrorsTintInsideTheBallAndOnlyOnce) {
    const Words ball{"a.jpg", "b.jpg", "c.jpg", "--ball", "248.1,151.8,73.5", "--float"};
    ASSERT_EQ(merge(with(ball, {"-o", "plain.exr"})).status, 0);
    const Outcome outcome = merge(with(ball, {"--reflectance", "0.8,0.5,0.9", "-o", "undone.exr"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("reflectance is undone inside --ellipse 248.10,151.80"))
        << outcome.err;
    const Image plain = read_floats(folder / "plain.exr"),
                undone = read_floats(folder / "undone.exr");
    const float tint[] = {0.8F, 0.5F, 0.9F};
    for (const auto& [x, y] : {std::pair{248, 151}, {210, 120}, {250, 215}})  // in the ball
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(undone.pixel(x, y)[c] * tint[c] / plain.pixel(x, y)[c], 1, 1e-5);
    for (const auto& [x, y] : {std::pair{20, 20}, {248, 70}, {450, 150}})  // around it
        for (int c = 0; c < 4; ++c) EXPECT_EQ(undone.pixel(x, y)[c], plain.pixel(x, y)[c]);
    EXPECT_EQ(provenance_from(read_header(folder / "undone.exr").metadata)->reflectance,
              "0.8,0.5,0.9");

    // What is made of it must not have that done again.
    const Words once{"--ball", "248.1,151.8,73.5", "--size", "64"};
    ASSERT_EQ(run(folder, with({"convert", "undone.exr", "-o", "map.exr"}, once)).status, 0);
    expect_refusal(
        folder,
        with({"convert", "undone.exr", "-o", "map.exr", "--reflectance", "0.8,0.5,0.9"}, once), 2,
        {"undone.exr", "0.8,0.5,0.9", "undone already", "leave --reflectance out"});
    ASSERT_EQ(
        run(folder, {"detect", "undone.exr", "--near", "248,152", "--crop", "crop.exr"}).status, 0);
    expect_refusal(folder,
                   {"convert", "crop.exr", "--cropped", "-o", "map.exr", "--reflectance", "0.8"}, 2,
                   {"crop.exr", "undone already"});
}

TEST_F(Merge, CannotUndoATintWithoutABall) {
    Image ramp({200, 100}, 3);
    for (int y = 0; y < 100; ++y)
        for (int i = 0; i < 600; ++i) ramp.row(y)[i] = 0.02F + 0.002F * static_cast<float>(i / 3);
    write_take(folder / "r1.jpg", ramp, 1, 0.01);
    write_take(folder / "r2.jpg", ramp, 2, 0.02);
    expect_refusal(folder,
                   {"merge", "r1.jpg", "r2.jpg", "--quiet", "--reflectance", "0.8", "-o", "x.exr"},
                   4, {"--reflectance 0.8", "no mirror ball", "--ball", "convert"});
}

TEST_F(Merge, LinearExrsMergeLinearly) {
    const auto write_linear = [&](const std::string& name, double factor, double time) {
        Image take = light;
        for (int y = 0; y < take.height(); ++y)
            for (int i = 0; i < take.width() * 3; ++i)
                take.row(y)[i] =
                    std::min(1.0f, std::max(0.0f, take.row(y)[i] * static_cast<float>(factor)));
        Metadata facts;
        facts.set({"expTime", "float", {time}, {}});
        write_exr(folder / name, take, facts);
    };
    write_linear("a.exr", 0.02, 1.0 / 1000);
    write_linear("b.exr", 0.5, 1.0 / 40);
    const Outcome outcome = merge({"a.exr", "b.exr", "--input-space", "lin_rec709", "-o", "out.exr",
                                   "--float", "--json", "--output-space", "lin_rec709"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(json::parse(outcome.out).at("response"), "linear");
    const Error error = error_of("out.exr");
    EXPECT_LT(error.median, 1e-4);
    EXPECT_NEAR(error.scale, std::log2(0.02), 1e-4);
}

TEST_F(Merge, PhotosThatAreTheSameAreAveragedAndToldOf) {
    std::filesystem::copy_file(folder / "b.jpg", folder / "again.jpg");
    const Outcome outcome = merge(with({"b.jpg", "again.jpg", "-o", "out.exr"}, kLinear));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("exposed alike")) << outcome.err;
    EXPECT_LT(error_of("out.exr").median, 0.05);
}

TEST_F(Merge, QuietSaysNothingButWarnings) {
    const Outcome outcome = merge({"a.jpg", "b.jpg", "c.jpg", "-o", "out.exr", "--quiet"});
    ASSERT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.lines_with("warning: "), outcome.lines_with("")) << outcome.err;
    EXPECT_EQ(outcome.out, "");
}

TEST_F(Merge, RefusesWhatIsTypedWrong) {
    write_bytes(folder / "out.exr", "precious");
    expect_refusals(
        folder,
        {{{"merge", "a.jpg", "-o", "out.exr"}, {"a.jpg", "one photo", "convert"}},
         {{"merge", "a.jpg", "a.jpg", "-o", "out.exr"}, {"a.jpg", "twice"}},
         {{"merge", "a.jpg", "b.jpg", "-o", "out.png"}, {"out.png", ".exr"}},
         {{"merge", "a.jpg", "b.jpg", "-o", "out.tif"}, {"out.tif", "--float"}},
         {{"merge", "a.jpg", "b.jpg", "-o", "a.jpg"}, {"a.jpg"}},
         {{"merge", "a.jpg", "b.jpg", "--times", "1/4", "-o", "out.exr"}, {"--times", "1", "2"}},
         {{"merge", "a.jpg", "b.jpg", "--times", "1/4,0", "-o", "out.exr"}, {"--times", "\"0\""}},
         {{"merge", "a.jpg", "b.jpg", "--times", "1/4,x", "-o", "out.exr"}, {"--times", "\"x\""}},
         {{"merge", "a.jpg", "b.jpg", "--response", "agfa", "-o", "out.exr"}, {"--response"}},
         {{"merge", "a.jpg", "b.jpg", "--ball", "1,2", "-o", "out.exr"}, {"--ball"}},
         {{"merge", "a.jpg", "b.jpg", "--output-space", "srgb_texture", "-o", "out.exr"},
          {"--output-space", "linear"}},
         {{"merge", "a.jpg", "b.jpg", "--reflectance", "1.5", "-o", "out.exr"},
          {"--reflectance 1.5"}}});
}

TEST_F(Merge, RefusesPhotosThatDoNotGoTogether) {
    write_bytes(folder / "out.exr", "precious");
    write_take(folder / "small.jpg", cut(garden(), 0, 0, {300, 170}), 5, 0.02);
    write_take(folder / "turned.jpg", cut(garden(), 0, 0, {340, 300}), 5, 0.02);
    write_take(folder / "portrait.jpg", cut(garden(), 0, 0, {300, 340}), 5, 0.02);
    write_exr(folder / "linear.exr", light);
    expect_refusal(folder, {"merge", "a.jpg", "small.jpg", "-o", "out.exr"}, 1,
                   {"small.jpg", "300x170", "600x340", "one size"});
    expect_refusal(folder, {"merge", "turned.jpg", "portrait.jpg", "-o", "out.exr"}, 1,
                   {"portrait.jpg", "300x340"});
    expect_refusal(folder, {"merge", "a.jpg", "linear.exr", "-o", "out.exr"}, 1,
                   {"linear.exr", "one kind"});
    expect_refusal(folder, {"merge", "a.jpg", "gone.jpg", "-o", "out.exr"}, 1,
                   {"gone.jpg", "no such file"});
}

TEST_F(Merge, RefusesAPortraitAmongLandscapes) {
    write_take(folder / "wide.jpg", cut(garden(), 0, 0, {300, 200}), 5, 0.02);
    write_take(folder / "high.jpg", cut(garden(), 0, 0, {200, 300}), 5, 0.02);
    expect_refusal(folder, {"merge", "wide.jpg", "high.jpg", "-o", "out.exr"}, 1,
                   {"high.jpg", "200x300", "turned"});
}

TEST_F(Merge, RefusesBracketsThatAllClipOrAreAllBlack) {
    Image white({200, 100}, 3), black({200, 100}, 3);
    for (int y = 0; y < 100; ++y) std::fill_n(white.row(y), 600, 50.0f);
    write_take(folder / "w1.jpg", white, 1, 0.01);
    write_take(folder / "w2.jpg", white, 1, 0.1);
    write_take(folder / "k1.jpg", black, 1, 0.01);
    write_take(folder / "k2.jpg", black, 1, 0.1);
    write_take(folder / "u1.jpg", white, 1, 0);
    write_take(folder / "u2.jpg", white, 1, 0);
    expect_refusal(folder, {"merge", "w1.jpg", "w2.jpg", "--quiet", "-o", "out.exr"}, 1,
                   {"out.exr", "clipped in all", "shorter"});
    expect_refusal(folder, {"merge", "k1.jpg", "k2.jpg", "--quiet", "-o", "out.exr"}, 1,
                   {"out.exr", "black in all", "longer"});
    // Without exposures nothing can be solved from white.
    expect_refusal(folder, {"merge", "u1.jpg", "u2.jpg", "--quiet", "-o", "out.exr"}, 1,
                   {"--times"});
}

}  // namespace
}  // namespace chromeball
