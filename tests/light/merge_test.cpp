#include "light/merge.h"

#include <gtest/gtest.h>

#include <limits>

#include "light/bracket_scene.h"

namespace chromeball {
namespace {

using namespace test;

constexpr Size kSize{240, 160};
constexpr Window kAll{0, 0, kSize};

std::vector<Take> stops(const std::vector<double>& values) {
    std::vector<Take> takes;
    for (const double s : values) takes.push_back({std::exp2(s)});
    return takes;
}

TEST(Merge, GivesTheSceneOverMoreStopsThanAPhotoHas) {
    const auto takes = stops({-4, -2, 0, 2});
    const auto photos = photos_of(textured, kSize, takes);
    const Merged merged = merge(to_merge(photos, takes), Response::srgb());
    EXPECT_LT(rms_stops(merged.pixels, textured, kAll), 0.02);
    EXPECT_EQ(merged.clipped_everywhere, 0U);
    EXPECT_EQ(merged.black_everywhere, 0U);
}

TEST(Merge, DoesNotDependOnTheOrder) {
    const auto takes = stops({-4, -2, 0, 2});
    auto photos = to_merge(photos_of(textured, kSize, takes), takes);
    const Merged one = merge(photos, Response::srgb());
    std::swap(photos[0], photos[3]);
    std::swap(photos[1], photos[3]);
    const Merged other = merge(photos, Response::srgb());
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width * 4; ++x)
            ASSERT_EQ(one.pixels.row(y)[x], other.pixels.row(y)[x]) << x << ", " << y;
}

TEST(Merge, IsLessNoisyThanItsBestPhoto) {
    std::vector<Take> takes(4, Take{0.5, {0, 0}, srgb_encoded, false, 0.01});
    const auto grey = [](double, double) { return Rgb{0.5, 0.5, 0.5}; };
    const auto photos = photos_of(grey, kSize, takes);
    const double one =
        rms_stops(merge(to_merge({photos[0]}, takes), Response::linear()).pixels, grey, kAll);
    const double four =
        rms_stops(merge(to_merge(photos, takes), Response::linear()).pixels, grey, kAll);
    EXPECT_NEAR(four / one, 0.5, 0.03);  // 1 / sqrt(4)
}

TEST(Merge, LinearFloatsStayExact) {
    std::vector<Take> takes = stops({-4, -2});
    for (Take& take : takes) take.integers = false, take.noise = 0;
    const auto photos = photos_of(textured, kSize, takes);
    const Merged merged = merge(to_merge(photos, takes), Response::linear());
    EXPECT_LT(rms_stops(merged.pixels, textured, kAll), 1e-5);
}

/// The textured scene with a lamp of a hundred times what any exposure here holds.
Rgb with_lamp(double x, double y) {
    if (std::hypot(x - 100.5, y - 80.5) < 3) return {400, 300, 0.05};
    return textured(x, y);
}

TEST(Merge, MarksWhatClipsInAllExposures) {
    const auto takes = stops({-4, -1, 2});
    const auto photos = photos_of(with_lamp, kSize, takes);
    const Merged merged = merge(to_merge(photos, takes), Response::srgb());
    std::size_t lamp = 0;
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x) {
            const bool inside = std::hypot(x + 0.5 - 100.5, y + 0.5 - 80.5) < 3;
            lamp += inside;
            const float* p = merged.pixels.pixel(x, y);
            if (!inside) {
                EXPECT_GT(p[3], 0) << x << ", " << y;
                continue;
            }
            EXPECT_EQ(p[3], 0);
            EXPECT_GE(p[0], 16);  // what fills the shortest: 1 / 2^-4
            EXPECT_GE(p[1], 16);
            EXPECT_NEAR(p[2], 0.05, 0.02);  // blue does not clip: channel by channel
        }
    EXPECT_EQ(merged.clipped_everywhere, lamp);
    EXPECT_EQ(merged.brightest_pixels, lamp);
    EXPECT_NEAR(merged.brightest.x, 100.5, 0.01);
    EXPECT_NEAR(merged.brightest.y, 80.5, 0.01);
}

TEST(Merge, BesideALampDoesNotBelieveWhatOnlyTheLongExposureShows) {
    // JPEG smears colour: in the long exposure the lamp's blue seems not to clip.
    const auto lamp = [](double, double) { return Rgb{4, 4, 4}; };
    const auto takes = stops({-1, 3});
    auto photos = photos_of(lamp, kSize, takes);
    photos[1].read = [](int first, int last, ImageView<float> rows) {
        for (int y = 0; y < last - first; ++y)
            for (int x = 0; x < rows.size.width; ++x) {
                rows.pixel(x, y)[0] = rows.pixel(x, y)[1] = 1;
                rows.pixel(x, y)[2] = 0.6f;
            }
    };
    const Merged merged = merge(to_merge(photos, takes), Response::srgb());
    for (std::size_t c = 0; c < 3; ++c) EXPECT_GE(merged.pixels.pixel(120, 80)[c], 1.99f);
}

TEST(Merge, MarksWhatIsBlackInAllExposures) {
    const auto night = [](double x, double y) {
        return x < 120 ? Rgb{1e-7, 1e-7, 1e-7} : textured(x, y);
    };
    const auto takes = stops({-4, -2});
    const auto photos = photos_of(night, kSize, takes);
    const Merged merged = merge(to_merge(photos, takes), Response::srgb());
    EXPECT_GT(merged.black_everywhere, 120U * 160U * 7 / 10);
    EXPECT_LE(merged.black_everywhere, 120U * 160U);
    EXPECT_EQ(merged.clipped_everywhere, 0U);
}

TEST(Merge, LeavesOutWhoWalkedThroughOneExposure) {
    const auto takes = stops({-3, -1.5, 0, 1.5});
    const auto walker = [](double x, double y) {
        return x > 90 && x < 140 && y > 40 && y < 140 ? Rgb{0.05, 0.04, 0.03} : textured(x, y);
    };
    auto photos = photos_of(textured, kSize, takes);
    photos[1] = photo_of(walker, kSize, takes[1], 9);
    const Merged merged = merge(to_merge(photos, takes), Response::srgb());
    EXPECT_LT(rms_stops(merged.pixels, textured, kAll), 0.03);
    const double there = 50.0 * 100 / (240 * 160);
    EXPECT_GT(merged.moved[1], 0.9 * there);
    EXPECT_LT(merged.moved[1], 2 * there);
    for (const std::size_t k : {0U, 2U, 3U}) EXPECT_LT(merged.moved[k], 0.02) << k;
}

TEST(Merge, OfTwoThatContradictEachOtherOneCountsAndNoMixture) {
    const auto here = [](double x, double) {
        return x > 60 && x < 160 ? Rgb{0.5, 0.5, 0.5} : Rgb{0.2, 0.2, 0.2};
    };
    const auto away = [](double, double) { return Rgb{0.2, 0.2, 0.2}; };
    const auto takes = stops({-1, 0});
    const std::vector<ExposedPhoto> photos{photo_of(here, kSize, takes[0], 1),
                                           photo_of(away, kSize, takes[1], 2)};
    const Merged merged = merge(to_merge(photos, takes), Response::srgb());
    int mixed = 0;
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 76; x < 144; ++x) {  // away from the edge by two cells
            const float v = merged.pixels.pixel(x, y)[1];
            mixed += v > 0.24f && v < 0.45f;
        }
    EXPECT_EQ(mixed, 0);
}

TEST(Merge, UndoesShiftsOfFractionsOfAPixel) {
    const std::vector<Take> takes{{0.1, {0, 0}}, {0.5, {5.4, -3.3}}, {2, {-2.5, 7.25}}};
    auto photos = to_merge(photos_of(textured, kSize, takes), takes);
    constexpr Window kInside{20, 20, {200, 120}};
    const double found = rms_stops(merge(photos, Response::srgb()).pixels, textured, kInside);
    // Catmull and Rom's filter loses a little of the finest texture (a wave of 7 pixels).
    EXPECT_LT(found, 0.03);
    for (MergePhoto& photo : photos) photo.shift = V2d(0, 0);
    EXPECT_GT(rms_stops(merge(photos, Response::srgb()).pixels, textured, kInside), 3 * found);
}

TEST(Merge, WhatOnePhotoDoesNotReachComesFromTheOthers) {
    const std::vector<Take> takes{{0.06, {0, 0}}, {0.12, {100, 0}}};
    const auto photos = to_merge(photos_of(textured, kSize, takes), takes);
    const Merged merged = merge(photos, Response::srgb());
    constexpr Window kRight{200, 10, {35, 140}};  // beyond the second photo
    EXPECT_LT(rms_stops(merged.pixels, textured, kRight), 0.05);
}

TEST(Merge, NumbersThatAreNoneNeverComeOut) {
    auto takes = stops({-4, -2});
    for (Take& take : takes) take.integers = false;
    auto photos = photos_of(textured, kSize, takes);
    const auto read = photos[0].read;
    photos[0].read = [read](int first, int last, ImageView<float> rows) {
        read(first, last, rows);
        rows.pixel(7, 0)[1] = std::numeric_limits<float>::quiet_NaN();
        rows.pixel(9, 0)[0] = std::numeric_limits<float>::infinity();
    };
    const Merged merged = merge(to_merge(photos, takes), Response::linear());
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width * 4; ++x)
            ASSERT_TRUE(std::isfinite(merged.pixels.row(y)[x]));
    EXPECT_LT(rms_stops(merged.pixels, textured, kAll), 0.05);
}

TEST(Merge, WhereOneChannelOfASumClipsAllAreLeftOut) {
    // Green clips in the long exposure; red and blue do not.
    const auto green = [](double, double) { return Rgb{0.2, 0.9, 0.2}; };
    std::vector<Take> takes = stops({-1, 1});
    for (Take& take : takes) take.integers = false, take.noise = 0;
    auto photos = to_merge(photos_of(green, kSize, takes), takes);
    // The long one's red is wrong where green clips.
    const auto read = photos[1].photo.read;
    photos[1].photo.read = [read](int first, int last, ImageView<float> rows) {
        read(first, last, rows);
        for (int y = 0; y < last - first; ++y)
            for (int x = 0; x < rows.size.width; ++x) rows.pixel(x, y)[0] *= 1.1f;
    };
    EXPECT_GT(merge(photos, Response::linear()).pixels.pixel(50, 50)[0], 0.21f);
    for (MergePhoto& photo : photos) photo.photo.mixed = true;
    EXPECT_NEAR(merge(photos, Response::linear()).pixels.pixel(50, 50)[0], 0.2f, 1e-4f);
}

}  // namespace
}  // namespace chromeball
