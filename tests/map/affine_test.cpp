#include "map/affine.h"

#include <gtest/gtest.h>

#include "map/camera.h"

namespace chromeball {
namespace {

/// A photo's outline as many turned ellipses.
const Outline kOutlines[] = {{100, 80, 50, 50, 0},
                             {100, 80, 50, 40, 0},
                             {-20, 300, 55, 40, 90},
                             {812.3, 54.9, 40, 33, 30},
                             {812.3, 54.9, 40, 33, 150}};

TEST(Affine, AppliesItsSixNumbers) {
    const Affine affine{1, 2, 3, 4, 5, 6};
    EXPECT_EQ(affine(V2d(10, 100)), V2d(213, 546));
    EXPECT_EQ(shift(3, -4)(V2d(10, 100)), V2d(13, 96));
    EXPECT_EQ(scale(3, -4)(V2d(10, 100)), V2d(30, -400));
}

TEST(Affine, IsUndoneByItsInverse) {
    const Affine affine{1.5, -0.25, 300, 0.5, 2, -70};
    const V2d p(12.5, -8), back = affine.inverse()(affine(p));
    EXPECT_NEAR(back.x, p.x, 1e-12);  // rounding of numbers of some hundreds
    EXPECT_NEAR(back.y, p.y, 1e-12);
    const V2d other = affine(affine.inverse()(p));
    EXPECT_NEAR(other.x, p.x, 1e-12);
    EXPECT_NEAR(other.y, p.y, 1e-12);
}

TEST(Affine, CarriesDerivatives) {
    const Affine affine{1, 2, 3, 4, 5, 6};
    const auto p = affine(with_derivatives({10, 100}));
    EXPECT_EQ(value_of(p), V2d(213, 546));
    EXPECT_EQ(V2d(p.x.du, p.x.dv), V2d(1, 2));
    EXPECT_EQ(V2d(p.y.du, p.y.dv), V2d(4, 5));
}

TEST(CropOf, MakesTheOutlineTheCircleInscribedInTheSquare) {
    for (const Outline& outline : kOutlines) {
        const Affine crop = crop_of(outline, 256);
        for (int i = 0; i < 16; ++i) {
            const V2d p = crop(rim_point(outline, i * 0.4));
            EXPECT_NEAR((p - V2d(128, 128)).length(), 128, 1e-9);
        }
    }
}

TEST(CropOf, StretchesWithoutTurning) {
    for (const Outline& outline : kOutlines) {
        const Affine crop = crop_of(outline, 256);
        EXPECT_DOUBLE_EQ(crop.xy, crop.yx);  // a symmetric, positive matrix has no turn in it
        EXPECT_GT(crop.xx, 0);
        EXPECT_GT(crop.yy, 0);
        EXPECT_GT(crop.xx * crop.yy, crop.xy * crop.yx);
    }
}

}  // namespace
}  // namespace chromeball
