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

TEST(Track, NothingIsExpectedBetweenTheTwoSidesOfACut) {
    const Outline before{100, 50, 40, 39, 20};
    EXPECT_FALSE(outline_between(before, {100, 50, 100, 98, 20}, 0.5));
    EXPECT_FALSE(outline_between(before, {700, 50, 40, 39, 20}, 0.5));
}

TEST(Track, APartOfAPhotoHasThePixelsOfItsWindow) {
    Photo photo;
    photo.type = PixelType::u16;
    photo.channels = 3;
    photo.window = {10, 20, {8, 6}};
    photo.display = {100, 100};
    photo.pixels.resize(8 * 6 * 6);
    for (std::size_t i = 0; i < photo.pixels.size(); ++i) photo.pixels[i] = std::byte(i % 251);
    const Window windows[] = {
        {12, 21, {5, 3}}, {10, 20, {8, 6}}, {17, 25, {1, 1}}, {10, 22, {8, 4}}};
    for (const Window& window : windows) {
        const Photo part = part_of(photo, window);
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

}  // namespace
}  // namespace chromeball
