#include "render/patch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/patch_match.h"
#include "render/sampling.h"

namespace chromeball {
namespace {

/// A world of a formula with a ball of another colour in front of it.
template <class World>
Image with_ball(Size size, const Outline& ball, const World& world) {
    Image picture(size, 4);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const bool in_ball = std::hypot(x + 0.5 - ball.cx, y + 0.5 - ball.cy) < ball.a + 1;
            for (int c = 0; c < 3; ++c) picture.pixel(x, y)[c] = in_ball ? 50.0F : world(x, y);
            picture.pixel(x, y)[3] = 1;
        }
    return picture;
}

TEST(PaintOut, ContinuesASlopeThroughTheBall) {
    const auto slope = [](int x, int y) { return 0.4F + 0.004F * float(x) - 0.002F * float(y); };
    for (const Outline& ball : {Outline{60, 50, 20, 20, 0}, Outline{60, 50, 20, 16, 30},
                                Outline{5, 50, 20, 20, 0}, Outline{60, 95, 20, 20, 0}}) {
        Image picture = with_ball({120, 100}, ball, slope);
        // A circle as large as the long axis was painted.
        paint_out(picture, {ball.cx, ball.cy, ball.a, ball.a, 0});
        const bool inside = ball.cx == 60 && ball.cy == 50;
        for (int y = 0; y < 100; ++y)
            for (int x = 0; x < 120; ++x) {
                // Across the ball it changes by 0.16. Where the ball is cut off by the picture's
                // edge the slope is not known there.
                EXPECT_NEAR(picture.pixel(x, y)[0], slope(x, y), inside ? 0.06 : 0.12)
                    << x << "," << y;
                EXPECT_NEAR(picture.pixel(x, y)[3], 1, 1e-4);
            }
    }
}

TEST(PaintOut, ContinuesEdgesAndGrain) {
    const auto light = [](int x, int y) { return 3 * y - x > 90 ? 0.8F : 0.2F; };
    const auto world = [&](int x, int y) {
        const auto grain = hashed(std::uint32_t(x) + hashed(std::uint32_t(y)));
        return light(x, y) * (1 + 0.2F * (float(grain % 1000) / 500 - 1));
    };
    // Small, and larger than what pieces are looked for in.
    for (const double scale : {1.0, 4.0}) {
        const Outline ball{scale * 75, scale * 55, scale * 22, scale * 22, 0};
        const auto stretched = [&](int x, int y) {
            return world(x, y) / light(x, y) * light(int(x / scale), int(y / scale));
        };
        Image picture = with_ball({int(scale * 150), int(scale * 110)}, ball, stretched);
        paint_out(picture, ball);
        int wrong = 0, count = 0;
        double square = 0;
        for (int y = 0; y < picture.height(); ++y)
            for (int x = 0; x < picture.width(); ++x) {
                if (std::hypot(x + 0.5 - ball.cx, y + 0.5 - ball.cy) > ball.a) continue;
                const float wanted = light(int(x / scale), int(y / scale));
                const float off = picture.pixel(x, y)[0] / wanted - 1;
                ++count;
                if (std::abs(off) > 0.5F)
                    ++wrong;
                else
                    square += double(off * off);
            }
        // A smooth picture has neither: a third of it is neither light nor dark.
        EXPECT_LT(wrong, 0.06 * count) << scale;
        // The grain's deviation is 0.2 / sqrt(3) = 0.115; where pieces overlap there is less.
        EXPECT_GT(std::sqrt(square / (count - wrong)), 0.07) << scale;
    }
}

TEST(PaintOut, TakesNothingFromBeyondThePlate) {
    // Half of the plate is outside of its data window: nothing, alpha 0.
    const Outline ball{60, 50, 15, 15, 0};
    Image picture = with_ball({120, 100}, ball, [](int, int) { return 0.5F; });
    for (int y = 0; y < 100; ++y)
        for (int x = 80; x < 120; ++x) std::fill_n(picture.pixel(x, y), 4, 0.0F);
    paint_out(picture, ball);
    for (int y = 30; y < 70; ++y)
        for (int x = 40; x < 78; ++x) {
            EXPECT_NEAR(picture.pixel(x, y)[0], 0.5F, 1e-3) << x << "," << y;
            EXPECT_EQ(picture.pixel(x, y)[3], 1) << x << "," << y;
        }
}

TEST(PaintOut, HidesABlurredRim) {
    const Outline ball{60, 50, 15, 15, 0};
    Image picture = with_ball({120, 100}, ball, [](int, int) { return 0.5F; });
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 120; ++x) {
            const double off = std::hypot(x + 0.5 - 60, y + 0.5 - 50) - 15;
            for (int c = 0; c < 3; ++c)
                picture.pixel(x, y)[c] = float(0.5 + 20 / (1 + std::exp(2 * off)));
        }
    Image sharp = picture;
    paint_out(picture, ball, 2);
    paint_out(sharp, ball);
    EXPECT_LT(picture.pixel(60, 31)[0], 0.51F);
    EXPECT_GT(sharp.pixel(60, 31)[0], 0.51F) << "without being told of the blur";
}

TEST(LikestPlaces, AreOutsideOfTheHole) {
    Holed picture{Image({64, 48}, 1), std::vector<char>(64 * 48)};
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            picture.look.pixel(x, y)[0] = x / 8 % 2 == 0 ? 0.8F : 0.2F;
            picture.hole[picture.at(x, y)] = std::hypot(x - 30, y - 25) < 10;
        }
    const auto places = likest_places(picture);
    int asked = 0, right = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            const auto& place = places[picture.at(x, y)];
            if (!picture.hole[picture.at(x, y)]) continue;
            ASSERT_TRUE(place);
            ++asked;
            right += (place->x / 8 - x / 8) % 2 == 0;
            for (int j = -3; j <= 3; ++j)
                for (int i = -3; i <= 3; ++i)
                    ASSERT_FALSE(picture.hole[picture.at(place->x + i, place->y + j)]);
        }
    EXPECT_GT(right, 0.97 * asked) << "stripes go on as stripes";
    // Too small for a patch.
    for (const auto& place : likest_places({Image({5, 5}, 1), std::vector<char>(25, 1)}))
        EXPECT_FALSE(place);
}

TEST(PaintOut, LeavesTheRestAlone) {
    Image picture({60, 50}, 4);
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 60; ++x)
            std::fill_n(picture.pixel(x, y), 4, float((x * 7 + y * 13) % 11));
    const Image before = picture;
    paint_out(picture, {30, 25, 8, 8, 0});
    int changed = 0;
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 60; ++x) {
            const bool differs = picture.pixel(x, y)[1] != before.pixel(x, y)[1];
            changed += differs;
            const bool outside = std::hypot(x + 0.5 - 30, y + 0.5 - 25) > 8 * 1.05 + 2.1;
            EXPECT_FALSE(outside && differs) << x << "," << y;
        }
    EXPECT_GT(changed, 180);
    // A ball that leaves nothing to see, and one outside.
    Image small = before;
    paint_out(small, {30, 25, 500, 500, 0});
    paint_out(small, {-300, 25, 8, 8, 0});
    EXPECT_EQ(small.pixel(30, 25)[0], before.pixel(30, 25)[0]);
}

TEST(LayOver, IsTheOverOperator) {
    Image below({1, 1}, 4), above({1, 1}, 4);
    const float b[] = {0.5F, 0.25F, 1, 1}, a[] = {0.3F, 0, 2, 0.5F};
    std::copy_n(b, 4, below.row(0));
    std::copy_n(a, 4, above.row(0));
    lay_over(below, above);
    EXPECT_FLOAT_EQ(below.row(0)[0], 0.55F);
    EXPECT_FLOAT_EQ(below.row(0)[2], 2.5F);
    EXPECT_FLOAT_EQ(below.row(0)[3], 1);
}

}  // namespace
}  // namespace chromeball
