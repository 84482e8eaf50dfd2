#include <gtest/gtest.h>

#include <algorithm>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"

// How options are given: on the command line, in settings files, wrongly.

namespace chromeball {
namespace {

using namespace test;

/// A folder with a map and a photo; maps are read back to see what the options did.
class Options : public testing::Test {
protected:
    Options() {
        write_exr(folder / "world.exr", world_map(*find_layout("latlong"), 32));
        write_exr(folder / "ball.exr", ball_photo({80, 80}, distant_ball(40, 40, 36)));
    }
    static Words map(const Words& more) {
        Words words{"convert", "world.exr", "--from", "latlong", "--size", "32"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    static Words photo(const Words& more) {
        Words words{"convert", "ball.exr"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    /// Whether all runs succeed and write the same picture as the first.
    void expect_same(const std::vector<Words>& commands) {
        std::vector<Words> all;
        for (std::size_t i = 0; i < commands.size(); ++i) {
            all.push_back(commands[i]);
            all.back().insert(all.back().end(), {"-o", std::to_string(i) + ".exr"});
        }
        const auto outcomes = run_all(folder, all);
        for (std::size_t i = 0; i < all.size(); ++i) {
            SCOPED_TRACE(text_of(all[i]));
            ASSERT_EQ(outcomes[i].status, 0) << outcomes[i].err;
            EXPECT_EQ(largest_difference(read_floats(folder / "0.exr"),
                                         read_floats(folder / (std::to_string(i) + ".exr"))),
                      0);
        }
    }

    TempFolder folder;
};

TEST_F(Options, AValueMayFollowASpaceOrAnEqualsSignAlsoNegativeOnes) {
    expect_same({map({"--yaw", "-90"}), map({"--yaw=-90"}), map({"--yaw=-90.0"}),
                 map({"--yaw", "-9e1"}), map({"--camera-to-world", "0,0,-1,0,1,0,1,0,0"}),
                 map({"--camera-to-world=0,0,-1,0,1,0,1,0,0"}),
                 map({"--camera-to-world", "0, 0, -1, 0, 1, 0, 1, 0, 0"}),
                 map({"--camera-to-world=0,0,-1,55,0,1,0,66,1,0,0,77,0,0,0,1"})});
    expect_same({photo({"--ball", "-1,40,36"}), photo({"--ball=-1,40,36"}),
                 photo({"--ellipse=-1,40,36,36,0"})});
}

TEST_F(Options, InstructionsArePinned) {
    expect_same({map({"--simd", "SCALAR", "--float"}),
                 map({"--simd", "SCALAR", "--float", "--threads", "1"})});
    expect_same({map({"--float"}), map({"--float", "--threads", "1"})});
}

TEST_F(Options, SettingsStandInAFileBareOrInTheCommandsSection) {
    write_bytes(folder / "bare.toml", "yaw = -90\nfilter = \"fast\"\nfloat = true\n");
    write_bytes(folder / "section.toml",
                "# of our stage\n[detect]\nthreshold = 0.9\n\n[convert]\nyaw = -90\n"
                "filter = 'fast'\nfloat = true\n");
    write_bytes(
        folder / "array.toml",
        "float = true\nfilter = \"fast\"\ncamera-to-world = [0, 0, -1, 0, 1, 0, 1, 0, 0]\n");
    write_bytes(folder / "string.toml",
                "float = true\nfilter = \"fast\"\ncamera-to-world = \"0,0,-1,0,1,0,1,0,0\"\n");
    const Words typed = map({"--yaw", "-90", "--filter", "fast", "--float"});
    Words before = map({});
    before.insert(before.begin(), {"--config", "section.toml"});
    expect_same({typed, map({"--config", "bare.toml"}), map({"--config", "section.toml"}),
                 map({"--config=section.toml"}), before, map({"--config", "array.toml"}),
                 map({"--config", "string.toml"})});
    // What is typed wins.
    expect_same({map({"--yaw", "30", "--float", "--filter", "fast"}),
                 map({"--config", "bare.toml", "--yaw", "30"})});
}

TEST_F(Options, ASettingsFileCanHoldTheBallAndTheOutput) {
    write_bytes(folder / "shot.toml",
                "[convert]\nball = [40, 40, 36]\northographic = true\noutput = \"set.exr\"\n"
                "size = 16\n[detect]\nball = \"40,40,36\"\n");
    const Outcome outcome = run(folder, {"convert", "--config", "shot.toml", "ball.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(read_floats(folder / "set.exr").height(), 16);
    EXPECT_EQ(run(folder, {"detect", "--config", "shot.toml", "ball.exr"}).status, 0);
}

TEST_F(Options, WrongSettingsAreNamedWithTheirFile) {
    write_bytes(folder / "key.toml", "sise = 64\n");
    write_bytes(folder / "own.toml", "[convert]\nthreshhold = 0.4\n");
    write_bytes(folder / "command.toml", "[convrt]\nsize = 64\n");
    write_bytes(folder / "value.toml", "yaw = \"left\"\n");
    write_bytes(folder / "syntax.toml", "size 64\n");
    write_bytes(folder / "many.toml", "camera-to-world = [\n 1,0,0,\n 0,1,0,\n 0,0,1 ]\n");
    write_bytes(folder / "other.toml", "[detect]\nnonsense = 1\n");
    const auto with = [](const std::string& file) {
        return map({"-o", "out.exr", "--config", file});
    };
    expect_refusals(folder, {{with("key.toml"), {"key.toml", "sise", "did you mean \"--size\""}, 2},
                             {with("own.toml"), {"own.toml", "threshhold", "--threshold"}, 2},
                             {with("command.toml"), {"command.toml", "[convrt]"}, 2},
                             {with("value.toml"), {"yaw", "left"}, 2},
                             {with("syntax.toml"), {"syntax.toml", "size 64", "KEY = VALUE"}, 2},
                             {with("many.toml"), {"many.toml", "KEY = VALUE"}, 2},
                             {with("gone.toml"), {"gone.toml"}, 1},
                             {with("."), {"."}, 1}});
    EXPECT_EQ(run(folder, with("other.toml")).status, 0);  // another command's business
}

TEST_F(Options, ContradictionsAreRefused) {
    const std::vector<Refusal> cases{
        {photo({"-o", "o.exr", "--hfov", "40", "--focal-px", "900"}), {"--hfov", "--focal-px"}},
        {photo({"-o", "o.exr", "--orthographic", "--distance-radii", "9"}),
         {"--orthographic", "--distance-radii"}},
        {photo({"-o", "o.exr", "--focal-mm", "50"}), {"--focal-mm", "--sensor-mm"}},
        {photo({"-o", "o.exr", "--sensor-mm", "36"}), {"--focal-mm", "--sensor-mm"}},
        {photo({"-o", "o.exr", "--ball", "40,40,36", "--ellipse", "40,40,36,36,0"}),
         {"--ball", "--ellipse"}},
        {photo({"-o", "o.exr", "--ball", "40,40,36", "--cropped"}), {"--ball", "--cropped"}},
        {map({"-o", "o.exr", "--for", "openexr", "--layout", "latlong"}), {"--for", "--layout"}},
        {map({"-o", "o.exr", "--format", "png"}), {"o.exr", "--format"}},
        {map({"-o", "o.png", "--float"}), {"--float", "png"}},
        {map({"-o", "o.jpg", "--float"}), {"--float", "jpg"}},
        {map({"-o", "o.hdr", "--float"}), {"--float", "hdr"}},
        {map({"-o", "o.tif", "--float", "--bits", "8"}), {"--float", "--bits"}},
        {map({"-o", "o.exr", "--layout", "faces"}), {"o.exr", "folder", "-o o"}},
        {map({"-o", "o", "--layout", "latlong"}), {"o", "extension", ".exr"}},
        {map({"-o", "o.bmp"}), {"o.bmp", ".png"}},
        {map({"-o", "o.png", "--display", "sRGB", "--output-space", "acescg"}),
         {"--display", "--output-space"}},
        {map({"-o", "o.exr", "--view", "ACES SDR"}), {"o.exr", "--view"}},
        {map({"-o", "o.exr", "--ball", "40,40,36"}), {"--from latlong", "--ball"}},
        {map({"-o", ""}), {"-o"}}};
    expect_refusals(folder, cases);
}

TEST_F(Options, NumbersOutOfReachAreRefused) {
    std::vector<Refusal> cases;
    for (const Words& wrong : std::vector<Words>{{"--size", "0"},
                                                 {"--size", "-5"},
                                                 {"--size", "1k"},
                                                 {"--size", "99999"},
                                                 {"--yaw", "left"},
                                                 {"--yaw", "nan"},
                                                 {"--size="},
                                                 {"--bits", "12"},
                                                 {"--threads", "-1"},
                                                 {"--camera-to-world", "1,0,0"},
                                                 {"--camera-to-world", "1,0,0,0,1,0,0,0,x"},
                                                 {"--camera-to-world", "2,0,0,0,2,0,0,0,2"},
                                                 {"--camera-to-world", "-1,0,0,0,1,0,0,0,1"}}) {
        Words words = map({"-o", "out.exr"});
        words.insert(words.end(), wrong.begin(), wrong.end());
        cases.push_back({words, {wrong.front()}, 2});
    }
    for (const Words& wrong : std::vector<Words>{{"--hfov", "180"},
                                                 {"--hfov", "nan"},
                                                 {"--focal-px", "0"},
                                                 {"--distance-radii", "0.5"},
                                                 {"--ball", "40,40"},
                                                 {"--ball", "40,40,0"},
                                                 {"--ball", "a,b,c"},
                                                 {"--ball", "nan,40,30"},
                                                 {"--ellipse", "40,40,30,20"},
                                                 {"--principal", "40"}}) {
        Words words = photo({"-o", "out.exr"});
        if (wrong.front() != "--ball" && wrong.front() != "--ellipse")
            words.insert(words.end(), {"--ball", "40,40,36"});
        words.insert(words.end(), wrong.begin(), wrong.end());
        cases.push_back({words, {wrong.front()}, 2});
    }
    expect_refusals(folder, cases);
}

TEST_F(Options, UnknownNamesAreAnsweredWithTheNearestOnes) {
    const std::vector<Refusal> cases{
        {map({"-o", "o.exr", "--layout", "lat-long"}), {"lat-long", "\"latlong\""}},
        {map({"-o", "o.exr", "--layout", "cubemap"}), {"cubemap", "\"faces\"", "\"cross-h\""}},
        {map({"-o", "o.exr", "--for", "blendr"}), {"blendr", "\"blender\""}},
        {map({"-o", "o.exr", "--for", "maya"}), {"maya", "\"usd\"", "\"arnold\""}},
        {map({"-o", "o.exr", "--filter", "lanczos"}), {"lanczos", "adaptive", "fast"}},
        {map({"-o", "o.exr", "--simd", "MMX"}), {"MMX", "SCALAR"}},
        {map({"-o", "o", "--layout", "faces", "--format", "bmp"}), {"bmp", "png"}},
        {{"convert", "world.exr", "--from", "lat", "-o", "o.exr"}, {"lat", "\"latlong\"?"}},
        {{"info", "world.exr", "--from", "cros-h"}, {"cros-h", "\"cross-h\""}},
        {map({"-o", "o.exr", "--layuot", "latlong"}), {"--layuot", "\"--layout\""}},
        {map({"-o", "o.exr", "--Yaw=3"}), {"--Yaw", "\"--yaw\""}},
        {{"convrt", "world.exr", "-o", "o.exr"}, {"convrt", "\"convert\""}},
        {{"fly"}, {"fly", "\"detect\"", "\"info\""}},
        {{"--verson"}, {"--verson", "\"--version\""}}};
    expect_refusals(folder, cases);
}

TEST_F(Options, SlipsOfTheHandAreUnderstood) {
    std::vector<Refusal> cases;
    // Numbers separated by spaces, options before the command, no -o, one word too many.
    cases.push_back({photo({"--ball", "40", "40", "36", "-o", "o.exr"}),
                     {"separated by commas", "--ball 812,540,202"}});
    cases.push_back({{"--quiet", "convert", "ball.exr", "-o", "o.exr"},
                     {"--quiet", "after the command's name"}});
    cases.push_back({{"convert", "ball.exr", "o.exr"}, {"-o o.exr"}});
    cases.push_back({photo({}), {"--output", "required"}});
    cases.push_back({{"convert", "-o", "o.exr"}, {"input", "required"}});
    cases.push_back({photo({"world.exr", "-o", "o.exr"}), {"world.exr", "too many"}});
    cases.push_back({photo({"-o"}), {"--output"}});
    cases.push_back({{"detect"}, {"photos", "required"}});
    cases.push_back({{"info"}, {"file", "required"}});
    expect_refusals(folder, cases);
}

TEST_F(Options, QuietSilencesProgressButNotWarnings) {
    const Words words = photo({"--ball", "40,40,36", "--size", "16", "-o", "o.exr"});
    Words quiet = words;
    quiet.push_back("--quiet");
    const Outcome loud = run(folder, words), hushed = run(folder, quiet);
    EXPECT_TRUE(loud.says("converting: 100 %")) << loud.err;
    EXPECT_EQ(loud.lines_with("warning: "), 1U) << loud.err;
    EXPECT_EQ(hushed.lines_with("warning: "), 1U) << hushed.err;
    EXPECT_EQ(std::count(hushed.err.begin(), hushed.err.end(), '\n'), 1) << hushed.err;
    // No bar, no control characters where nobody looks.
    EXPECT_EQ(loud.err.find('\r'), std::string::npos);
    EXPECT_EQ(loud.err.find('\033'), std::string::npos);
}

}  // namespace
}  // namespace chromeball
