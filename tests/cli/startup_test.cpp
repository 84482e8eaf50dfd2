#include <gtest/gtest.h>

#include "cli/program.h"
#include "cli/world.h"

// What the program loads: time at the start is what the libraries behind it cost.

namespace chromeball {
namespace {

using namespace test;

#ifdef __GLIBC__

/// Whether the run loads a library, by the loader's own report.
bool loads(const TempFolder& folder, const Words& words, const std::string& library) {
    Circumstances traced;
    traced.environment = {{"LD_DEBUG", "files"}};
    const Outcome outcome = run(folder, words, traced);
    EXPECT_EQ(outcome.status, 0) << text_of(words);
    EXPECT_TRUE(outcome.says("libOpenEXR")) << "the loader did not report";
    return outcome.says(library);
}

bool loads_image_library(const TempFolder& folder, const Words& words) {
    return loads(folder, words, "libOpenImageIO");
}

TEST(Startup, LoadsTheLargeImageLibraryOnlyForFilesThatNeedIt) {
    const TempFolder folder;
    const Image photo = ball_photo({64, 64}, distant_ball(32, 32, 30));
    write_exr(folder / "ball.exr", photo);
    for (const char* name : {"ball.jpg", "ball.png", "ball.tif"})
        write_picture(folder / name, photo);
    const Words rest{"--ball=32,32,30", "--orthographic", "--size=16", "-o", "out.exr"};
    const auto convert = [&](const std::string& file) {
        Words words{"convert", file};
        words.insert(words.end(), rest.begin(), rest.end());
        return words;
    };
    EXPECT_FALSE(loads_image_library(folder, {"--help"}));
    EXPECT_FALSE(loads_image_library(folder, {"info", "ball.exr"}));
    EXPECT_FALSE(loads_image_library(folder, {"detect", "ball.exr", "--ball=32,32,30"}));
    EXPECT_FALSE(loads_image_library(folder, convert("ball.exr")));
    EXPECT_FALSE(loads_image_library(folder, {"info", "ball.jpg"}));
    EXPECT_FALSE(loads_image_library(folder, convert("ball.jpg")));
    EXPECT_FALSE(loads_image_library(folder, convert("ball.png")));
    EXPECT_TRUE(loads_image_library(folder, convert("ball.tif")));
}

TEST(Startup, LoadsTheRayTracerOnlyToRender) {
    const TempFolder folder;
    write_exr(folder / "map.exr", world_map(*find_layout("latlong"), 16));
    for (const char* library : {"libembree", "libassimp"}) {
        EXPECT_FALSE(loads(folder, {"--help"}, library));
        EXPECT_FALSE(loads(folder, {"info", "map.exr"}, library));
        EXPECT_TRUE(loads(folder, {"preview", "map.exr", "--size=8", "-o", "a.exr"}, library));
    }
}

#endif

}  // namespace
}  // namespace chromeball
