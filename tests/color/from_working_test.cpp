#include <gtest/gtest.h>

#include <cmath>

#include "color/color.h"
#include "color/pictures.h"
#include "core/error.h"

namespace chromeball {
namespace {

const ColorConfig& config() {
    static const ColorConfig built_in = ColorConfig::built_in();
    return built_in;
}

TEST(FromWorking, TheWorkingSpaceChangesNothing) {
    Image image = pixel_image({-1, 0.3f, 70000, 0.5f});
    config().from_working(image, "scene_linear");
    for (const auto& [i, wanted] : {std::pair{0, -1.0f}, {1, 0.3f}, {2, 70000.0f}, {3, 0.5f}})
        EXPECT_EQ(image.row(0)[i], wanted);
}

TEST(FromWorking, AlphaIsDividedOutAroundACurve) {
    Image image = pixel_image({0.09f, 0.09f, 0.09f, 0.5f});
    config().from_working(image, "srgb_texture");
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.row(0)[c], 0.46136 * 0.5, 1e-5);
    EXPECT_EQ(image.row(0)[3], 0.5f);
}

TEST(FromWorking, NothingStaysNothing) {
    // In a log space black is not 0; without cover it must not appear.
    Image image = pixel_image({0, 0, 0, 0});
    config().from_working(image, "logc");
    for (int c = 0; c < 4; ++c) EXPECT_EQ(image.row(0)[c], 0);
}

TEST(FromWorking, LinearSpacesKeepLightWithoutCover) {
    Image image = pixel_image({2, 2, 2, 0});
    config().from_working(image, "lin_rec709");
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.row(0)[c], 2, 4e-6);
}

TEST(FromWorking, EveryRowOfALargeImageIsConverted) {
    Image image({500, 300}, 3);
    for (int y = 0; y < 300; ++y)
        for (int i = 0; i < 1500; ++i) image.row(y)[i] = 0.18f;
    config().from_working(image, "srgb_texture");
    for (int y = 0; y < 300; ++y)
        for (int i = 0; i < 1500; ++i) ASSERT_NEAR(image.row(y)[i], 0.46136f, 1e-5) << y;
}

TEST(FromWorking, AnEmptyImageStaysEmpty) {
    Image image;
    EXPECT_NO_THROW(config().from_working(image, "srgb_texture"));
    EXPECT_TRUE(image.empty());
}

TEST(FromWorking, AnUnknownSpaceIsAnError) {
    Image image({1, 1}, 3);
    EXPECT_THROW(config().from_working(image, "nonsense"), Error);
}

TEST(ToDisplay, AlphaIsDividedOutAroundTheView) {
    Image image = pixel_image({0.09f, 0.09f, 0.09f, 0.5f});
    config().to_display(image, "sRGB", "ACES SDR");
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.row(0)[c], 0.3560 * 0.5, 1e-4);
}

TEST(ToDisplay, BrightLightIsBroughtDownToTheDisplay) {
    Image image = pixel_image({5000, 3000, 100});
    config().to_display(image, "sRGB", "ACES SDR");
    for (int c = 0; c < 3; ++c) {
        EXPECT_GE(image.row(0)[c], 0);
        EXPECT_LE(image.row(0)[c], 1.05);  // the curve of ACES ends a little above white
    }
}

}  // namespace
}  // namespace chromeball
