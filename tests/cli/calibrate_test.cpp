#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"

// What a ball gives back, measured and undone.

namespace chromeball {
namespace {

using namespace test;
using nlohmann::json;

const std::string kGarden = std::string(CHROMEBALL_DATA) + "/photos/garden.exr";
const Words kGrey{"--grey-ball", "1356,477,211", "--grey-reflectance", "0.18"};

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST(Calibrate, MeasuresTheGardensBallByTheGreyOneBesideIt) {
    const TempFolder folder;
    const Outcome outcome =
        run(folder,
            with({"calibrate", "--ball", kGarden, "--grey", kGarden, "-o", "ball.json"}, kGrey));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json found = json::parse(read_bytes(folder / "ball.json"));
    // The mirror of that plate gives back all; noise and what stands between the balls are 3 %.
    for (const json& r : found.at("reflectance")) EXPECT_NEAR(r.get<double>(), 1, 0.05);
    const Outcome used = run(folder, {"convert", kGarden, "--reflectance", "ball.json", "--size",
                                      "64", "-o", "out.exr"});
    EXPECT_EQ(used.status, 0) << used.err;
}

TEST(Calibrate, RefusesWhatIsTypedWrong) {
    const TempFolder folder;
    const Words start{"calibrate", "--ball", kGarden, "--grey", kGarden, "-o", "ball.json"};
    expect_refusals(folder,
                    {{start, {"--card", "--grey-ball"}},
                     {with(start, {"--card", "1,2,3"}), {"--card"}},
                     {with(start, {"--card", "9000,9000,10,10"}), {"--card", "1920x1080"}},
                     {with(start, with(kGrey, {"--material", "butter"})), {"butter", "silver"}}});
}

TEST(Reflectance, OfAMetalIsUndoneByTheAngleOfIncidence) {
    const TempFolder folder;
    write_exr(folder / "ball.exr", ball_photo({120, 96}, distant_ball(60, 48, 40)));
    const Words convert{"convert", "ball.exr", "--orthographic", "--ball", "60,48,40",
                        "--size",  "32"};
    ASSERT_EQ(run(folder, with(convert, {"-o", "plain.exr"})).status, 0);
    ASSERT_EQ(run(folder, with(convert, {"--reflectance", "chromium", "-o", "metal.exr"})).status,
              0);
    const Image plain = read_floats(folder / "plain.exr"),
                metal = read_floats(folder / "metal.exr");
    const auto ratio = [&](int x, int y) { return metal.pixel(x, y)[1] / plain.pixel(x, y)[1]; };
    EXPECT_NEAR(ratio(32, 16), 1.803f, 0.02f);  // towards the camera: straight on
    // Incidence of 72 degrees, by the complex form of Fresnel's equations: metals dip before
    // grazing.
    EXPECT_NEAR(ratio(6, 16), 1.929f, 0.02f);
    write_bytes(folder / "bad.json", "{}");
    expect_refusals(folder,
                    {{with(convert, {"--reflectance", "bad.json", "-o", "x.exr"}), {"bad.json"}},
                     {with(convert, {"--reflectance", "gone.json", "-o", "x.exr"}), {"gone.json"}},
                     {with(convert, {"--reflectance", "butter", "-o", "x.exr"}), {"butter"}}});
}

}  // namespace
}  // namespace chromeball
