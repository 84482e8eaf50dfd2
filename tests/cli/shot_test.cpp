#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"
#include "detect/painted.h"
#include "io/facts.h"
#include "io/read.h"
#include "io/write.h"

// The command shot on a small plate: a ball that drifts through 320 x 180 pixels.

namespace chromeball::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kFirst = 1005, kLast = 1012;  // 1008 is a key frame, 1005 the first of its block
constexpr double kFocal = 420;

painted::Scene scene(int frame) {
    painted::Scene s;
    s.size = {320, 180};
    s.camera = {kFocal, V2d(160, 90)};
    const double t = frame - kFirst;
    s.centre = V3d(-1.2 + 0.12 * t, 0.3 - 0.04 * t * t / 4, -10 + 0.1 * t);
    return s;
}

std::string plate_name(int frame) { return fmt::format("plate.{}.exr", frame); }

/// The plates as EXRs, painted once for all tests.
const std::map<int, std::string>& plates() {
    static const std::map<int, std::string> painted = [] {
        const TempFolder folder;
        std::map<int, std::string> bytes;
        for (int frame = kFirst; frame <= kLast; ++frame) {
            const painted::Scene s = scene(frame);
            Image image(s.size, 3);
            const auto light = s.light();
            std::copy(light.begin(), light.end(), image.row(0));
            write_exr(folder / "p.exr", image);
            bytes[frame] = read_bytes(folder / "p.exr");
        }
        return bytes;
    }();
    return painted;
}

void put_plates(const TempFolder& folder) {
    for (const auto& [frame, bytes] : plates()) write_bytes(folder / plate_name(frame), bytes);
}

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// `shot` into a folder, with what all of these tests ask for unless they ask for something else.
Words shot(const std::string& out, const Words& more = {}) {
    Words words = {"shot",       "plate.####.exr",         "-o", out + "/probe.####.exr",
                   "--focal-px", fmt::format("{}", kFocal)};
    const Words usual[] = {{"--size", "16"}, {"--jobs", "2"}, {"--quiet"}};
    for (const Words& one : usual)
        if (std::find(more.begin(), more.end(), one.front()) == more.end())
            words = with(words, one);
    return with(words, more);
}

void make(const TempFolder& folder, const std::string& name) {
    fs::create_directory(folder / name);
}

/// The results of a run by frame; nothing of a frame that has none.
std::map<int, std::string> results(const TempFolder& folder, const std::string& out) {
    std::map<int, std::string> files;
    for (int frame = kFirst; frame <= kLast; ++frame) {
        const std::string file = folder / fmt::format("{}/probe.{}.exr", out, frame);
        if (exists(file)) files[frame] = read_bytes(file);
    }
    return files;
}

/// What a plain run makes, once for all tests.
const std::map<int, std::string>& expected() {
    static const std::map<int, std::string> made = [] {
        const TempFolder folder;
        put_plates(folder);
        make(folder, "out");
        EXPECT_EQ(run(folder, shot("out")).status, 0);
        return results(folder, "out");
    }();
    return made;
}

Json report_in(const TempFolder& folder, const std::string& name) {
    return Json::parse(read_bytes(folder / name));
}

std::map<int, std::string> outcomes(const Json& report) {
    std::map<int, std::string> all;
    for (const Json& frame : report.at("frames")) all[frame.at("frame")] = frame.at("outcome");
    return all;
}

std::size_t written_in(const Json& report) {
    const Json& summary = report.at("summary");
    return summary.at("found").get<std::size_t>() + summary.at("filled").get<std::size_t>();
}

/// What lies in a folder besides the stages' files.
std::vector<std::string> visible(const TempFolder& folder, const std::string& out) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder / out))
        if (entry.path().filename() != ".chromeball")
            names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

TEST(Shot, FindsTheBallInEveryFrameAndTellsOfIt) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    const Outcome outcome =
        run(folder, shot("out", {"--report", "r.json", "--report", "r.html", "--jobs", "1"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(results(folder, "out"), expected());  // whatever the jobs
    EXPECT_EQ(visible(folder, "out").size(), plates().size());

    const Json report = report_in(folder, "r.json");
    EXPECT_EQ(report.at("frames").size(), plates().size());
    EXPECT_EQ(written_in(report), plates().size());
    EXPECT_EQ(report.at("settings").at("layout"), "latlong");
    for (const Json& frame : report.at("frames")) {
        const Json& o = frame.at("outline");
        const Outline seen{o.at("cx"), o.at("cy"), o.at("a"), o.at("b"), o.at("angle")};
        // 2.5: so small a ball before such a street is seen to a pixel or two; see tests/detect.
        EXPECT_LT(rim_deviation(seen, scene(frame.at("frame")).outline()), 2.5) << frame;
        EXPECT_GT(frame.at("seconds"), 0);
    }
    const std::string page = read_bytes(folder / "r.html");
    EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
    EXPECT_NE(page.find("1008"), std::string::npos);
}

TEST(Shot, GivesTheSameBytesFromStagesAndParts) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    for (const char* part : {"1010-1012", "1005-1007", "1008,1009"})
        EXPECT_EQ(run(folder, shot("out", {"--stage", "track", "--frames", part})).status, 0);
    EXPECT_TRUE(results(folder, "out").empty());
    EXPECT_EQ(run(folder, shot("out", {"--stage", "solve"})).status, 0);
    for (const char* part : {"1007-1012", "1005,1006"})
        EXPECT_EQ(run(folder, shot("out", {"--stage", "convert", "--frames", part})).status, 0);
    EXPECT_EQ(results(folder, "out"), expected());
    EXPECT_EQ(run(folder, shot("out", {"--stage", "report", "--report", "r.json"})).status, 0);
    EXPECT_EQ(written_in(report_in(folder, "r.json")), plates().size());
}

/// The records of the stage track by frame, without what differs from run to run.
std::map<int, Json> tracked(const TempFolder& folder, const std::string& out) {
    std::map<int, Json> records;
    for (const auto& file : fs::recursive_directory_iterator(folder / (out + "/.chromeball"))) {
        if (file.path().parent_path().filename() != "track") continue;
        std::istringstream lines(read_bytes(file.path().string()));
        for (std::string line; std::getline(lines, line);) {
            Json record = Json::parse(line);
            record.erase("seconds");
            records[record.at("frame")] = record;
        }
    }
    return records;
}

TEST(Shot, TracksTheSameFromFurtherKeyFramesWhateverTheParts) {
    const TempFolder folder;
    // Nothing but a grey plate in the key frame 1024; none is behind that of 1040.
    for (const int frame : {1008, 1024, 1025, 1039, 1040, 1041, 1047}) {
        painted::Scene s = scene(kFirst);
        s.centre += V3d(0.015, 0.005, 0) * (frame - 1008);
        Image image(s.size, 3);
        const auto light = s.light();
        if (frame == 1024)
            std::fill_n(image.row(0), light.size(), 0.2f);
        else
            std::copy(light.begin(), light.end(), image.row(0));
        write_exr(folder / plate_name(frame), image);
    }
    make(folder, "whole");
    make(folder, "parts");
    ASSERT_EQ(run(folder, shot("whole", {"--stage", "track"})).status, 0);
    for (const char* part : {"1047", "1025", "1041", "1008,1024,1039,1040"})
        ASSERT_EQ(run(folder, shot("parts", {"--stage", "track", "--frames", part})).status, 0);
    const auto whole = tracked(folder, "whole");
    EXPECT_EQ(whole, tracked(folder, "parts"));
    ASSERT_EQ(whole.size(), 7u);
    for (const auto& [frame, record] : whole)
        EXPECT_EQ(record.contains("ball") && record.at("ball").at("sure") == true, frame != 1024)
            << frame;
}

TEST(Shot, AsksForTheStagesBefore) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    const Outcome outcome = run(folder, shot("out", {"--stage", "convert"}));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.says("run --stage solve first")) << outcome.err;
}

TEST(Shot, DoesOnlyWhatIsNotThereOrNotRight) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    ASSERT_EQ(run(folder, shot("out")).status, 0);
    const auto dates = [&] {
        std::map<std::string, fs::file_time_type> all;
        for (const std::string& name : visible(folder, "out"))
            all[name] = fs::last_write_time(folder / ("out/" + name));
        return all;
    };
    const auto before = dates();
    fs::remove(folder / "out/probe.1006.exr");
    const std::string torn = expected().at(1009);
    write_bytes(folder / "out/probe.1009.exr", torn.substr(0, torn.size() / 2));
    write_bytes(folder / "out/.probe.1010.exr.part", "left behind");
    ASSERT_EQ(run(folder, shot("out")).status, 0);
    EXPECT_EQ(results(folder, "out"), expected());
    EXPECT_EQ(visible(folder, "out").size(), plates().size());  // no leftover either
    for (const auto& [name, date] : dates())
        EXPECT_EQ(date == before.at(name), name != "probe.1006.exr" && name != "probe.1009.exr")
            << name;

    // Another setting makes all of them anew, and --overwrite does in any case.
    ASSERT_EQ(run(folder, shot("out", {"--yaw", "90"})).status, 0);
    EXPECT_NE(results(folder, "out").at(1005), expected().at(1005));
    ASSERT_EQ(run(folder, shot("out")).status, 0);
    EXPECT_EQ(results(folder, "out"), expected());
    const auto then = dates();
    ASSERT_EQ(run(folder, shot("out", {"--overwrite"})).status, 0);
    for (const auto& [name, date] : dates()) EXPECT_NE(date, then.at(name));
    EXPECT_EQ(results(folder, "out"), expected());
}

TEST(Shot, GoesOnAfterBeingKilled) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    for (const int milliseconds : {60, 150, 300, 450, 700, 1000}) {
        Running running(folder, shot("out"));
        std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        running.signal(SIGKILL);
        running.wait();
    }
    ASSERT_EQ(run(folder, shot("out")).status, 0);
    EXPECT_EQ(results(folder, "out"), expected());
    EXPECT_EQ(visible(folder, "out").size(), plates().size());
}

TEST(Shot, StopsWhenInterruptedAndGoesOn) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    Words words = shot("out");
    std::erase(words, "--quiet");
    Running running(folder, words);
    while (!running.ended() && running.said().find("tracking: ") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    running.signal(SIGINT);
    EXPECT_EQ(running.wait().status, 130);
    ASSERT_EQ(run(folder, shot("out")).status, 0);
    EXPECT_EQ(results(folder, "out"), expected());
}

TEST(Shot, WritesPicturesAnewThatWereCutOff) {
    const TempFolder folder;
    put_plates(folder);
    for (const std::string kind : {"png", "jpg"}) {
        make(folder, kind);
        Words words = shot(kind, {"--size", "64", "--frames", "1005-1008"});
        *std::next(std::find(words.begin(), words.end(), "-o")) = kind + "/probe.####." + kind;
        ASSERT_EQ(run(folder, words).status, 0);
        const auto file = [&](int frame) {
            return folder / fmt::format("{}/probe.{}.{}", kind, frame, kind);
        };
        const std::string whole = read_bytes(file(1006));
        write_bytes(file(1006), whole.substr(0, whole.size() * 3 / 4));
        ASSERT_EQ(run(folder, words).status, 0);
        EXPECT_TRUE(read_bytes(file(1006)) == whole) << kind;
    }
}

TEST(Shot, WritesTheOthersWhenFramesAreBroken) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    const std::string whole = plates().at(1007);
    write_bytes(folder / plate_name(1007), whole.substr(0, whole.size() * 9 / 10));
    write_bytes(folder / plate_name(1009), "");
    write_bytes(folder / plate_name(1012), "no picture at all");
    fs::remove(folder / plate_name(1010));
    const Outcome outcome =
        run(folder, shot("out", {"--frames", "1005-1012", "--report", "r.json"}));
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.lines_with("error"), 1U) << outcome.err;
    EXPECT_TRUE(outcome.says("4 of 8 frames were not written: 1007,1009-1010,1012")) << outcome.err;
    const auto told = outcomes(report_in(folder, "r.json"));
    EXPECT_EQ(told.at(1007), "failed");
    EXPECT_EQ(told.at(1009), "failed");
    EXPECT_EQ(told.at(1010), "missing");
    EXPECT_EQ(told.at(1012), "failed");
    const auto written = results(folder, "out");
    for (const int frame : {1005, 1006, 1008, 1011}) EXPECT_TRUE(written.contains(frame));
    EXPECT_EQ(written.size(), 4U);
    EXPECT_EQ(visible(folder, "out").size(), 4U);

    // Mended plates are taken up by a rerun.
    put_plates(folder);
    ASSERT_EQ(run(folder, shot("out", {"--frames", "1005-1012"})).status, 0);
    EXPECT_EQ(results(folder, "out"), expected());
}

TEST(Shot, HoldsSkipsOrInterpolatesFramesWithoutABall) {
    const TempFolder folder;
    put_plates(folder);
    const Image grey({320, 180}, 3);
    write_exr(folder / plate_name(1008), grey);  // a key frame, too
    const auto outline_of = [](const Json& report, int frame) {
        return report.at("frames").at(static_cast<std::size_t>(frame - kFirst)).at("outline");
    };
    make(folder, "held");
    ASSERT_EQ(run(folder, shot("held", {"--report", "h.json"})).status, 0);
    const Json held = report_in(folder, "h.json");
    EXPECT_EQ(outcomes(held).at(1008), "held");
    EXPECT_NEAR(outline_of(held, 1008).at("cx"), outline_of(held, 1007).at("cx"), 0.5);
    EXPECT_TRUE(results(folder, "held").contains(1008));

    make(folder, "filled");
    ASSERT_EQ(run(folder, shot("filled", {"--report", "f.json", "--missing=interpolate"})).status,
              0);
    const Json filled = report_in(folder, "f.json");
    EXPECT_EQ(outcomes(filled).at(1008), "filled");
    // The ball moves 5 pixels a frame.
    EXPECT_NEAR(outline_of(filled, 1008).at("cx"), scene(1008).outline().cx, 1);

    make(folder, "skipped");
    EXPECT_EQ(run(folder, shot("skipped", {"--report", "s.json", "--missing", "skip"})).status, 3);
    EXPECT_EQ(outcomes(report_in(folder, "s.json")).at(1008), "missing");
    EXPECT_EQ(results(folder, "skipped").size(), plates().size() - 1);
}

/// `shot` that puts an object into the plates, too.
Words insert(const std::string& out, const std::string& mesh, const Words& more = {}) {
    return shot(
        out, with({"--insert", mesh, "--insert-output", out + "/comp.####.exr", "--samples", "4"},
                  more));
}

std::string comp(const TempFolder& folder, int frame) {
    return folder / fmt::format("out/comp.{}.exr", frame);
}

/// A box around the ball's middle, in ball radii, open to all sides of the ball.
std::string box(double half_width, double half_height) {
    std::string text;
    for (int i = 0; i < 8; ++i)
        text += fmt::format("v {} {} {}\n", i & 1 ? half_width : -half_width,
                            i & 2 ? half_height : -half_height, i & 4 ? 0.5 : -0.5);
    return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

/// Mean differences of x / (1 + x) between a picture and the plate: within so many radii of the
/// ball, and outside of it.
struct Differences {
    double inside = 0, outside = 0;
};
Differences differences(const TempFolder& folder, int frame) {
    const Image a = read_floats(comp(folder, frame)), b = read_floats(folder / plate_name(frame));
    const Outline ball = scene(frame).outline();
    Differences sum;
    int inside = 0, outside = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x) {
            const double r = std::hypot(x + 0.5 - ball.cx, y + 0.5 - ball.cy) / ball.a;
            if (r > 0.9 && r < 1.15) continue;  // a pixel or two of the rim
            double off = 0;
            for (int c = 0; c < 3; ++c) {
                const auto u = static_cast<double>(a.pixel(x, y)[c]);
                const auto v = static_cast<double>(b.pixel(x, y)[c]);
                off += std::abs(u / (1 + u) - v / (1 + v)) / 3;
            }
            (r < 1 ? sum.inside : sum.outside) += off;
            ++(r < 1 ? inside : outside);
        }
    return {sum.inside / inside, sum.outside / outside};
}

TEST(Shot, PutsAMirrorInTheBallsPlaceThatLooksLikeIt) {
    // The same pictures, but for resampling: a mirrored, turned or misplaced object is far off.
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    const Outcome outcome = run(folder, insert("out", "sphere"));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(results(folder, "out"), expected());  // the maps are what they are without it
    for (const int frame : {1005, 1009, 1012}) {
        const Differences off = differences(folder, frame);
        EXPECT_LT(off.inside, 0.03) << frame;
        EXPECT_LT(off.outside, 1e-3) << frame;  // half floats
    }
    const std::string one = read_bytes(comp(folder, 1010));
    ASSERT_EQ(run(folder, insert("out", "sphere", {"--overwrite", "--jobs", "1"})).status, 0);
    EXPECT_EQ(read_bytes(comp(folder, 1010)), one);
}

TEST(Shot, PutsAnAnimatedObjectIntoThePlatesFrameByFrame) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    for (int frame = kFirst; frame <= kLast; ++frame)
        write_bytes(folder / fmt::format("box.{}.obj", frame),
                    box(1.2 + 0.1 * (frame - kFirst), 1.2));
    fs::remove(folder / "box.1007.obj");
    const Words words = insert("out", "box.####.obj", {"--material", "diffuse"});
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.status, 3);
    EXPECT_TRUE(outcome.says("box.1007.obj")) << outcome.err;
    EXPECT_EQ(results(folder, "out"), expected());  // its map can be made
    EXPECT_FALSE(exists(comp(folder, 1007)));

    // What is mended or changed is made, the rest stays.
    std::map<int, fs::file_time_type> dates;
    for (const int frame : {1005, 1006, 1008, 1012})
        dates[frame] = fs::last_write_time(comp(folder, frame));
    write_bytes(folder / "box.1007.obj", box(1.4, 1.2));
    write_bytes(folder / "box.1008.obj", box(2, 1.2));
    ASSERT_EQ(run(folder, words).status, 0);
    EXPECT_TRUE(exists(comp(folder, 1007)));
    for (const auto& [frame, date] : dates)
        EXPECT_EQ(fs::last_write_time(comp(folder, frame)) == date, frame != 1008) << frame;
    // Other settings, other pictures; the maps stay.
    const std::string before = read_bytes(comp(folder, 1005));
    const auto map = fs::last_write_time(folder / "out/probe.1005.exr");
    ASSERT_EQ(run(folder, with(words, {"--scale", "0.5", "--patch"})).status, 0);
    EXPECT_NE(read_bytes(comp(folder, 1005)), before);
    EXPECT_EQ(fs::last_write_time(folder / "out/probe.1005.exr"), map);
}

TEST(Shot, MakesPicturesAnewWhoseObjectsPointsChanged) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    const auto points = [](float size) {
        const float corners[9] = {-size, -size, 0, size, -size, 0, 0, size, 0};
        return std::string(reinterpret_cast<const char*>(corners), sizeof corners);
    };
    write_bytes(folder / "leaf.bin", points(1));
    write_bytes(
        folder / "leaf.gltf",
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
                          "min":[-9,-9,0],"max":[9,9,0]}],
            "bufferViews":[{"buffer":0,"byteLength":36}],
            "buffers":[{"uri":"leaf.bin","byteLength":36}]})");
    // A pattern: in its own units.
    for (const auto& [frame, plate] : plates())
        fs::copy_file(folder / "leaf.gltf", folder / fmt::format("leaf.{}.gltf", frame));
    const Words words = insert("out", "leaf.####.gltf");
    ASSERT_EQ(run(folder, words).status, 0);
    const std::string small = read_bytes(comp(folder, 1005));
    write_bytes(folder / "leaf.bin", points(2));
    ASSERT_EQ(run(folder, words).status, 0);
    EXPECT_NE(read_bytes(comp(folder, 1005)), small);
}

TEST(Shot, RefusesObjectsThatHaveNoPlace) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    const std::pair<Words, std::string> wrong[] = {
        {{"--insert", "bean"}, "--insert-output"},
        {{"--insert", "bean", "--insert-output", "out/comp.exr"}, "place for the frame's number"},
        {{"--insert", "bean", "--insert-output", "out/probe.####.exr"}, "would replace the maps"},
        {{"--insert", "bean", "--insert-output", "plate.####.exr"}, "plate"},
        {{"--insert", "bena", "--insert-output", "out/c.####.exr"}, "bean"},
        {{"--insert", "bean", "--insert-output", "out/c.####.exr", "--material", "gold?"}, "gold"},
        {{"--patch"}, "--insert"}};
    for (const auto& [words, said] : wrong) {
        const Outcome outcome = run(folder, shot("out", words));
        EXPECT_EQ(outcome.status, 2) << text_of(words) << outcome.err;
        EXPECT_TRUE(outcome.says(said)) << text_of(words) << outcome.err;
    }
    EXPECT_TRUE(visible(folder, "out").empty());
}

TEST(Shot, TakesKeysForGranted) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    const Outline truth = scene(1008).outline();
    // The axes of an ellipse in either order.
    const auto solved = [&](const std::string& key) {
        EXPECT_EQ(run(folder, shot("out", {"--key", key, "--stage", "track"})).status, 0);
        EXPECT_EQ(run(folder, shot("out", {"--key", key, "--stage", "solve"})).status, 0);
        const Outcome told =
            run(folder, shot("out", {"--key", key, "--stage", "report", "--report", "k.json"}));
        EXPECT_EQ(told.status, 1);  // nothing is converted yet
        return report_in(folder, "k.json").at("frames").at(1008 - kFirst).at("outline");
    };
    const auto place = fmt::format("1008:{:.3f},{:.3f},", truth.cx + 2, truth.cy);
    const Json long_first = solved(place + "34,30,20"), short_first = solved(place + "30,34,110");
    EXPECT_EQ(long_first, short_first);
    EXPECT_NEAR(long_first.at("cx"), truth.cx + 2, 0.3);
    const Outcome lost = run(folder, shot("out", {"--key", "2000:1,2,3", "--stage", "solve"}));
    EXPECT_TRUE(lost.says("--key 2000: the frame is none of the shot's, 1005-1012")) << lost.err;
}

TEST(Shot, TakesTheLensFromTheOutlinesWhereNobodyTellsIt) {
    const TempFolder folder;
    make(folder, "out");
    painted::Scene s;
    s.camera.focal = 520;
    for (int frame = 1; frame <= 3; ++frame) {
        s.centre = V3d(2.5 + 0.05 * frame, 1.5, -7);
        Image image(s.size, 3);
        const auto light = s.light();
        std::copy(light.begin(), light.end(), image.row(0));
        write_exr(folder / fmt::format("plate.{:04}.exr", frame), image);
    }
    const Words words = {"shot", "plate.####.exr", "-o", "out/probe.####.exr", "--size",
                         "16",   "--jobs",         "2"};
    const Outcome outcome = run(folder, words);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.lines_with("warning"), 1U) << outcome.err;
    EXPECT_TRUE(outcome.says("plate.####.exr: the focal length is not known")) << outcome.err;
    // All frames get the same one.
    std::vector<std::optional<double>> focals;
    for (int frame = 1; frame <= 3; ++frame) {
        const Photo map = read_header(folder / fmt::format("out/probe.{:04}.exr", frame));
        const auto origin = provenance_from(map.metadata);
        ASSERT_TRUE(origin && origin->camera && origin->camera->focal);
        focals.push_back(origin->camera->focal);
    }
    EXPECT_NEAR(*focals[0], 520, 150);
    EXPECT_EQ(focals[1], focals[0]);
    EXPECT_EQ(focals[2], focals[0]);
    const Outcome far = run(folder, with(words, {"--orthographic"}));
    EXPECT_EQ(far.lines_with("warning"), 0U) << far.err;
}

/// Twice as large as the plates: 8 bits of so small a ball tell little.
painted::Scene clip_scene(int frame) {
    painted::Scene s = scene(frame + kFirst - 1);  // a clip's frames count from 1
    s.size = {640, 360};
    s.camera = {2 * kFocal, V2d(320, 180)};
    return s;
}

/// A clip of the plates, made by ffmpeg; false where it cannot.
bool put_clip(const TempFolder& folder, const std::string& name, const Words& codec) {
    for (int frame = 1; frame <= kLast - kFirst + 1; ++frame) {
        const Photo photo = painted::camera_photo(clip_scene(frame));
        Image image(photo.window.size, 3);
        for (std::size_t i = 0; i < photo.pixels.size(); ++i)
            image.row(0)[i] = static_cast<float>(std::to_integer<int>(photo.pixels[i])) / 255;
        WriteOptions options;
        options.format = FileFormat::png;
        write_image(folder / fmt::format("frame.{}.png", frame), image.view(), options);
    }
    Words words = {"ffmpeg", "-v", "error", "-y", "-i", "frame.%d.png"};
    return run_other(folder, with(with(words, codec), {name})).status == 0;
}

TEST(Shot, TakesTheFramesOfAClip) {
    const TempFolder folder;
    if (!put_clip(folder, "clip.avi", {"-c:v", "mjpeg", "-q:v", "1", "-pix_fmt", "yuvj444p"}))
        GTEST_SKIP() << "no ffmpeg that writes Motion JPEG";
    const auto words = [](const std::string& out, const char* jobs) {
        return Words{"shot",     "clip.avi",    "-o",     out + "/p.####.exr", "--size",
                     "16",       "--jobs",      jobs,     "--focal-px",        "840",
                     "--report", out + ".json", "--quiet"};
    };
    for (const char* out : {"a", "b"}) make(folder, out);
    const Outcome outcome = run(folder, words("a", "1"));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json report = report_in(folder, "a.json");
    ASSERT_EQ(report.at("frames").size(), plates().size());
    for (const Json& frame : report.at("frames")) {
        const Json& o = frame.at("outline");
        const Outline seen{o.at("cx"), o.at("cy"), o.at("a"), o.at("b"), o.at("angle")};
        const Outline truth = clip_scene(frame.at("frame")).outline();
        EXPECT_LT(rim_deviation(seen, truth), 2.5) << frame;
    }
    ASSERT_EQ(run(folder, words("b", "2")).status, 0);
    for (int frame = 1; frame <= 8; ++frame)
        EXPECT_EQ(read_bytes(folder / fmt::format("a/p.{:04}.exr", frame)),
                  read_bytes(folder / fmt::format("b/p.{:04}.exr", frame)));
}

TEST(Shot, SaysWhichFramesOfAClipCannotBeHad) {
    const TempFolder folder;
    if (!put_clip(folder, "clip.mp4",
                  {"-c:v", "libx264", "-bf", "2", "-b_strategy", "0", "-pix_fmt", "yuv444p"}))
        GTEST_SKIP() << "no ffmpeg that writes H.264";
    make(folder, "out");
    const Outcome outcome = run(folder, {"shot", "clip.mp4", "-o", "out/p.####.exr", "--size", "16",
                                         "--focal-px", "840", "--report", "r.json", "--quiet"});
    // Which, is the reader's affair; what it gives must be right, and the others be told.
    const Json report = report_in(folder, "r.json");
    std::size_t failed = 0;
    for (const Json& frame : report.at("frames")) {
        if (frame.at("outcome") == "failed") {
            ++failed;
            EXPECT_NE(frame.at("message").get<std::string>().find("stores frames out of order"),
                      std::string::npos);
            continue;
        }
        const Json& o = frame.at("outline");
        const Outline seen{o.at("cx"), o.at("cy"), o.at("a"), o.at("b"), o.at("angle")};
        const Outline truth = clip_scene(frame.at("frame")).outline();
        EXPECT_LT(rim_deviation(seen, truth), 5) << frame;  // a frame moves it by 10
    }
    EXPECT_LE(failed, 3U);
    EXPECT_EQ(outcome.status, failed == 0 ? 0 : 3);
    EXPECT_EQ(visible(folder, "out").size(), plates().size() - failed);
}

TEST(Shot, FindsNoBallInAShotWithoutOne) {
    const TempFolder folder;
    make(folder, "out");
    for (const int frame : {1, 2})
        write_exr(folder / fmt::format("plate.000{}.exr", frame), Image({64, 48}, 3));
    const Outcome outcome = run(folder, shot("out"));
    EXPECT_EQ(outcome.status, 4);
    EXPECT_EQ(outcome.lines_with("error"), 1U) << outcome.err;
    EXPECT_TRUE(visible(folder, "out").empty());
}

TEST(Shot, MakesFoldersOfFacesAndAnyOtherMap) {
    const TempFolder folder;
    put_plates(folder);
    const Words words = {"shot", "plate.%04d.exr", "--frames", "1005-1007x2", "--focal-px",
                         "420",  "--size",         "8",        "--quiet"};
    const auto outcomes = run_all(
        folder,
        {with(words, {"-o", "sh.####", "--layout", "faces", "--work", "w1"}),
         with(words, {"-o", "####/env.png", "--for", "unreal", "--format", "png", "--work", "w2"}),
         with(words, {"-o", "x.$F4.hdr", "--for", "unreal", "--work", "w3"}),
         with(words, {"-o", "y.@.png", "--layout", "cross-h", "--lock", "--work", "w4"})});
    EXPECT_EQ(outcomes[0].status, 0) << outcomes[0].err;
    for (const char* face : {"px", "nx", "py", "ny", "pz", "nz"}) {
        EXPECT_TRUE(exists(folder / fmt::format("sh.1005/{}.exr", face)));
        EXPECT_TRUE(exists(folder / fmt::format("sh.1007/{}.exr", face)));
    }
    EXPECT_FALSE(exists(folder / "sh.1006"));
    EXPECT_EQ(outcomes[1].status, 0) << outcomes[1].err;
    EXPECT_TRUE(exists(folder / "1005/env.png"));
    EXPECT_EQ(outcomes[2].status, 0) << outcomes[2].err;
    EXPECT_TRUE(exists(folder / "x.1007.hdr"));
    EXPECT_EQ(outcomes[3].status, 0) << outcomes[3].err;
    EXPECT_EQ(read_floats(folder / "y.1005.png").size(), (Size{32, 24}));
    // Faces and other formats are known again, too.
    const auto date = fs::last_write_time(folder / "sh.1005/nz.exr");
    const auto date_of_png = fs::last_write_time(folder / "y.1005.png");
    run_all(folder,
            {with(words, {"-o", "sh.####", "--layout", "faces", "--work", "w1"}),
             with(words, {"-o", "y.@.png", "--layout", "cross-h", "--lock", "--work", "w4"})});
    EXPECT_EQ(fs::last_write_time(folder / "sh.1005/nz.exr"), date);
    EXPECT_EQ(fs::last_write_time(folder / "y.1005.png"), date_of_png);
}

TEST(Shot, TurnsEachFrameByItsOwnCamera) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "a");
    make(folder, "b");
    write_bytes(folder / "c.json",
                R"({"frames": {"1006": {"camera_to_world": [0,0,1,0,1,0,-1,0,0]}}})");
    const Words two = {"--frames", "1005,1006"};
    ASSERT_EQ(run(folder, shot("a", with(two, {"--cameras", "c.json"}))).status, 0);
    ASSERT_EQ(run(folder, shot("b", with(two, {"--yaw", "90"}))).status, 0);
    EXPECT_EQ(largest_difference(read_floats(folder / "a/probe.1006.exr"),
                                 read_floats(folder / "b/probe.1006.exr")),
              0);
    EXPECT_GT(largest_difference(read_floats(folder / "a/probe.1005.exr"),
                                 read_floats(folder / "b/probe.1005.exr")),
              0.01);
}

TEST(Shot, AveragesMapsOverTime) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    ASSERT_EQ(run(folder, shot("out", {"--smooth-frames", "3", "--float"})).status, 0);
    make(folder, "plain");
    ASSERT_EQ(run(folder, shot("plain", {"--float"})).status, 0);
    Image sum = read_floats(folder / "plain/probe.1006.exr");
    for (const char* other : {"plain/probe.1005.exr", "plain/probe.1007.exr"}) {
        const Image one = read_floats(folder / other);
        for (int i = 0; i < one.width() * one.channels() * one.height(); ++i)
            sum.row(0)[i] += one.row(0)[i];
    }
    for (int i = 0; i < sum.width() * sum.channels() * sum.height(); ++i) sum.row(0)[i] /= 3;
    // 1e-5: another order of rounding in 32-bit floats, of light up to 30.
    EXPECT_LT(largest_difference(read_floats(folder / "out/probe.1006.exr"), sum), 1e-5);
}

TEST(Shot, GivesUpWhereNothingCanBeWritten) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    Circumstances full;
    full.file_size_bytes = 4000;  // enough for the records of a few frames, not for a map
    const Outcome outcome = run(folder, shot("out", {"--size", "64", "--jobs", "1"}), full);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.lines_with("error"), 1U) << outcome.err;
    EXPECT_TRUE(outcome.says("cannot be written")) << outcome.err;
    EXPECT_TRUE(visible(folder, "out").empty());
    ASSERT_EQ(run(folder, shot("out")).status, 0);
    EXPECT_EQ(results(folder, "out"), expected());
}

TEST(Shot, RefusesWhatIsTypedWrongBeforeItDoesAnything) {
    const TempFolder folder;
    put_plates(folder);
    make(folder, "out");
    const std::string key = "1005:1,2";
    expect_refusals(
        folder,
        {{{"shot", "plate.1005.exr", "-o", "out/p.####.exr"}, {"plate.####.exr"}},
         {{"shot", "plate.####.exr", "-o", "out/p.exr"}, {"a place for the frame's number"}},
         {{"shot", "none.####.exr", "-o", "out/p.####.exr"}, {"no such files"}, 1},
         {{"shot", "plate.####.exr", "-o", "nowhere/deep/p.####.exr"}, {"nowhere/deep"}, 1},
         {{"shot", "plate.####.exr", "-o", "plate.####.exr"}, {"would replace the input"}},
         {shot("out", {"--frames", "5-x"}), {"--frames 5-x"}},
         {shot("out", {"--key", key}), {"FRAME:CX,CY,R"}},
         {shot("out", {"--key", "1005:1,2,0"}), {"must be above 0"}},
         {shot("out", {"--stage", "paint"}), {"--stage"}},
         {shot("out", {"--missing", "guess"}), {"--missing"}},
         {shot("out", {"--smooth-frames", "2"}), {"odd"}},
         {shot("out", {"--report", "r.txt"}), {".json or .html"}},
         {shot("out", {"--ball", "1,2,3", "--lock"}), {"--lock"}},
         {shot("out", {"--cameras", "none.json"}), {"none.json"}, 1},
         {shot("out", {"--hfov", "40"}), {"--hfov"}},
         {shot("out", {"--size", "0"}), {"--size"}}});
}

}  // namespace
}  // namespace chromeball::test
