#include "map/latlong.h"

#include <gtest/gtest.h>

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfEnvmap.h>

#include "support/directions.h"

namespace chromeball {
namespace {

void expect_direction(V2d position, V3d expected) {
    const V3d d = LatLong{}.to_direction(position).value();
    EXPECT_LT((d - expected).length(), 1e-15) << d << " is not " << expected;  // rounding of pi
}

TEST(LatLong, HasPlusZInTheMiddleAndPlusXAQuarterFromTheLeft) {
    expect_direction({0.5, 0.5}, {0, 0, 1});
    expect_direction({0.25, 0.5}, {1, 0, 0});
    expect_direction({0.75, 0.5}, {-1, 0, 0});
    expect_direction({0, 0.5}, {0, 0, -1});
    expect_direction({1, 0.5}, {0, 0, -1});
    expect_direction({0.3, 0}, {0, 1, 0});
    expect_direction({0.3, 1}, {0, -1, 0});
}

TEST(LatLong, PutsTheAxesWhereTheyBelong) {
    const LatLong map;
    EXPECT_EQ(map.to_position(V3d(0, 0, 1)), V2d(0.5, 0.5));
    EXPECT_EQ(map.to_position(V3d(2, 0, 0)), V2d(0.25, 0.5));
    EXPECT_EQ(map.to_position(V3d(-1, 0, 0)), V2d(0.75, 0.5));
    EXPECT_EQ(map.to_position(V3d(0, 3, 0)), V2d(0.5, 0));
    EXPECT_EQ(map.to_position(V3d(0, -1, 0)), V2d(0.5, 1));
}

TEST(LatLong, HasNoSolidAngleAtThePolesAndMostAtTheHorizon) {
    EXPECT_NEAR(LatLong{}.solid_angle({0.1, 0}), 0, 1e-14);
    EXPECT_NEAR(LatLong{}.solid_angle({0.1, 1}), 0, 1e-14);
    EXPECT_DOUBLE_EQ(LatLong{}.solid_angle({0.1, 0.5}), 2 * std::numbers::pi * std::numbers::pi);
}

TEST(LatLong, BendsNearThePolesOnly) {
    EXPECT_TRUE(LatLong{}.curved({0, 1, 0}));
    EXPECT_TRUE(LatLong{}.curved({0, -std::cos(0.2), std::sin(0.2)}));
    EXPECT_FALSE(LatLong{}.curved({std::sqrt(0.5), std::sqrt(0.5), 0}));
}

TEST(LatLong, AgreesWithTheOpenExrLibraryHalfAPixelApart) {
    // Its outermost pixel centres lie on the border: pixel p of n is at p / (n - 1), not (p + 0.5)
    // / n.
    const Imath::Box2i window({0, 0}, {63, 31});
    for (int y = 0; y <= 31; ++y)
        for (int x = 0; x <= 63; ++x) {
            const Imath::V3f theirs = OPENEXR_IMF_NAMESPACE::LatLongMap::direction(
                window, Imath::V2f(static_cast<float>(x), static_cast<float>(y)));
            const V3d ours = LatLong{}.to_direction(V2d(x / 63.0, y / 31.0)).value();
            EXPECT_LT((ours - V3d(theirs)).length(), 2e-6);  // theirs is in floats
        }
    for (const V3d& d : directions_on_sphere(500)) {
        const Imath::V2f theirs =
            OPENEXR_IMF_NAMESPACE::LatLongMap::pixelPosition(window, Imath::V3f(d));
        const V2d ours = LatLong{}.to_position(d).value();
        EXPECT_NEAR(ours.x, theirs.x / 63, 2e-6);
        EXPECT_NEAR(ours.y, theirs.y / 31, 2e-6);
    }
}

}  // namespace
}  // namespace chromeball
