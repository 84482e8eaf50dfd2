#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"

// What info tells of maps and photos.

namespace chromeball {
namespace {

using namespace test;
using nlohmann::json;

class Info : public testing::Test {
protected:
    json info(const std::string& file, const Words& more = {}) const {
        Words words{"info", file, "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = run(folder, words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        return json::parse(outcome.out, nullptr, false);
    }
    TempFolder folder;
};

TEST_F(Info, ATextForPeopleTellsTheSame) {
    write_exr(folder / "world.exr", world_map(*find_layout("latlong"), 32));
    const Outcome outcome = run(folder, {"info", "world.exr"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    for (const std::string text :
         {"world.exr: 64x32 pixels, 4 channels, 32-bit floats", "latlong",
          "likely: twice as wide as high", "stops", "mean radiance", "12.56", "100.00 %", "ACEScg"})
        EXPECT_NE(outcome.out.find(text), std::string::npos) << text << "\n" << outcome.out;
}

TEST_F(Info, TheRangeIsInStops) {
    Image map = world_map(*find_layout("latlong"), 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c) map.pixel(x, y)[c] = x < 32 ? 0.25F : 256.0F;
    write_exr(folder / "steps.exr", map);
    const json told = info("steps.exr");
    EXPECT_NEAR(told.at("range_stops"), 10, 1e-3);
    EXPECT_NEAR(told.at("maximum"), 256, 1e-2);
    EXPECT_NEAR(told.at("mean_radiance")[0], (256 + 0.25) / 2, 0.1);
}

TEST_F(Info, BlackIsNoError) {
    write_exr(folder / "black.exr", Image({64, 32}, 3));
    EXPECT_TRUE(info("black.exr").at("range_stops").is_null());
    EXPECT_EQ(run(folder, {"info", "black.exr"}).status, 0);
}

TEST_F(Info, ADiskMayBeAnAngularMapAndTheNoteSaysSo) {
    write_exr(folder / "probe.exr", world_map(*find_layout("mirror-ball"), 64));
    const json told = info("probe.exr");
    EXPECT_NE(told.at("layout_sureness").get<std::string>().find("guess"), std::string::npos);
    ASSERT_EQ(told.at("notes").size(), 1U);
    const std::string note = told.at("notes")[0];
    EXPECT_NE(note.find("--from mirror-ball"), std::string::npos);
    EXPECT_NE(note.find("--from angular"), std::string::npos);
    EXPECT_EQ(info("probe.exr", {"--from", "mirror-ball"}).at("layout"), "mirror-ball");
}

TEST_F(Info, APhotoIsNoMap) {
    write_picture(folder / "photo.jpg", ball_photo({90, 60}, distant_ball(45, 30, 20)));
    const json told = info("photo.jpg");
    EXPECT_TRUE(told.at("layout").is_null());
    EXPECT_TRUE(told.at("covered_steradians").is_null());
    EXPECT_EQ(told.at("type"), "8-bit integers");
    EXPECT_EQ(told.at("color_space"), "sRGB texture");
    EXPECT_TRUE(told.at("provenance").is_null());
    expect_refusal(folder, {"info", "photo.jpg", "--from", "latlong"}, 1, {"photo.jpg", "90x60"});
}

}  // namespace
}  // namespace chromeball
