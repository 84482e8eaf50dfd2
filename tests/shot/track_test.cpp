#include "shot/track.h"

#include <gtest/gtest.h>

namespace chromeball {
namespace {

TEST(Track, ABallIsExpectedOnTheWayFromOneKeyFrameToTheNext) {
    const auto at = [](double part) {
        return outline_between({100, 50, 40, 40, 0}, {180, 30, 60, 60, 0}, part);
    };
    ASSERT_TRUE(at(0.25));
    EXPECT_DOUBLE_EQ(at(0.25)->cx, 120);
    EXPECT_DOUBLE_EQ(at(0.25)->cy, 45);
    EXPECT_DOUBLE_EQ(at(0.25)->a, 45);
    EXPECT_DOUBLE_EQ(at(0.25)->b, 45);
    EXPECT_DOUBLE_EQ(at(1)->cx, 180);
}

TEST(Track, ABallGoesOnAsItWentForAWhile) {
    const Outline before{100, 50, 40, 40, 0}, last{180, 30, 60, 60, 0};
    const auto on = outline_between(before, last, 2);
    ASSERT_TRUE(on);
    EXPECT_DOUBLE_EQ(on->cx, 260);
    EXPECT_DOUBLE_EQ(on->cy, 10);
    EXPECT_DOUBLE_EQ(on->a, 80);
    EXPECT_FALSE(outline_between(before, last, 3.1));
    EXPECT_FALSE(outline_between(last, before, 3));  // would vanish
}

TEST(Track, AWeakBallIsBelievedBesideASureOneOfItsSize) {
    EXPECT_TRUE(may_be_same({100, 50, 40, 39, 20}, {130, 60, 45, 44, 0}));
    EXPECT_FALSE(may_be_same({100, 50, 40, 39, 20}, {141, 50, 40, 39, 20}));
    EXPECT_FALSE(may_be_same({100, 50, 40, 39, 20}, {100, 50, 51, 50, 20}));
}

TEST(Track, MotionsAreMixedWhicheverWayRoundTheyWereSeen) {
    for (const double sign : {1.0, -1.0}) {
        const auto motion = motion_between(V2d(40, 10), V2d(sign * 48, sign * 6), 0.25);
        ASSERT_TRUE(motion);
        EXPECT_DOUBLE_EQ(motion->x, 42);
        EXPECT_DOUBLE_EQ(motion->y, 9);
    }
    ASSERT_TRUE(motion_between(V2d(0, 0), V2d(0, 0), 0.5));
    EXPECT_EQ(motion_between(V2d(0, 0), V2d(0, 0), 0.5)->length(), 0);
    // From rest to speed anything may lie between, and so where it turns.
    EXPECT_FALSE(motion_between(V2d(0, 0), V2d(30, 0), 0.5));
    EXPECT_FALSE(motion_between(V2d(30, 0), V2d(0, 30), 0.5));
}

TEST(Track, NothingIsExpectedBetweenTheTwoSidesOfACut) {
    const Outline before{100, 50, 40, 39, 20};
    EXPECT_FALSE(outline_between(before, {100, 50, 100, 98, 20}, 0.5));
    EXPECT_FALSE(outline_between(before, {700, 50, 40, 39, 20}, 0.5));
}

/// 16 bits, 3 channels, 8x6 pixels at 10, 20; every byte differs from those around it.
Photo small_photo() {
    Photo photo;
    photo.type = PixelType::u16;
    photo.channels = 3;
    photo.window = {10, 20, {8, 6}};
    photo.display = {100, 100};
    photo.pixels.resize(8 * 6 * 6);
    for (std::size_t i = 0; i < photo.pixels.size(); ++i) photo.pixels[i] = std::byte(i % 251);
    return photo;
}

TEST(Track, APartOfAPhotoHasThePixelsOfItsWindow) {
    const Photo photo = small_photo();
    Photo description = photo;
    description.pixels.clear();
    const Window windows[] = {
        {12, 21, {5, 3}}, {10, 20, {8, 6}}, {17, 25, {1, 1}}, {10, 22, {8, 4}}};
    for (const Window& window : windows) {
        Photo part = empty_part(description, window);
        copy_shared(photo, part);
        EXPECT_EQ(part.window, window);
        EXPECT_EQ(part.display, photo.display);
        ASSERT_EQ(part.pixels.size(), window.size.pixels() * 6);
        for (int y = 0; y < window.size.height; ++y)
            for (int x = 0; x < window.size.width * 6; ++x) {
                const int from = (window.y - 20 + y) * 48 + (window.x - 10) * 6 + x;
                EXPECT_EQ(part.pixels[static_cast<std::size_t>(y * window.size.width * 6 + x)],
                          std::byte(from % 251));
            }
    }
}

TEST(Track, APartOfAPhotoIsPutTogetherFromBands) {
    const Photo photo = small_photo();
    Photo band = photo, part = empty_part(photo, {-50, 22, {64, 100}});
    EXPECT_EQ(part.window, (Window{10, 22, {4, 4}}));
    Photo whole = part;
    copy_shared(photo, whole);
    for (int y = 20; y < 26; y += 2) {
        band.window = {10, y, {8, 2}};
        band.pixels.assign(photo.pixels.begin() + (y - 20) * 48,
                           photo.pixels.begin() + (y - 18) * 48);
        copy_shared(band, part);
    }
    EXPECT_TRUE(part.pixels == whole.pixels);
}

TEST(Track, WindowsThatShareNothingGiveNoPixels) {
    Photo part = empty_part(small_photo(), {30, 22, {5, 5}});
    EXPECT_EQ(part.window.size.pixels(), 0u);
    copy_shared(small_photo(), part);
    EXPECT_TRUE(part.pixels.empty());
    EXPECT_EQ(shared_window({0, 0, {5, 5}}, {3, 9, {5, 5}}).size.height, 0);
}

}  // namespace
}  // namespace chromeball
