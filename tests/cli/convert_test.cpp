#include <gtest/gtest.h>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"
#include "io/facts.h"
#include "io/read.h"

// What convert writes: shapes, names, formats, values.

namespace chromeball {
namespace {

using namespace test;

/// What a program sees in the middle of a file: the direction in the camera frame.
struct Middle {
    const char* file;
    V3d direction;
};

/// A folder with the world as a lat-long and as a ball photo.
class Convert : public testing::Test {
protected:
    Convert() {
        write_exr(folder / "world.exr", world_map(latlong, 64));
        write_exr(folder / "ball.exr", ball_photo({160, 160}, distant_ball(80, 80, 72)));
    }

    Outcome convert(const Words& words) const {
        Words all{"convert"};
        all.insert(all.end(), words.begin(), words.end());
        return run(folder, all);
    }
    /// Of world.exr, 32-bit.
    static Words from_world(const std::string& target, const Words& more) {
        Words words{"convert", "world.exr", "--from", "latlong", "-o", target};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    Image read(const std::string& name) const { return read_floats(folder / name); }

    /// Six files in a column.
    Image read_faces(const std::string& prefix, const std::array<std::string_view, 6>& names,
                     const std::string& extension) const {
        Image column;
        for (int face = 0; face < 6; ++face) {
            const Image one =
                read(prefix + std::string(names[static_cast<std::size_t>(face)]) + extension);
            if (face == 0) column = Image({one.width(), 6 * one.width()}, one.channels());
            std::copy_n(one.row(0),
                        static_cast<std::ptrdiff_t>(one.width()) * one.height() * one.channels(),
                        column.row(face * one.width()));
        }
        return column;
    }

    std::string envmap_of(const std::string& name) const {
        const Photo header = read_header(folder / name);
        const Attribute* attribute = header.metadata.find("envmap");
        return attribute ? attribute->text : "none";
    }

    void expect_middles() const {
        // By each program's own documentation; see layouts.cpp for the sources.
        const std::vector<Middle> middles{
            {"opengl/px.exr", {1, 0, 0}},   {"opengl/ny.exr", {0, -1, 0}},
            {"directx/pz.exr", {0, 0, -1}},  // left-handed: its +Z is away from the camera
            {"directx/py.exr", {0, 1, 0}},  {"alias/front.tif", {0, 0, 1}},
            {"alias/right.tif", {1, 0, 0}}, {"blender.exr", {1, 0, 0}},
            {"usd.exr", {0, 0, 1}},         {"unreal.hdr", {0, 0, -1}},
            {"unity.exr", {1, 0, 0}}};
        for (const Middle& middle : middles) {
            const Image map = read(middle.file);
            const float* v = map.pixel(map.width() / 2, map.height() / 2);
            const V3d color = world_color(middle.direction);
            for (int c = 0; c < 3; ++c)
                // 5e-2: the pixel beside the middle of one 32 pixels wide.
                EXPECT_NEAR(v[c], color[c], 5e-2) << middle.file << " channel " << c;
        }
    }

    TempFolder folder;
    const Layout& latlong = *find_layout("latlong");
};

// 6e-3: bilinear lookups in a map 128 pixels around, worst at the poles.
constexpr double kMapTolerance = 6e-3;

TEST_F(Convert, APhotoNeedsNoOtherFlag) {
    const std::string photo = std::string(CHROMEBALL_DATA) + "/photos/interior.jpg";
    const Outcome outcome = convert({photo, "-o", "probe.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    const Image map = read("probe.exr");
    EXPECT_EQ(map.width(), 2 * map.height());
    EXPECT_EQ(map.channels(), 4);
    // What it decided is told in words that ask for the same again.
    for (const std::string text :
         {"--ellipse 90", "--focal-px 2666.67", "--size 256", "latlong", "sRGB texture", "ACEScg"})
        EXPECT_TRUE(outcome.says(text)) << text << "\n" << outcome.err;
    EXPECT_FALSE(outcome.says("warning")) << outcome.err;
    EXPECT_EQ(folder.content(), (std::vector<std::string>{"ball.exr", "probe.exr", "world.exr"}));
    // No absolute path, nor where it lay.
    EXPECT_EQ(read_bytes(folder / "probe.exr").find(CHROMEBALL_DATA), std::string::npos);
    EXPECT_NE(read_bytes(folder / "probe.exr").find("interior.jpg"), std::string::npos);
}

TEST_F(Convert, ABallBecomesItsWorldInEveryLayoutAndAnyOfThemBecomesALatLongAgain) {
    std::vector<Words> there, back, tell;
    for (const Layout& layout : layouts()) {
        const std::string name(layout.name);
        const std::string file = layout.separate_faces ? name : fmt::format("{}.exr", name);
        there.push_back({"convert", "ball.exr", "--ball", "80,80,72", "--orthographic", "--float",
                         "--size", "64", "--layout", name, "-o", file});
        back.push_back({"convert", file, "--from", name, "--float", "--size", "64", "-o",
                        fmt::format("back-{}.exr", name)});
        tell.push_back({"info", file, "--json"});
    }
    const auto written = run_all(folder, there), returned = run_all(folder, back),
               told = run_all(folder, tell);
    for (std::size_t i = 0; i < there.size(); ++i) {
        const Layout& layout = layouts()[i];
        const std::string name(layout.name);
        SCOPED_TRACE(name);
        ASSERT_EQ(written[i].status, 0) << written[i].err;
        const Image map = layout.separate_faces
                              ? read_faces(name + "/", default_face_names(), ".exr")
                              : read(fmt::format("{}.exr", name));
        EXPECT_EQ(map.size(), layout.picture(64));
        const Difference one_way = difference(map, layout, {}, -0.8);
        EXPECT_LT(one_way.worst, 2e-2);    // a ball 144 pixels across
        EXPECT_GT(one_way.covered, 0.96);  // less where a disk's edge runs through pixels
        EXPECT_GT(one_way.compared, 2000U);
        EXPECT_EQ(envmap_of(layout.separate_faces ? name + "/px.exr" : fmt::format("{}.exr", name)),
                  name == "latlong"   ? "latlong"
                  : name == "openexr" ? "cube"
                                      : "none");

        ASSERT_EQ(returned[i].status, 0) << returned[i].err;
        const bool disk = layout.directed_area() < 1;
        const Image again = read(fmt::format("back-{}.exr", name));
        EXPECT_GT(difference(again, latlong).covered, disk ? 0.96 : 0.9999);
        EXPECT_LT(difference(again, latlong, {}, -0.7).worst, 3e-2);

        ASSERT_EQ(told[i].status, 0) << told[i].err;
        EXPECT_EQ(told[i].err, "");
        const auto info = nlohmann::json::parse(told[i].out);
        EXPECT_EQ(info.at("width"), layout.picture(64).width);
        EXPECT_EQ(info.at("height"), layout.picture(64).height);
        EXPECT_EQ(info.at("channels"), 4);
        EXPECT_EQ(info.at("type"), "32-bit floats");
        EXPECT_EQ(info.at("color_space"), "ACEScg");
        EXPECT_EQ(info.at("layout"), name);
        const std::string sureness = info.at("layout_sureness");
        EXPECT_TRUE(sureness == "certain: chromeball wrote it" ||
                    (name == "faces" && sureness == "six files in a folder"))
            << sureness;
        EXPECT_EQ(info.at("provenance").at("source"), "ball.exr");
        EXPECT_EQ(info.at("bad_pixels"), 0);
        // The mean of (d + 1) / 2 is one half, of 4 pi steradians; a disk's rim costs a little.
        EXPECT_NEAR(info.at("covered_steradians"), 4 * std::numbers::pi, disk ? 0.4 : 0.01);
        for (const auto& mean : info.at("mean_radiance")) EXPECT_NEAR(mean, 0.5, 2e-2);
    }
}

TEST_F(Convert, EveryPresetWritesItsOwnFiles) {
    std::vector<Words> commands;
    for (const Preset& preset : presets()) {
        const std::string name(preset.name);
        const bool faces = find_layout(preset.layout)->separate_faces;
        commands.push_back(
            from_world(faces ? name : fmt::format("{}.{}", name, preset.extension),
                       {"--for", name, "--size", "32", "--output-space", "scene_linear"}));
    }
    const auto outcomes = run_all(folder, commands);
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const Preset& preset = presets()[i];
        const Layout& layout = *find_layout(preset.layout);
        const std::string name(preset.name), extension = fmt::format(".{}", preset.extension);
        SCOPED_TRACE(name);
        ASSERT_EQ(outcomes[i].status, 0) << outcomes[i].err;
        const Image map = layout.separate_faces
                              ? read_faces(name + "/", preset.face_names, extension)
                              : read(name + extension);
        EXPECT_EQ(map.size(), layout.picture(32));
        // Half floats, 16 bits, or 8 bits of mantissa in HDR.
        EXPECT_LT(difference(map, layout, preset.axes).worst, kMapTolerance + 4e-3);
    }
    expect_middles();
    EXPECT_EQ(envmap_of("usd.exr"), "latlong");
    EXPECT_EQ(envmap_of("openexr.exr"), "cube");
    EXPECT_EQ(envmap_of("blender.exr"), "none");  // its middle is not +Z
    // Its axes are turned: that is said when it is taken for an ordinary one.
    const Outcome taken = convert({"blender.exr", "--from", "latlong", "-o", "taken.exr"});
    EXPECT_TRUE(taken.says("warning: blender.exr: was written as latlong for blender"))
        << taken.err;
}

TEST_F(Convert, AFolderOfFacesIsAnInput) {
    const std::vector<Words> there{
        from_world("px", {"--layout", "faces", "--size", "32", "--float"}),
        from_world("alias", {"--for", "alias", "--size", "32", "--float"}),
        from_world("png", {"--layout", "faces", "--size", "32", "--format", "png"})};
    for (const Outcome& outcome : run_all(folder, there)) ASSERT_EQ(outcome.status, 0);
    EXPECT_TRUE(exists(folder / "png/nz.png"));
    for (const std::string faces : {"px", "alias", "png"}) {
        const std::string out = faces + "-map.exr";
        const Outcome outcome = convert({faces, "--from", "faces", "--size", "64", "-o", out});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        if (faces != "png") {
            EXPECT_LT(difference(read(out), latlong).worst, 2e-2) << faces;
        }
    }
    // One is missing; one has another size.
    std::filesystem::remove(folder / "px/ny.exr");
    expect_refusal(folder, {"convert", "px", "--from", "faces", "-o", "out.exr"}, 1,
                   {"px: no six faces"});
    std::filesystem::copy(folder / "world.exr", folder / "px/ny.exr");
    expect_refusal(folder, {"convert", "px", "--from", "faces", "-o", "out.exr"}, 1,
                   {"px/ny.exr: 128x64", "square"});
}

TEST_F(Convert, AMapOfTheWrongShapeIsRefused) {
    write_exr(folder / "odd.exr", Image({100, 70}, 3));
    for (const std::string name : {"latlong", "cross-h", "angular"})
        expect_refusal(folder, {"convert", "odd.exr", "--from", name, "-o", "out.exr"}, 1,
                       {"odd.exr", "100x70", "--from"});
}

/// How a file stores its pixels.
struct Stored {
    std::string type;
    int channels;
};
Stored stored(const std::string& path) {
    const auto input = OIIO::ImageInput::open(path);
    if (!input) return {OIIO::geterror(), 0};
    return {input->spec().format.c_str(), input->spec().nchannels};
}

TEST_F(Convert, EveryFormatHasItsUsualDepth) {
    struct Case {
        Words words;
        std::string type;
        int channels;
    };
    const std::vector<Case> cases{{{"a.exr"}, "half", 4},
                                  {{"b.exr", "--float"}, "float", 4},
                                  {{"c.png"}, "uint16", 4},
                                  {{"d.png", "--bits", "8"}, "uint8", 4},
                                  {{"e.tif"}, "uint16", 4},
                                  {{"f.tiff", "--bits", "8"}, "uint8", 4},
                                  {{"g.tif", "--float"}, "float", 4},
                                  {{"h.hdr"}, "float", 3},
                                  {{"i.jpg"}, "uint8", 3},
                                  {{"j.JPEG"}, "uint8", 3},
                                  {{"k.EXR"}, "half", 4}};
    std::vector<Words> commands;
    for (const Case& one : cases)
        commands.push_back(from_world(one.words.front(), {one.words.begin() + 1, one.words.end()}));
    const auto outcomes = run_all(folder, commands);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        ASSERT_EQ(outcomes[i].status, 0) << outcomes[i].err;
        const Stored as = stored(folder / cases[i].words.front());
        EXPECT_EQ(as.type, cases[i].type) << cases[i].words.front();
        EXPECT_EQ(as.channels, cases[i].channels) << cases[i].words.front();
    }
}

TEST_F(Convert, ExrHoldsColourTimesAlphaAndPngPlainColour) {
    const Words ball{"convert",        "ball.exr", "--ball", "40,80,72", "--orthographic",
                     "--output-space", "acescg",   "--size", "64",       "-o"};
    Words exr = ball, png = ball;
    exr.insert(exr.end(), {"a.exr", "--float"});
    png.push_back("a.png");
    for (const Outcome& outcome : run_all(folder, {exr, png})) ASSERT_EQ(outcome.status, 0);
    const Image associated = read("a.exr"), plain = read("a.png");
    ASSERT_EQ(associated.size(), plain.size());
    int partial = 0, empty = 0;
    for (int y = 0; y < plain.height(); ++y)
        for (int x = 0; x < plain.width(); ++x) {
            const float* a = associated.pixel(x, y);
            const float* p = plain.pixel(x, y);
            EXPECT_NEAR(a[3], p[3], 1e-4);
            if (a[3] == 0) {
                ++empty;
                EXPECT_EQ(a[0] + a[1] + a[2] + p[0] + p[1] + p[2], 0);
            }
            if (a[3] < 0.1F || a[3] > 0.9F) continue;
            ++partial;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(a[c] / a[3], std::min(p[c], 1.0F), 1e-3F) << x << " " << y;
        }
    EXPECT_GT(partial, 20);
    EXPECT_GT(empty, 20);
}

TEST_F(Convert, TheSameWordsGiveTheSameBytesWithProvenanceButNoAbsolutePath) {
    std::filesystem::create_directory(folder / "one");
    std::filesystem::create_directory(folder / "two");
    const Words names{"map.exr", "map.png", "map.tif", "map.hdr", "map.jpg"};
    std::vector<Words> commands;
    for (const std::string& name : names)
        for (const std::string run : {"one/", "two/"})
            commands.push_back({"convert", folder / "ball.exr", "--ball", "80,80,72", "-o",
                                folder / (run + name), "--size", "32", "--threads",
                                run == "one/" ? "1" : "2"});
    for (const Outcome& outcome : run_all(folder, commands))
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    for (const std::string& name : names) {
        SCOPED_TRACE(name);
        const std::string bytes = read_bytes(folder / ("one/" + name));
        EXPECT_TRUE(bytes == read_bytes(folder / ("two/" + name)));
        EXPECT_EQ(bytes.find(folder.path()), std::string::npos);
        const auto past = provenance_from(read_header(folder / ("one/" + name)).metadata);
        ASSERT_TRUE(past);
        EXPECT_EQ(past->source, "ball.exr");
        EXPECT_EQ(past->layout, "latlong");
        ASSERT_TRUE(past->outline);
        EXPECT_EQ(past->outline->cx, 80);
        EXPECT_EQ(past->outline->a, 72);
    }
}

TEST_F(Convert, ValuesAboveHalfAreClampedAndCounted) {
    Image bright = world_map(latlong, 32);
    for (int x = 20; x < 30; ++x) bright.pixel(x, 16)[0] = 1e6F;
    write_exr(folder / "sun.exr", bright);
    const Outcome half = convert(
        {"sun.exr", "--from", "latlong", "--size", "32", "--filter", "fast", "-o", "h.exr"});
    ASSERT_EQ(half.status, 0) << half.err;
    EXPECT_TRUE(half.says("warning: h.exr: 10 values")) << half.err;
    EXPECT_TRUE(half.says("65504; --float keeps them")) << half.err;
    EXPECT_EQ(read("h.exr").pixel(25, 16)[0], 65504.0F);
    const Outcome full = convert({"sun.exr", "--from", "latlong", "--size", "32", "--filter",
                                  "fast", "--float", "-o", "f.exr"});
    EXPECT_FALSE(full.says("warning")) << full.err;
    EXPECT_GT(read("f.exr").pixel(25, 16)[0], 9e5F);
}

TEST_F(Convert, ADimMirrorIsMadeUpFor) {
    const Words words{"convert", "ball.exr", "--ball",  "80,80,72", "--orthographic",
                      "--size",  "32",       "--float", "-o"};
    std::vector<Words> commands(3, words);
    commands[0].push_back("whole.exr");
    commands[1].insert(commands[1].end(), {"half.exr", "--reflectance", "0.5"});
    commands[2].insert(commands[2].end(), {"gold.exr", "--reflectance=1,0.8,0.4"});
    for (const Outcome& outcome : run_all(folder, commands)) ASSERT_EQ(outcome.status, 0);
    const Image whole = read("whole.exr"), half = read("half.exr"), gold = read("gold.exr");
    EXPECT_NEAR(half.pixel(20, 10)[1], 2 * whole.pixel(20, 10)[1], 1e-5);
    EXPECT_NEAR(gold.pixel(20, 10)[0], whole.pixel(20, 10)[0], 1e-5);
    EXPECT_NEAR(gold.pixel(20, 10)[2], whole.pixel(20, 10)[2] / 0.4F, 1e-5);
    std::vector<Refusal> cases;
    for (const std::string wrong : {"0", "1.5", "-1", "1,2", "mirror"})
        cases.push_back(
            {{"convert", "ball.exr", "--reflectance", wrong, "-o", "out.exr"}, {"--reflectance"}});
    expect_refusals(folder, cases);
}

TEST_F(Convert, TheFastFilterIsCloseToTheAdaptiveOne) {
    const auto outcomes =
        run_all(folder, {from_world("fast.exr", {"--filter", "fast", "--size", "64", "--float"}),
                         from_world("slow.exr", {"--size", "64", "--float"})});
    for (const Outcome& outcome : outcomes) ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_LT(largest_difference(read("fast.exr"), read("slow.exr")), 3e-2);
    EXPECT_GT(largest_difference(read("fast.exr"), read("slow.exr")), 0);
}

TEST_F(Convert, OpenExrsOwnToolAgreesWithOurColumn) {
    if (run_other(folder, {"exrenvmap", "--help"}).status == 127)
        GTEST_SKIP() << "exrenvmap (Debian package openexr) is not installed";
    ASSERT_EQ(run(folder, from_world("column.exr", {"--for", "openexr", "--size", "64"})).status,
              0);
    const Outcome tool =
        run_other(folder, {"exrenvmap", "-l", "-w", "128", "column.exr", "theirs.exr"});
    ASSERT_EQ(tool.status, 0) << tool.err << tool.out;
    const Image theirs = read("theirs.exr"), ours = read("world.exr");
    ASSERT_EQ(theirs.size(), ours.size());
    double worst = 0;
    for (int y = 0; y < ours.height(); ++y)
        for (int x = 0; x < ours.width(); ++x)
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(static_cast<double>(theirs.pixel(x, y)[c]) -
                                                 ours.pixel(x, y)[c]));
    // The tool puts the centres of edge pixels onto the edges: half a pixel of 2.8 degrees in the
    // lat-long and of 1.4 in the faces, so up to 2.1 degrees or 0.02 in this world.
    EXPECT_LT(worst, 0.03);
    // And the other way: a column of theirs is read as one of ours.
    const Outcome column =
        run_other(folder, {"exrenvmap", "-c", "-w", "64", "world.exr", "their-column.exr"});
    ASSERT_EQ(column.status, 0) << column.err << column.out;
    const Outcome back =
        convert({"their-column.exr", "--from", "openexr", "--size", "64", "-o", "back.exr"});
    ASSERT_EQ(back.status, 0) << back.err;
    EXPECT_LT(difference(read("back.exr"), latlong).worst, 0.04);
}

TEST(Verify, TellsHowFarTheBallPaintedAgainIsFromThePhoto) {
    const TempFolder folder;
    write_exr(folder / "ball.exr", ball_photo({200, 200}, distant_ball(100, 100, 80)));
    const Outcome outcome =
        run(folder, {"convert", "ball.exr", "--ball", "100,100,80", "--orthographic",
                     "--verify-image", "residual.png", "-o", "probe.exr", "--quiet"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    ASSERT_TRUE(outcome.says("stops in the median")) << outcome.err;
    // A smooth world comes back within a few thousandths of a stop.
    const auto at = outcome.err.find("off by ") + 7;
    EXPECT_LT(std::stod(outcome.err.substr(at)), 0.01) << outcome.err;
    const Image residual = read_floats(folder / "residual.png");
    const int middle = residual.width() / 2;
    EXPECT_NEAR(residual.pixel(middle, middle)[0], 0.5, 0.02);  // grey: they agree
    EXPECT_EQ(residual.pixel(0, 0)[0], 0);                      // black: no ball
    expect_refusal(folder, {"convert", "probe.exr", "--from", "latlong", "--verify", "-o", "x.exr"},
                   2, {"--verify", "--from"});
    expect_refusal(folder, {"convert", "ball.exr", "--verify-image", "x.txt", "-o", "x.exr"}, 2,
                   {"x.txt"});
}

}  // namespace
}  // namespace chromeball
