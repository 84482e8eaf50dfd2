#include "map/angular.h"

#include <gtest/gtest.h>

#include "support/directions.h"

namespace chromeball {
namespace {

void expect_direction(V2d position, V3d expected) {
    const V3d d = Angular{}.to_direction(position).value();
    EXPECT_LT((d - expected).length(), 1e-15) << d << " is not " << expected;  // rounding of pi
}

TEST(Angular, HasMinusZInTheMiddleAndPlusZAllAroundTheEdge) {
    expect_direction({0.5, 0.5}, {0, 0, -1});
    expect_direction({0, 0.5}, {0, 0, 1});
    expect_direction({1, 0.5}, {0, 0, 1});
    expect_direction({0.5, 0}, {0, 0, 1});
    expect_direction({0.5, 1}, {0, 0, 1});
}

TEST(Angular, HasPlusXToTheRightAndPlusYUp) {
    expect_direction({0.75, 0.5}, {1, 0, 0});
    expect_direction({0.25, 0.5}, {-1, 0, 0});
    expect_direction({0.5, 0.25}, {0, 1, 0});
    expect_direction({0.5, 0.75}, {0, -1, 0});
}

TEST(Angular, HasARadiusThatIsTheAngleOverPi) {
    for (int degree = 0; degree < 180; degree += 5) {
        const V3d d = off_axis(radians(degree), 0.3);
        const V2d from_middle = Angular{}.to_position(d).value() - V2d(0.5, 0.5);
        EXPECT_NEAR(2 * from_middle.length(), degree / 180.0, 1e-12);
        if (degree > 0) {
            EXPECT_NEAR(std::atan2(-from_middle.y, from_middle.x), 0.3, 1e-12);
        }
    }
}

TEST(Angular, HasNothingInTheCorners) {
    EXPECT_EQ(Angular{}.to_direction(V2d(0.01, 0.01)), std::nullopt);
    EXPECT_EQ(Angular{}.to_direction(V2d(1.01, 0.5)), std::nullopt);
    EXPECT_EQ(Angular{}.solid_angle({0.01, 0.99}), 0);
    EXPECT_EQ(solid_angle_from_jacobian(Angular{}, {0.01, 0.99}), 0);
}

TEST(Angular, HasNoZeroOverZeroInTheMiddleAndAtTheEdge) {
    const Angular map;
    EXPECT_EQ(map.to_position(V3d(0, 0, -5)), V2d(0.5, 0.5));
    EXPECT_NEAR(map.solid_angle({0.5, 0.5}), 4 * std::numbers::pi * std::numbers::pi, 1e-9);
    const V2d edge = map.to_position(V3d(0, 0, 1)).value();
    EXPECT_NEAR((edge - V2d(0.5, 0.5)).length(), 0.5, 1e-15);
    const auto close = map.to_position(V3d(1e-12, -1e-12, -1)).value();
    EXPECT_NEAR(close.x - 0.5, 0.5e-12 / std::numbers::pi, 1e-16);  // half an ulp of 0.5
    EXPECT_NEAR(close.y - 0.5, 0.5e-12 / std::numbers::pi, 1e-16);
}

TEST(Angular, BendsNearTheEdgeOnly) {
    EXPECT_TRUE(Angular{}.curved({0, 0, 1}));
    EXPECT_TRUE(Angular{}.curved(off_axis(radians(155), 1)));
    EXPECT_FALSE(Angular{}.curved(off_axis(radians(145), 1)));
}

}  // namespace
}  // namespace chromeball
