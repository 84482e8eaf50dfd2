#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <ostream>

#include "color/color.h"
#include "color/pictures.h"
#include "core/error.h"

namespace chromeball {
namespace {

const ColorConfig& config() {
    static const ColorConfig built_in = ColorConfig::built_in();
    return built_in;
}

/// All spaces by their proper names.
std::vector<std::string> proper_names() {
    std::vector<std::string> names;
    for (const std::string& name : config().space_names())
        if (config().space(name) == name) names.push_back(name);
    return names;
}

std::string usage_message(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), Error::Kind::usage);
        return e.what();
    }
    ADD_FAILURE() << "no error";
    return "";
}

TEST(Spaces, TheNamesOfTheContractAreThere) {
    EXPECT_EQ(config().space("scene_linear"), "ACEScg");
    EXPECT_EQ(config().space("acescg"), "ACEScg");
    EXPECT_EQ(config().space("aces2065_1"), "ACES2065-1");
    EXPECT_EQ(config().space("lin_rec709"), "Linear Rec.709");
    EXPECT_EQ(config().space("lin_p3d65"), "Linear P3-D65");
    EXPECT_EQ(config().space("srgb_texture"), "sRGB texture");
    EXPECT_EQ(config().space("raw"), "raw");
}

TEST(Spaces, EveryNameListedNamesASpace) {
    const auto names = config().space_names();
    EXPECT_GT(names.size(), 60u);
    for (const std::string& name : names) EXPECT_NO_THROW(config().space(name)) << name;
}

TEST(Spaces, AMistypedNameIsAnsweredWithTheNearest) {
    EXPECT_EQ(usage_message([] { config().space("ACEScg2"); }),
              "color space \"ACEScg2\" is not in the built-in config; did you mean \"ACEScg\"?");
    EXPECT_EQ(usage_message([] { config().space("srbg_texture"); })
                  .substr(0, std::string("color space \"srbg_texture\" is not in the built-in "
                                         "config; did you mean \"srgb_texture\"")
                                 .size()),
              "color space \"srbg_texture\" is not in the built-in config; did you mean "
              "\"srgb_texture\"");
}

TEST(Spaces, APartOfANameIsAnsweredWithThoseThatHaveIt) {
    const std::string message = usage_message([] { config().space("sgamut3"); });
    EXPECT_NE(message.find("slog3_sgamut3\""), std::string::npos) << message;
    EXPECT_NE(message.find("slog3_sgamut3cine\""), std::string::npos) << message;
}

TEST(Spaces, ANameLikeNothingIsAnsweredWithoutASuggestion) {
    const std::string message = usage_message([] { config().space("qqqqqqqqqqqqqqqqqqqqqq"); });
    EXPECT_EQ(message.find("did you mean"), std::string::npos) << message;
    usage_message([] { config().space(""); });
}

struct Grey {
    const char* space;
    double encoded;  // what the maker's formula gives for 0.18
};

void PrintTo(const Grey& grey, std::ostream* out) { *out << grey.space; }

class MidGrey : public testing::TestWithParam<Grey> {};

TEST_P(MidGrey, IsEncodedAsTheMakerSays) {
    Image image = pixel_image({0.18f, 0.18f, 0.18f});
    config().from_working(image, GetParam().space);
    // 5e-5: the figures have four digits
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.row(0)[c], GetParam().encoded, 5e-5);
}

TEST_P(MidGrey, IsDecodedToMidGrey) {
    const auto value = static_cast<float>(GetParam().encoded);
    const Image image = config().to_working(pixel_photo({value, value, value}), GetParam().space);
    // 4e-4: half a unit of the fourth digit, on the steepest curve
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.row(0)[c], 0.18, 4e-4);
}

INSTANTIATE_TEST_SUITE_P(
    All, MidGrey,
    testing::Values(Grey{"ARRI LogC EI800", 0.3910}, Grey{"S-Log3 S-Gamut3", 0.41056},
                    Grey{"S-Log3 S-Gamut3.Cine", 0.41056}, Grey{"V-Log V-Gamut", 0.4233},
                    Grey{"Canon Log 2", 0.39825}, Grey{"Canon Log 3", 0.34339},
                    Grey{"Log3G10 REDWideGamutRGB", 0.33333}, Grey{"ACEScct", 0.41359},
                    Grey{"sRGB texture", 0.46136}, Grey{"Display P3 texture", 0.46136},
                    Grey{"Adobe RGB", 0.45853}, Grey{"Gamma 2.2 Rec.709 texture", 0.45866},
                    Grey{"Linear Rec.709", 0.18}, Grey{"Linear P3-D65", 0.18},
                    Grey{"Linear Rec.2020", 0.18}, Grey{"ACES2065-1", 0.18},
                    Grey{"scene_linear", 0.18}, Grey{"raw", 0.18}));

TEST(Spaces, EveryOneGivesBackWhatItTook) {
    for (const std::string& space : proper_names()) {
        // A monitor cannot show all of ACEScg: a colour inside its range.
        const bool display = space.find("Display") != std::string::npos && space[0] != 'D';
        const std::vector<float> color =
            display ? std::vector{0.3f, 0.25f, 0.28f} : std::vector{0.7f, 0.1f, 3.0f};
        Image image = pixel_image(color);
        config().from_working(image, space);
        const float* encoded = image.row(0);
        const Image back =
            config().to_working(pixel_photo({encoded[0], encoded[1], encoded[2]}), space);
        for (int c = 0; c < 3; ++c)
            // 3e-6 of the brightest: the slope of a log curve times float's rounding
            EXPECT_NEAR(back.row(0)[c], color[static_cast<std::size_t>(c)], 1e-5) << space;
    }
}

TEST(Spaces, WhiteStaysWhiteBetweenLinearSpaces) {
    for (const char* space : {"aces2065_1", "lin_rec709", "lin_p3d65", "lin_rec2020"}) {
        const Image image = config().to_working(pixel_photo({1, 1, 1}), space);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.row(0)[c], 1, 1e-6) << space;
    }
}

TEST(Spaces, TheRedOfRec709IsWhereAcesPutsIt) {
    // The first column of the matrix from BT.709 to AP1 with Bradford's adaptation, as published
    // with the ACES transforms.
    const Image image = config().to_working(pixel_photo({1, 0, 0}), "lin_rec709");
    EXPECT_NEAR(image.row(0)[0], 0.613097, 1e-5);
    EXPECT_NEAR(image.row(0)[1], 0.070194, 1e-5);
    EXPECT_NEAR(image.row(0)[2], 0.020616, 1e-5);
}

TEST(Spaces, LinearOnesAreKnownByWhatTheyDo) {
    for (const char* space : {"ACEScg", "ACES2065-1", "lin_rec709", "lin_p3d65", "lin_rec2020"})
        EXPECT_TRUE(config().is_linear(space)) << space;
    for (const char* space : {"sRGB texture", "Adobe RGB", "ACEScct", "ARRI LogC EI800",
                              "S-Log3 S-Gamut3", "Canon Log 3", "Log3G10 REDWideGamutRGB", "raw"})
        EXPECT_FALSE(config().is_linear(space)) << space;
}

TEST(Displays, HaveAnAcesAndAPlainView) {
    EXPECT_EQ(config().displays(), (std::vector<std::string>{"sRGB", "Rec.709"}));
    for (const std::string& display : config().displays())
        EXPECT_EQ(config().views(display),
                  (std::vector<std::string>{"ACES SDR", "Un-tone-mapped", "Raw"}));
}

TEST(Displays, ShowMidGreyAsExpected) {
    const auto shown = [](const char* display, const char* view) {
        Image image = pixel_image({0.18f, 0.18f, 0.18f});
        config().to_display(image, display, view);
        return image.row(0)[1];
    };
    EXPECT_NEAR(shown("sRGB", "ACES SDR"), 0.3560, 1e-4);
    EXPECT_NEAR(shown("srgb", "aces sdr"), 0.3560, 1e-4);
    EXPECT_NEAR(shown("sRGB", "Un-tone-mapped"), 0.46136, 1e-5);
    EXPECT_NEAR(shown("Rec.709", "Un-tone-mapped"), std::pow(0.18, 1 / 2.4), 1e-5);
    EXPECT_EQ(shown("sRGB", "Raw"), 0.18f);
}

TEST(Displays, AnUnknownOneIsAnsweredWithTheNearest) {
    Image image({1, 1}, 3);
    EXPECT_EQ(usage_message([&] { config().to_display(image, "sRGBB", "ACES SDR"); }),
              "display \"sRGBB\" is not in the built-in config; did you mean \"sRGB\"?");
    EXPECT_EQ(usage_message([&] { config().to_display(image, "sRGB", "ACES HDR"); }),
              "view \"ACES HDR\" is not in display \"sRGB\" of the built-in config; did you mean "
              "\"ACES SDR\"?");
    EXPECT_EQ(usage_message([&] { config().views("projector"); }),
              "display \"projector\" is not in the built-in config; choose \"sRGB\" or "
              "\"Rec.709\"");
}

}  // namespace
}  // namespace chromeball
