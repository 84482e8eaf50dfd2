#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "color/color.h"
#include "color/pictures.h"
#include "core/error.h"

namespace chromeball {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

const ColorConfig& config() {
    static const ColorConfig built_in = ColorConfig::built_in();
    return built_in;
}

/// The curve of IEC 61966-2-1, from encoded to linear.
double srgb_to_linear(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

void expect_pixel(const Image& image, int x, int y, const std::vector<double>& wanted,
                  double tolerance = 1e-6) {
    ASSERT_EQ(image.channels(), static_cast<int>(wanted.size()));
    for (std::size_t c = 0; c < wanted.size(); ++c)
        EXPECT_NEAR(image.pixel(x, y)[c], wanted[c], tolerance) << "channel " << c;
}

TEST(ToWorking, EightBitGreysFollowTheSrgbCurve) {
    std::vector<std::uint8_t> values;
    for (int i = 0; i < 256; ++i)
        for (int c = 0; c < 3; ++c) values.push_back(static_cast<std::uint8_t>(i));
    const Image image =
        config().to_working(photo_of<std::uint8_t>({256, 1}, 3, values), "srgb_texture");
    ASSERT_EQ(image.channels(), 3);
    for (int i = 0; i < 256; ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(image.pixel(i, 0)[c], srgb_to_linear(i / 255.0), 2e-6) << i;
}

TEST(ToWorking, TheWayNumbersAreStoredDoesNotMatter) {
    // Numbers that all four types hold exactly, or near enough: k / 255 = 257 k / 65535.
    const std::vector<std::uint8_t> u8 = {0, 51, 255, 102, 153, 204, 255, 0, 51};
    std::vector<std::uint16_t> u16;
    std::vector<Imath::half> f16;
    std::vector<float> f32;
    for (const std::uint8_t v : u8) {
        u16.push_back(static_cast<std::uint16_t>(v * 257));
        f16.push_back(static_cast<float>(v) / 255.0f);
        f32.push_back(static_cast<float>(v) / 255.0f);
    }
    const Size size{3, 1};
    for (const char* space : {"srgb_texture", "lin_rec709", "logc", "acescct", "raw", "acescg"}) {
        const Image a = config().to_working(photo_of(size, 3, u8), space);
        const Image b = config().to_working(photo_of(size, 3, u16), space);
        const Image c = config().to_working(photo_of(size, 3, f16), space);
        const Image d = config().to_working(photo_of(size, 3, f32), space);
        for (int i = 0; i < 9; ++i) {
            const float wanted = d.row(0)[i];
            const float scale = std::max(std::abs(wanted), 1.0f);
            EXPECT_NEAR(a.row(0)[i], wanted, 4e-6f * scale) << space;
            EXPECT_NEAR(b.row(0)[i], wanted, 4e-6f * scale) << space;
            // Half rounds by 2^-12 of the value, and a log curve of 10 stops' slope makes it 8e-3
            EXPECT_NEAR(c.row(0)[i], wanted, 8e-3f * scale) << space;
        }
    }
}

TEST(ToWorking, TheWorkingSpaceItselfIsCopied) {
    const Image image = config().to_working(pixel_photo({-1.5f, 0.25f, 70000.0f}), "acescg");
    expect_pixel(image, 0, 0, {-1.5, 0.25, 70000});
}

TEST(ToWorking, GreyBecomesThreeEqualChannels) {
    const double linear = srgb_to_linear(0.2);
    const Photo u8 = photo_of<std::uint8_t>({2, 1}, 1, {51, 255});
    expect_pixel(config().to_working(u8, "srgb_texture"), 0, 0, {linear, linear, linear}, 2e-6);
    expect_pixel(config().to_working(u8, "srgb_texture"), 1, 0, {1, 1, 1}, 2e-6);
    expect_pixel(config().to_working(u8, "raw"), 0, 0, {0.2, 0.2, 0.2});
    const Photo f32 = photo_of<float>({1, 1}, 1, {3});
    expect_pixel(config().to_working(f32, "scene_linear"), 0, 0, {3, 3, 3});
}

TEST(ToWorking, GreyWithAlphaBecomesFourChannels) {
    Photo photo = photo_of<std::uint16_t>({1, 1}, 2, {13107, 52428});
    photo.associated_alpha = false;
    const double linear = srgb_to_linear(0.2) * 0.8;
    expect_pixel(config().to_working(photo, "srgb_texture"), 0, 0, {linear, linear, linear, 0.8},
                 2e-6);
}

TEST(ToWorking, UnassociatedColorIsDecodedThenMultiplied) {
    for (const float alpha : {0.0f, 0.25f, 1.0f}) {
        Photo photo = pixel_photo({0.5f, 0.5f, 0.5f, alpha});
        photo.associated_alpha = false;
        const double linear = srgb_to_linear(0.5) * alpha;
        expect_pixel(config().to_working(photo, "srgb_texture"), 0, 0,
                     {linear, linear, linear, alpha});
    }
}

TEST(ToWorking, AssociatedColorIsDividedDecodedAndMultiplied) {
    const double linear = srgb_to_linear(0.6) * 0.5;
    expect_pixel(config().to_working(pixel_photo({0.3f, 0.3f, 0.3f, 0.5f}), "srgb_texture"), 0, 0,
                 {linear, linear, linear, 0.5});
    // 8-bit numbers: 51 / 102 = 0.5
    const Photo u8 = photo_of<std::uint8_t>({1, 1}, 4, {51, 51, 51, 102});
    const double half = srgb_to_linear(0.5) * 0.4;
    expect_pixel(config().to_working(u8, "srgb_texture"), 0, 0, {half, half, half, 0.4}, 2e-6);
}

TEST(ToWorking, AssociatedColorWithoutAlphaIsNothingInAnEncodedSpace) {
    for (const float alpha : {0.0f, 1e-42f})
        expect_pixel(config().to_working(pixel_photo({0.5f, 0.5f, 0.5f, alpha}), "logc"), 0, 0,
                     {0, 0, 0, 0});
}

TEST(ToWorking, GlowWithoutAlphaSurvivesInALinearSpace) {
    // Associated colour above alpha is light without cover: legal, and kept.
    expect_pixel(config().to_working(pixel_photo({2, 2, 2, 0}), "aces2065_1"), 0, 0, {2, 2, 2, 0},
                 4e-6);
}

TEST(ToWorking, OnlyTheRegionIsConverted) {
    std::vector<std::uint8_t> values;
    for (int i = 0; i < 5 * 4; ++i)
        for (int c = 0; c < 3; ++c) values.push_back(static_cast<std::uint8_t>(i * 10));
    Photo photo = photo_of<std::uint8_t>({5, 4}, 3, values);
    photo.window.x = 100;  // the photo lies at (100, 200) of its display window
    photo.window.y = 200;
    const auto grey_at = [&](const Image& image, int x, int y) {
        return std::lround(image.pixel(x, y)[0] * 255);
    };
    const Image inside = config().to_working(photo, "raw", Window{101, 202, {3, 2}});
    EXPECT_EQ(inside.size(), (Size{3, 2}));
    EXPECT_EQ(grey_at(inside, 0, 0), 110);
    EXPECT_EQ(grey_at(inside, 2, 1), 180);

    const Image cut = config().to_working(photo, "raw", Window{98, 203, {4, 100}});
    EXPECT_EQ(cut.size(), (Size{2, 1}));
    EXPECT_EQ(grey_at(cut, 1, 0), 160);

    EXPECT_TRUE(config().to_working(photo, "raw", Window{0, 0, {50, 50}}).empty());
    const int far = std::numeric_limits<int>::max();
    EXPECT_TRUE(config().to_working(photo, "raw", Window{far, far, {far, far}}).empty());
    EXPECT_EQ(config().to_working(photo, "raw", Window{-5, -5, {far, far}}).size(),
              photo.window.size);
}

TEST(ToWorking, ARegionIsWhatTheWholeHasThere) {
    std::vector<std::uint16_t> values;
    for (int i = 0; i < 70 * 50 * 4; ++i)
        values.push_back(static_cast<std::uint16_t>(i * 7919 % 65536));
    Photo photo = photo_of<std::uint16_t>({70, 50}, 4, values);
    photo.associated_alpha = false;
    const Image whole = config().to_working(photo, "srgb_texture");
    const Image part = config().to_working(photo, "srgb_texture", Window{13, 7, {20, 30}});
    for (int y = 0; y < 30; ++y)
        for (int i = 0; i < 20 * 4; ++i)
            EXPECT_EQ(part.row(y)[i], whole.pixel(13, 7 + y)[i]) << y << " " << i;
}

TEST(ToWorking, ManyBandsGiveWhatOnePixelGives) {
    // 700 rows of 300: several bands, on several threads
    Photo photo = photo_of<std::uint8_t>({300, 700}, 1, std::vector<std::uint8_t>(300 * 700, 51));
    const Image image = config().to_working(photo, "srgb_texture");
    const float first = image.pixel(0, 0)[0];
    for (int y = 0; y < 700; ++y)
        for (int x = 0; x < 300; ++x) ASSERT_EQ(image.pixel(x, y)[2], first) << x << " " << y;
}

TEST(ToWorking, BadPixelsBecomeNothingAndAreCounted) {
    const Photo photo =
        photo_of<float>({4, 1}, 3, {1, 2, 3, kNan, 1, 1, 1, -kInfinity, 1, 0.5f, 0.5f, 0.5f});
    for (const char* space : {"acescg", "lin_rec709"}) {
        std::size_t bad = 0;
        const Image image = config().to_working(photo, space, {}, &bad);
        EXPECT_EQ(bad, 2u);
        ASSERT_EQ(image.channels(), 4);
        EXPECT_EQ(image.pixel(0, 0)[3], 1);
        expect_pixel(image, 1, 0, {0, 0, 0, 0});
        expect_pixel(image, 2, 0, {0, 0, 0, 0});
        expect_pixel(image, 3, 0, {0.5, 0.5, 0.5, 1});
    }
}

TEST(ToWorking, BadPixelsAreFoundBehindTransformsThatHideThem) {
    // A table for half numbers and a clamping curve may turn a NaN into a number.
    const Imath::half nan = Imath::half::qNan(), infinity = Imath::half::posInf();
    const Photo photo = photo_of<Imath::half>(
        {3, 1}, 4, {nan, 0.5f, 0.5f, 1.0f, 0.5f, infinity, 0.5f, 1.0f, 0.5f, 0.5f, 0.5f, nan});
    for (const char* space : {"srgb_texture", "logc", "acescct", "acescg"}) {
        std::size_t bad = 0;
        const Image image = config().to_working(photo, space, {}, &bad);
        EXPECT_EQ(bad, 3u) << space;
        for (int x = 0; x < 3; ++x) expect_pixel(image, x, 0, {0, 0, 0, 0});
    }
}

TEST(ToWorking, NumbersThatDecodeToInfinityAreBad) {
    std::size_t bad = 0;
    const Image image = config().to_working(pixel_photo({1000, 0.4f, 0.4f}), "logc", {}, &bad);
    EXPECT_EQ(bad, 1u);
    expect_pixel(image, 0, 0, {0, 0, 0, 0});
}

TEST(ToWorking, GoodPhotosHaveNoBadPixelsAndNoExtraAlpha) {
    std::size_t bad = 7;
    const Image image = config().to_working(pixel_photo({1, 1, 1}), "acescg", {}, &bad);
    EXPECT_EQ(bad, 0u);
    EXPECT_EQ(image.channels(), 3);
}

TEST(ToWorking, AnUnknownSpaceIsAnError) {
    EXPECT_THROW(config().to_working(pixel_photo({1, 1, 1}), "nonsense"), Error);
}

}  // namespace
}  // namespace chromeball
