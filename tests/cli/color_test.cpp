#include <gtest/gtest.h>

#include <cmath>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"

// Colour spaces as they are typed, and configs that are broken.

namespace chromeball {
namespace {

using namespace test;

class Color : public testing::Test {
protected:
    Color() { write_exr(folder / "world.exr", world_map(*find_layout("latlong"), 32)); }
    static Words map(const Words& more) {
        Words words{"convert", "world.exr", "--from", "latlong", "--size", "16", "-o", "out.exr"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    TempFolder folder;
};

TEST_F(Color, AnUnknownSpaceIsAnsweredWithTheNearestNames) {
    const auto picture = [](const Words& more) {
        Words words{"convert", "world.exr", "--from", "latlong", "-o", "out.png"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    expect_refusals(
        folder,
        {{map({"--input-space", "srgb_textur"}), {"srgb_textur", "did you mean", "texture"}, 2},
         {map({"--output-space", "ACEScgg"}), {"ACEScgg", "did you mean \"ACEScg\""}, 2},
         {{"info", "world.exr", "--input-space", "sRBG"}, {"sRBG", "sRGB"}, 2},
         {picture({"--view", "ACES SRD"}), {"ACES SRD", "ACES"}, 2},
         {picture({"--display", "projector"}), {"projector", "sRGB"}, 2}});
}

TEST_F(Color, ABrokenOrMissingConfigIsNamed) {
    write_bytes(folder / "broken.ocio", "ocio_profile_version: 2\nroles: [this is no config\n");
    write_bytes(folder / "text.ocio", "nothing of the kind\n");
    write_bytes(folder / "empty.ocio", "");
    for (const std::string config : {"broken.ocio", "text.ocio", "empty.ocio", "gone.ocio"}) {
        expect_refusal(folder, map({"--ocio", config}), 1, {config, "--ocio"});
        if (config != "text.ocio" && config != "gone.ocio") continue;
        Circumstances by_environment;
        by_environment.environment = {{"OCIO", config}};
        expect_refusal(folder, map({}), 1, {config, "$OCIO"}, by_environment);
    }
    expect_refusal(folder, map({"--ocio", "."}), 1, {"--ocio"});
}

TEST_F(Color, TheFlagWinsOverTheEnvironment) {
    std::filesystem::copy(std::string(CHROMEBALL_DATA) + "/chromeball.ocio", folder / "good.ocio");
    Circumstances broken;
    broken.environment = {{"OCIO", "gone.ocio"}};
    const Outcome outcome = run(folder, map({"--ocio", "good.ocio"}), broken);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(Color, RolesAndAliasesAreSpaces) {
    std::vector<Words> commands;
    const Words spaces{"scene_linear", "acescg",    "ACEScg", "aces2065_1",
                       "lin_rec709",   "lin_p3d65", "raw",    "srgb_texture"};
    for (const std::string& space : spaces)
        commands.push_back({"convert", "world.exr", "--from", "latlong", "--size", "16", "--float",
                            "--input-space", space, "--output-space", space, "-o", space + ".exr"});
    commands.push_back({"convert", "world.exr", "--from", "latlong", "--size", "16", "--float",
                        "-o", "untouched.exr"});
    const auto outcomes = run_all(folder, commands);
    for (std::size_t i = 0; i < commands.size(); ++i)
        ASSERT_EQ(outcomes[i].status, 0) << outcomes[i].err;
    const Image untouched = read_floats(folder / "untouched.exr");
    // Into the working space, filtered there, and out again: linear spaces agree.
    for (const std::string& space : spaces)
        EXPECT_LT(largest_difference(read_floats(folder / (space + ".exr")), untouched),
                  space == "srgb_texture" ? 3e-2 : 1e-4)
            << space;
}

TEST_F(Color, PicturesAreSrgbAndLightIsSceneLinear) {
    Image grey({32, 16}, 3);
    for (int y = 0; y < 16; ++y)
        for (int i = 0; i < 96; ++i) grey.row(y)[i] = 0.18F;
    write_exr(folder / "grey.exr", grey);
    const auto to = [](const std::string& out, const Words& more) {
        Words words{"convert", "grey.exr", "--from", "latlong", "--size", "16", "-o", out};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    const std::vector<Words> commands{to("a.png", {}),
                                      to("a.tif", {}),
                                      to("a.jpg", {}),
                                      to("a.exr", {}),
                                      to("a.hdr", {}),
                                      to("b.tif", {"--float"}),
                                      to("v.png", {"--view", "ACES SDR"})};
    for (const Outcome& outcome : run_all(folder, commands))
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    const double encoded = 1.055 * std::pow(0.18, 1 / 2.4) - 0.055;
    for (const std::string name : {"a.png", "a.tif", "a.jpg"})
        EXPECT_NEAR(read_floats(folder / name).pixel(8, 8)[1], encoded, 5e-3) << name;
    for (const std::string name : {"a.exr", "a.hdr", "b.tif"})
        EXPECT_NEAR(read_floats(folder / name).pixel(8, 8)[1], 0.18, 2e-3) << name;
    // A PNG goes back to light by itself.
    ASSERT_EQ(
        run(folder, {"convert", "a.png", "--from", "latlong", "--size", "16", "-o", "back.exr"})
            .status,
        0);
    EXPECT_NEAR(read_floats(folder / "back.exr").pixel(8, 8)[1], 0.18, 1e-3);
}

}  // namespace
}  // namespace chromeball
