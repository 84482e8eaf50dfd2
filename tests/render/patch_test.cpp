#include "render/patch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chromeball {
namespace {

TEST(PaintOut, ContinuesASlopeThroughTheBall) {
    // A slope is harmonic: it comes back whole, whatever colour the ball had.
    const auto slope = [](int x, int y) { return 0.2F + 0.004F * float(x) - 0.002F * float(y); };
    for (const Outline& ball :
         {Outline{60, 50, 25, 20, 30}, Outline{5, 50, 20, 20, 0}, Outline{60, 95, 20, 20, 0}}) {
        Image picture({120, 100}, 4);
        for (int y = 0; y < 100; ++y)
            for (int x = 0; x < 120; ++x) {
                const bool in_ball = std::hypot(x + 0.5 - ball.cx, y + 0.5 - ball.cy) < ball.a + 1;
                for (int c = 0; c < 3; ++c) picture.pixel(x, y)[c] = in_ball ? 50.0F : slope(x, y);
                picture.pixel(x, y)[3] = 1;
            }
        // A circle as large as the long axis was painted.
        paint_out(picture, {ball.cx, ball.cy, ball.a, ball.a, 0});
        const bool inside = ball.cx == 60 && ball.cy == 50;
        for (int y = 0; y < 100; ++y)
            for (int x = 0; x < 120; ++x) {
                // Where the ball is cut off by the picture's edge the slope is not known there.
                EXPECT_NEAR(picture.pixel(x, y)[0], slope(x, y), inside ? 2e-3 : 0.15)
                    << x << "," << y;
                EXPECT_NEAR(picture.pixel(x, y)[3], 1, 1e-4);
            }
    }
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
            const bool outside = std::hypot(x + 0.5 - 30, y + 0.5 - 25) > 8 * 1.03 + 2.1;
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
