#include "map/orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "map/latlong.h"
#include "support/directions.h"

namespace chromeball {
namespace {

const V3d X(1, 0, 0), Y(0, 1, 0), Z(0, 0, 1);

void expect_close(V3d a, V3d b) { EXPECT_LT((a - b).length(), 1e-14) << a << " is not " << b; }

void expect_close(const Rotation& a, const Rotation& b) {
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            EXPECT_NEAR(a.at(row, column), b.at(row, column), 1e-14);
}

TEST(Rotation, TurnsCounterClockwiseSeenFromTheAxisTip) {
    EXPECT_EQ(Rotation::about_x(90) * Y, Z);
    EXPECT_EQ(Rotation::about_y(90) * Z, X);
    EXPECT_EQ(Rotation::about_z(90) * X, Y);
    expect_close(Rotation::about_z(30) * X, V3d(std::cos(radians(30)), 0.5, 0));
}

TEST(Rotation, LeavesItsAxisAlone) {
    expect_close(Rotation::about_x(37) * X, X);
    expect_close(Rotation::about_y(37) * Y, Y);
    expect_close(Rotation::about_z(37) * Z, Z);
}

TEST(Rotation, OfQuarterTurnsIsExact) {
    for (const double turn : {-270.0, -180.0, -90.0, 0.0, 90.0, 180.0, 360.0}) {
        const Rotation r = Rotation::yaw_pitch_roll(turn, 2 * turn, 3 * turn);
        for (const double number : r.rows())
            EXPECT_TRUE(number == 0 || number == 1 || number == -1) << turn;
    }
    EXPECT_TRUE(Rotation::about_y(360).is_identity());
    EXPECT_FALSE(Rotation::about_y(1).is_identity());
}

TEST(Rotation, OfYawPitchRollRollsFirstAndYawsLast) {
    for (const V3d& d : directions_on_sphere(20))
        expect_close(Rotation::yaw_pitch_roll(10, 20, 30) * d,
                     Rotation::about_y(10) * (Rotation::about_x(20) * (Rotation::about_z(30) * d)));
}

TEST(Rotation, YawOf180PutsWhatTheCameraLooksAtIntoTheMiddle) {
    const V3d shown = Rotation::yaw_pitch_roll(180, 0, 0) * V3d(0, 0, -1);
    EXPECT_EQ(LatLong{}.to_position(shown), V2d(0.5, 0.5));
}

TEST(Rotation, AppliesItsRowsToColumnVectors) {
    const auto r = Rotation::nearest(std::vector<double>{0, -1, 0, 1, 0, 0, 0, 0, 1}).value();
    EXPECT_EQ(r * X, Y);
    EXPECT_EQ(r.at(1, 0), 1);
    EXPECT_EQ(r, Rotation::about_z(90));
}

TEST(Rotation, IsUndoneByItsInverse) {
    const Rotation r = Rotation::yaw_pitch_roll(10, -70, 200);
    expect_close(r * r.inverse(), Rotation());
    expect_close(r.inverse() * r, Rotation());
}

TEST(Rotation, TurnsDerivativesToo) {
    const Rotation r = Rotation::about_z(90);
    const auto turned = r * Vec3<Dual>(Dual(1, 2, 3), Dual(4, 5, 6), Dual(7, 8, 9));
    EXPECT_EQ(value_of(turned), V3d(-4, 1, 7));
    EXPECT_EQ(V3d(turned.x.du, turned.y.du, turned.z.du), V3d(-5, 2, 8));
    EXPECT_EQ(V3d(turned.x.dv, turned.y.dv, turned.z.dv), V3d(-6, 3, 9));
}

TEST(NearestRotation, TakesNineNumbersOrTheUpperLeftOfSixteen) {
    const Rotation r = Rotation::yaw_pitch_roll(10, 20, 30);
    std::vector<double> nine(r.rows().begin(), r.rows().end()), sixteen(16, 100.0);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sixteen[static_cast<std::size_t>(4 * i + j)] = r.at(i, j);
    expect_close(Rotation::nearest(nine).value(), r);
    expect_close(Rotation::nearest(sixteen).value(), r);
    nine.push_back(0);
    EXPECT_EQ(Rotation::nearest(nine), std::nullopt);
    EXPECT_EQ(Rotation::nearest({}), std::nullopt);
}

TEST(NearestRotation, OrthonormalisesRoundedNumbers) {
    const Rotation r = Rotation::yaw_pitch_roll(12, 34, 56);
    std::vector<double> rounded(r.rows().begin(), r.rows().end());
    for (double& number : rounded) number = std::round(number * 1e4) / 1e4;
    const Rotation found = Rotation::nearest(rounded).value();
    expect_close(found * found.inverse(), Rotation());
    for (int i = 0; i < 3; ++i)  // 1e-4: what the rounding took away
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(found.at(i, j), r.at(i, j), 1e-4);
}

TEST(NearestRotation, RefusesWhatIsNone) {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    using Numbers = std::vector<double>;
    EXPECT_EQ(Rotation::nearest(Numbers{1, 0, 0, 0, 1, 0, 0, 0, -1}), std::nullopt);  // a mirror
    EXPECT_EQ(Rotation::nearest(Numbers{0, 1, 0, 1, 0, 0, 0, 0, 1}), std::nullopt);
    EXPECT_EQ(Rotation::nearest(Numbers{2, 0, 0, 0, 2, 0, 0, 0, 2}), std::nullopt);  // a scale
    EXPECT_EQ(Rotation::nearest(Numbers{1.002, 0, 0, 0, 1, 0, 0, 0, 1}), std::nullopt);
    EXPECT_EQ(Rotation::nearest(Numbers{1, 0.002, 0, 0, 1, 0, 0, 0, 1}), std::nullopt);  // a shear
    EXPECT_EQ(Rotation::nearest(Numbers(9, 0.0)), std::nullopt);
    EXPECT_EQ(Rotation::nearest(Numbers{1, 0, 0, 0, nan, 0, 0, 0, 1}), std::nullopt);
    EXPECT_EQ(Rotation::nearest(Numbers{1, 0, 0, 0, infinity, 0, 0, 0, 1}), std::nullopt);
    EXPECT_TRUE(Rotation::nearest(Numbers{1.0004, 0, 0, 0, 1, 0, 0, 0, 1}));
}

/// A camera in the world: where its right, its up and its back point.
struct Rig {
    V3d right, up, back;

    /// worldToCamera for row vectors, of a camera whose own axes are right, up and back times
    /// signs.
    std::vector<double> world_to_camera(double y, double z) const {
        std::vector<double> m;
        for (int i = 0; i < 3; ++i) m.insert(m.end(), {right[i], y * up[i], z * back[i], 0});
        m.insert(m.end(), {5, -6, 7, 1});  // somewhere
        return m;
    }
};

TEST(CameraToWorld, IsReadFromWorldToCameraInEachAxesConvention) {
    // A camera that looks along +X of the world (back is -X), its right +Z, level; and a tilted
    // one.
    const Rotation tilt = Rotation::yaw_pitch_roll(33, 12, -80);
    const Rig rigs[] = {{Z, Y, -X}, {tilt * X, tilt * Y, tilt * Z}};
    for (const Rig& rig : rigs) {
        const std::pair<const char*, std::vector<double>> files[] = {
            {"opengl", rig.world_to_camera(1, 1)},
            {"opencv", rig.world_to_camera(-1, -1)},
            {"renderman", rig.world_to_camera(1, -1)}};
        for (const auto& [axes, numbers] : files) {
            const auto r = Rotation::camera_to_world(numbers, axes);
            ASSERT_TRUE(r) << axes;
            expect_close(*r * X, rig.right);
            expect_close(*r * Y, rig.up);
            expect_close(*r * Z, rig.back);
        }
    }
}

TEST(CameraToWorld, IsRefusedInTheWrongConventionOrShape) {
    const Rig rig{Z, Y, -X};
    EXPECT_EQ(Rotation::camera_to_world(rig.world_to_camera(1, -1), "opengl"), std::nullopt);
    EXPECT_EQ(Rotation::camera_to_world(rig.world_to_camera(1, 1), "renderman"), std::nullopt);
    EXPECT_EQ(Rotation::camera_to_world(rig.world_to_camera(1, 1), "maya"), std::nullopt);
    EXPECT_EQ(Rotation::camera_to_world(Rotation().rows(), "opengl"), std::nullopt);
}

}  // namespace
}  // namespace chromeball
