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

/// The synthetic world's irradiance over pi: its light is linear in the direction, (d + 1) / 2.
V3d light_on(V3d normal) {
    const V3d n = normal.normalized();
    return V3d(0.5, 0.5, 0.5) + n / 3;
}

/// A tinted ball far away, and a card beside it that gives back a fifth of the light.
const V3d kTint(0.7, 0.6, 0.45);
Image ball_and_card(V3d normal, double exposure = 1) {
    Image photo = ball_photo({300, 200}, distant_ball(100, 100, 80));
    const V3d light = light_on(normal);
    for (int y = 0; y < photo.height(); ++y)
        for (int x = 0; x < photo.width(); ++x)
            for (int c = 0; c < 3; ++c) {
                float& v = photo.pixel(x, y)[c];
                const bool card = x >= 220 && x < 280 && y >= 60 && y < 140;
                v = card ? static_cast<float>(0.2 * light[c]) : v * static_cast<float>(kTint[c]);
                v *= static_cast<float>(exposure);
            }
    return photo;
}

const Words kCard{"--ball-at",          "100,100,80", "--orthographic", "--card", "225,65,50,70",
                  "--grey-reflectance", "0.2"};

void expect_tint(const std::string& file) {
    const json found = json::parse(read_bytes(file)).at("reflectance");
    // A ball 160 pixels across shows the light behind it in a few pixels.
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c].get<double>() / kTint[static_cast<int>(c)], 1, 0.01) << file << c;
}

TEST(Calibrate, MeasuresATintByACardThatFacesTheCameraOrDoesNot) {
    const TempFolder folder;
    write_exr(folder / "facing.exr", ball_and_card({0, 0, 1}));
    write_exr(folder / "turned.exr", ball_and_card({-0.6, 0.3, 0.7}));
    const auto calibrate = [&](const std::string& photo, const Words& more) {
        return with(with({"calibrate", "--ball", photo, "--grey", photo}, kCard), more);
    };
    const auto results =
        run_all(folder, {calibrate("facing.exr", {"-o", "facing.json"}),
                         calibrate("turned.exr", {"--normal=-0.6,0.3,0.7", "-o", "turned.json"})});
    for (const Outcome& result : results) ASSERT_EQ(result.status, 0) << result.err;
    expect_tint(folder / "facing.json");
    expect_tint(folder / "turned.json");
    // And it is undone: what the camera stands before is (0.5, 0.5, 1) again.
    const Outcome used =
        run(folder, {"convert", "facing.exr", "--ball", "100,100,80", "--orthographic",
                     "--reflectance", "facing.json", "--size", "32", "--float", "-o", "out.exr"});
    ASSERT_EQ(used.status, 0) << used.err;
    const Image map = read_floats(folder / "out.exr");
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(map.pixel(32, 16)[c], c == 2 ? 1.0F : 0.5F, 0.03F) << c;
    expect_refusal(folder, calibrate("facing.exr", {"--clip", "0.05", "-o", "x.json"}), 2,
                   {"--card 225,65,50,70", "clipped", "shorter"});
}

TEST(Calibrate, CountsInThatTheCardsPhotoWasExposedLonger) {
    const TempFolder folder;
    const auto write = [&](const std::string& name, double exposure) {
        Metadata facts;
        facts.set({"expTime", "float", {0.01 * exposure}, {}});
        write_exr(folder / name, ball_and_card({0, 0, 1}, exposure), facts);
    };
    write("ball.exr", 1);
    write("card.exr", 3);
    const Outcome outcome = run(
        folder,
        with({"calibrate", "--ball", "ball.exr", "--grey", "card.exr", "-o", "ball.json"}, kCard));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    expect_tint(folder / "ball.json");
    EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
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
