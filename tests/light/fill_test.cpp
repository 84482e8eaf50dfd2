#include "light/fill.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chromeball {
namespace {

/// Known outside of a cap around a direction: a + b.d for the direction d.
Image with_gap(const ViewCube& cube, V3d middle, double cosine) {
    Image picture(cube.layout().picture(cube.size()), 4);
    for (std::size_t i = 0; i < cube.cells(); ++i) {
        if (cube.direction(i).dot(middle) > cosine) continue;
        float* p = picture.row(0) + 4 * i;
        for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(2 + cube.direction(i)[c]);
        p[3] = 1;
    }
    return picture;
}

TEST(FillGaps, SpansAMembraneOverThem) {
    const ViewCube cube(64);
    const V3d middle = V3d(1, 0.9, 0.2).normalized();  // across an edge of the cube
    const Image before = with_gap(cube, middle, std::cos(0.4));
    Image after = before;
    fill_gaps(after);
    int filled = 0;
    for (std::size_t i = 0; i < cube.cells(); ++i) {
        const float *was = before.row(0) + 4 * i, *is = after.row(0) + 4 * i;
        if (was[3] > 0) {
            ASSERT_TRUE(std::equal(was, was + 4, is));
            continue;
        }
        ++filled;
        EXPECT_EQ(is[3], 0);
        // The harmonic function with these values on the cap's edge is nearly the linear one.
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(static_cast<double>(is[c]), 2 + cube.direction(i)[c], 0.12);
    }
    EXPECT_GT(filled, 500);
}

TEST(FillGaps, StaysWithinWhatSurroundsThem) {
    const ViewCube cube(32);
    Image picture = with_gap(cube, V3d(0, 0, 1), -0.5);  // three quarters of the sphere
    float low = 9, high = 0;
    for (std::size_t i = 0; i < cube.cells(); ++i)
        if (const float* p = picture.row(0) + 4 * i; p[3] > 0) {
            low = std::min(low, p[0]);
            high = std::max(high, p[0]);
        }
    fill_gaps(picture);
    for (std::size_t i = 0; i < cube.cells(); ++i) {
        EXPECT_GE(picture.row(0)[4 * i], low - 1e-5F);
        EXPECT_LE(picture.row(0)[4 * i], high + 1e-5F);
    }
}

TEST(FillGaps, OfNothingIsBlack) {
    const ViewCube cube(8);
    Image picture(cube.layout().picture(8), 4);
    picture.pixel(1, 1)[0] = 5;  // not known, whatever it holds
    fill_gaps(picture);
    for (std::size_t i = 0; i < 4 * cube.cells(); ++i) EXPECT_EQ(picture.row(0)[i], 0);
}

}  // namespace
}  // namespace chromeball
