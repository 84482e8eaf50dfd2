#include <gtest/gtest.h>

#include <limits>

#include "detect/detect.h"
#include "detect/painted.h"

namespace chromeball {
namespace {

Photo grey_photo(PixelType type) {
    Photo photo = painted::empty_photo({200, 120}, type, 3);
    std::fill(photo.pixels.begin(), photo.pixels.end(), std::byte{0x3c});
    return photo;
}

/// Sum of differences between two pictures' channels at a pixel.
int change(const Photo& photo, int x, int y, int background) {
    int sum = 0;
    for (int c = 0; c < 3; ++c)
        sum += std::abs(
            std::to_integer<int>(photo.pixels[static_cast<std::size_t>((y * 200 + x) * 3 + c)]) -
            background);
    return sum;
}

TEST(Overlay, TheOutlineIsDrawnWhereItIsAndTheRestIsThePhoto) {
    const Candidate ball{.outline = {100.5, 60.5, 40, 30, 0}, .confidence = 0.9};
    const Photo out = overlay(grey_photo(PixelType::u8), {ball}, 0.5);
    EXPECT_EQ(out.type, PixelType::u8);
    EXPECT_EQ(out.channels, 3);
    EXPECT_EQ(out.window.size, (Size{200, 120}));
    // The rim passes the middles of the pixels (140, 60), (60, 60), (100, 30) and (100, 90).
    for (const auto& [x, y] : {std::pair{140, 60}, {60, 60}, {100, 30}, {100, 90}}) {
        EXPECT_GT(change(out, x, y, 0x3c), 100) << x << ' ' << y;
    }
    EXPECT_EQ(change(out, 100, 25, 0x3c), 0);
    EXPECT_EQ(change(out, 147, 60, 0x3c), 0);
    EXPECT_EQ(change(out, 5, 5, 0x3c), 0);
    EXPECT_GT(change(out, 100, 60, 0x3c), 100) << "the centre";
}

TEST(Overlay, FloatsKeepTheirColoursAndOddOnesDoNoHarm) {
    const Size size{80, 60};
    std::vector<float> light;
    for (std::size_t i = 0; i < size.pixels(); ++i)
        light.insert(light.end(), {0.6F, 0.2F, 0.1F + 0.001F * static_cast<float>(i % 80)});
    light[0] = std::numeric_limits<float>::quiet_NaN();
    light[3] = -1;
    const Photo out = overlay(painted::float_photo(light, size), {}, 0.5);
    const std::size_t at = 3 * (30 * 80 + 20);
    const auto code = [&](std::size_t i) { return std::to_integer<int>(out.pixels[i]); };
    EXPECT_GT(code(at), code(at + 1) + 20);
    EXPECT_GT(code(at + 1), code(at + 2) + 5);
    EXPECT_EQ(code(0), code(1));
    EXPECT_EQ(code(3), code(4));
}

TEST(Overlay, CoordinatesAreThoseOfTheDisplayWindow) {
    Photo photo = grey_photo(PixelType::u8);
    photo.window.x = 50;
    const Candidate ball{.outline = {150.5, 60.5, 30, 30, 0}, .confidence = 0.9};
    const Photo out = overlay(photo, {ball}, 0.5);
    EXPECT_GT(change(out, 130, 60, 0x3c), 100);
    EXPECT_EQ(out.window, photo.window);
}

TEST(Overlay, AFoundBallAndADoubtfulOneHaveDifferentColours) {
    Candidate ball{.outline = {100.5, 60.5, 40, 30, 0}, .confidence = 0.9};
    const Photo sure = overlay(grey_photo(PixelType::u8), {ball}, 0.5);
    ball.confidence = 0.3;
    const Photo doubtful = overlay(grey_photo(PixelType::u8), {ball}, 0.5);
    const auto at = static_cast<std::size_t>((60 * 200 + 140) * 3);
    EXPECT_GT(sure.pixels[at + 1], sure.pixels[at]);
    EXPECT_GT(doubtful.pixels[at], doubtful.pixels[at + 1]);
}

TEST(Overlay, EveryKindOfPixelAndNoCandidateWillDo) {
    for (const PixelType type : {PixelType::u8, PixelType::u16, PixelType::f16, PixelType::f32})
        EXPECT_EQ(overlay(grey_photo(type), {}, 0.5).pixels.size(), 200u * 120u * 3u);
    EXPECT_TRUE(overlay(painted::empty_photo({0, 0}, PixelType::u8, 3), {}, 0.5).pixels.empty());
}

TEST(Overlay, AnOutlineFarOutsideIsNoError) {
    const Candidate ball{.outline = {-5000, 90000, 4000, 3900, 30}, .confidence = 0.9};
    EXPECT_EQ(overlay(grey_photo(PixelType::u8), {ball}, 0.5).pixels,
              overlay(grey_photo(PixelType::u8), {}, 0.5).pixels);
}

}  // namespace
}  // namespace chromeball
