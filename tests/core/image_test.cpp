#include "core/image.h"

#include <gtest/gtest.h>

#include "core/outline.h"
#include "core/photo.h"

namespace chromeball {
namespace {

TEST(Size, CountsPixelsBeyondTheRangeOfInt) {
    EXPECT_EQ((Size{100000, 100000}).pixels(), 10'000'000'000U);
    EXPECT_EQ(Size{}.pixels(), 0U);
}

TEST(Image, StartsBlackAndTransparent) {
    const Image image({3, 2}, 4);
    EXPECT_FALSE(image.empty());
    for (int y = 0; y < 2; ++y)
        for (int i = 0; i < 12; ++i) EXPECT_EQ(image.row(y)[i], 0.0F);
    EXPECT_TRUE(Image().empty());
}

TEST(Image, HoldsPixelsInterleavedInRowsFromTopToBottom) {
    Image image({3, 2}, 4);
    image.pixel(2, 1)[3] = 7;
    EXPECT_EQ(image.row(0)[1 * 12 + 2 * 4 + 3], 7.0F);
    EXPECT_EQ(image.row(1)[2 * 4 + 3], 7.0F);
    EXPECT_EQ(image.width(), 3);
    EXPECT_EQ(image.height(), 2);
    EXPECT_EQ(image.channels(), 4);
    EXPECT_EQ(image.size(), (Size{3, 2}));
}

TEST(Image, IsCopiedWithItsPixels) {
    Image one({2, 2}, 3);
    one.pixel(1, 1)[0] = 1;
    Image two = one;
    two.pixel(1, 1)[0] = 2;
    EXPECT_EQ(one.pixel(1, 1)[0], 1.0F);
    EXPECT_EQ(two.pixel(1, 1)[0], 2.0F);
}

TEST(ImageView, OfAPartSkipsTheRestOfEachRow) {
    Image image({4, 3}, 1);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x) *image.pixel(x, y) = static_cast<float>(10 * y + x);
    const ImageView<const float> part{image.pixel(1, 1), {2, 2}, 1, image.view().stride};
    EXPECT_EQ(*part.pixel(0, 0), 11.0F);
    EXPECT_EQ(*part.pixel(1, 1), 22.0F);
}

TEST(ImageView, WritesThrough) {
    Image image({2, 1}, 3);
    image.view().pixel(1, 0)[2] = 5;
    const ImageView<const float> seen = image.view();
    EXPECT_EQ(seen.row(0)[5], 5.0F);
}

TEST(PixelType, KnowsItsBytesAndWhetherItIsInteger) {
    EXPECT_EQ(bytes_per_value(PixelType::u8), 1U);
    EXPECT_EQ(bytes_per_value(PixelType::u16), 2U);
    EXPECT_EQ(bytes_per_value(PixelType::f16), 2U);
    EXPECT_EQ(bytes_per_value(PixelType::f32), 4U);
    EXPECT_TRUE(is_integer(PixelType::u8) && is_integer(PixelType::u16));
    EXPECT_FALSE(is_integer(PixelType::f16) || is_integer(PixelType::f32));
}

TEST(Outline, HasTheAreaOfAnEllipse) {
    EXPECT_DOUBLE_EQ(area({10, 20, 3, 2, 45}), 6 * std::numbers::pi);
}

}  // namespace
}  // namespace chromeball
