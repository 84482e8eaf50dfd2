#include "light/photographer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/views.h"

namespace chromeball {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// A view of a place whose camera is somewhere; all directions are believed alike.
CubeView seen(const ViewCube& cube, const Rotation& to_world, const test::Shown& shown) {
    CubeView view;
    view.light = Image(cube.layout().picture(cube.size()), 4);
    const Rotation to_view = to_world.inverse();
    for (std::size_t i = 0; i < cube.cells(); ++i) {
        const V3d light = shown(cube.direction(i), to_view * cube.direction(i));
        float* p = view.light.row(0) + 4 * i;
        for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(light[c]);
        p[3] = 1;
    }
    view.confidence.assign(cube.cells(), 0.7F);
    view.camera = to_world * V3d(0, 0, 1);
    view.pixel = 0.5 * kDegree;
    view.to_world = to_world;
    return view;
}

struct Found {
    double of_person = 0;  ///< the part of the person's directions that is marked
    double beside = 0;     ///< the part of the sphere that is marked and shows no person
};
Found found(const ViewCube& cube, const CellValues& mask, const Rotation& to_world) {
    double person = 0, marked = 0, beside = 0, all = 0;
    for (std::size_t i = 0; i < cube.cells(); ++i) {
        const V3d in_view = to_world.inverse() * cube.direction(i);
        const bool is = test::with_photographer(V3d(9, 9, 9), in_view).x < 1;
        const double area = cube.solid_angle(i);
        all += area;
        (is ? person : beside) += is ? area : area * (mask[i] > 0.5F);
        if (is && mask[i] > 0.5F) marked += area;
    }
    return {marked / person, beside / all};
}

class Photographers : public testing::Test {
protected:
    ViewCube cube{128};
    test::Place place{11};
    Rotation side = Rotation::about_y(90), back = Rotation::about_y(200);

    CubeView with(const Rotation& to_world) const {
        return seen(cube, to_world, [this](V3d world, V3d in_view) {
            return test::with_photographer(place(world), in_view);
        });
    }
    CubeView without(const Rotation& to_world) const {
        return seen(cube, to_world, [this](V3d world, V3d) { return place(world); });
    }
};

TEST_F(Photographers, AreFoundInTheViewThatTheyTook) {
    const auto masks = photographers(cube, {with({}), with(side)});
    for (const auto& [mask, to_world] : {std::pair(masks[0], Rotation()), {masks[1], side}}) {
        const Found result = found(cube, mask, to_world);
        EXPECT_GT(result.of_person, 0.97);
        EXPECT_LT(result.beside, 0.02);  // a margin of 2 degrees around them is 1.2 %
    }
}

TEST_F(Photographers, AreNotSeenWhereViewsAgree) {
    for (const CellValues& mask : photographers(cube, {without({}), without(side)}))
        for (const float value : mask) ASSERT_EQ(value, 0);
}

TEST_F(Photographers, AreNotSeenInEdgesThatAreALittleOff) {
    const auto stripes = [](V3d world, V3d) {
        const double light = std::sin(12 * std::atan2(world.x, world.z)) > 0 ? 1 : 0.1;
        return V3d(light, light, light);
    };
    const auto moved = [&](V3d world, V3d in_view) {
        return stripes(Rotation::about_y(0.3) * world, in_view);
    };
    const auto masks = photographers(cube, {seen(cube, {}, stripes), seen(cube, side, moved)});
    for (const CellValues& mask : masks) EXPECT_LT(found(cube, mask, {}).beside, 1e-3);
}

TEST_F(Photographers, AreSeenByTheMajority) {
    // The second view has something wrong where the first one's camera is; the third does not.
    const CubeView wrong = seen(cube, side, [this](V3d world, V3d) {
        return world.z > 0.98 ? V3d(3, 0, 0) : place(world);
    });
    const auto alone = photographers(cube, {without({}), wrong});
    EXPECT_GT(found(cube, alone[0], {}).beside, 0.005);
    const auto defended = photographers(cube, {without({}), wrong, without(back)});
    EXPECT_EQ(found(cube, defended[0], {}).beside, 0);
}

TEST_F(Photographers, AreGuessedWhereTheOthersSeeBehindThemAtTheirRimOnly) {
    const Rotation opposite = Rotation::about_y(180);
    auto views = std::vector{with({}), with(opposite)};
    for (CubeView& view : views)  // as the rim's pixels are drawn out
        for (std::size_t i = 0; i < cube.cells(); ++i) {
            const double behind = std::acos(-cube.direction(i).dot(*view.camera));
            view.confidence[i] = static_cast<float>(0.7 * std::min(1.0, std::pow(behind, 2)));
        }
    const auto masks = photographers(cube, views);
    for (const auto& [mask, to_world] : {std::pair(masks[0], Rotation()), {masks[1], opposite}}) {
        const Found result = found(cube, mask, to_world);
        EXPECT_GT(result.of_person, 0.97);
        EXPECT_LT(result.beside, 0.009);  // with all of the disc that nobody else sees 0.011
    }
    // Nobody is where the views agree.
    views = {without({}), without(opposite)};
    for (CubeView& view : views) view.confidence.assign(cube.cells(), 0.05F);
    for (const CellValues& mask : photographers(cube, views))
        for (const float value : mask) ASSERT_EQ(value, 0);
}

TEST_F(Photographers, NeedACamera) {
    auto views = std::vector{with({}), with(side)};
    for (CubeView& view : views) view.camera.reset();
    for (const CellValues& mask : photographers(cube, views))
        for (const float value : mask) ASSERT_EQ(value, 0);
}

TEST_F(Photographers, AloneAreGuessedByTheirColours) {
    for (const Rotation& to_world : {Rotation(), Rotation::yaw_pitch_roll(130, 40, 20)}) {
        const Found result = found(cube, lone_photographer(cube, with(to_world)), to_world);
        EXPECT_GT(result.of_person, 0.9);
        EXPECT_LT(result.beside, 0.03);
    }
}

}  // namespace
}  // namespace chromeball
