#include "map/cube.h"

#include <gtest/gtest.h>

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfEnvmap.h>

#include <map>

#include "map/layouts.h"
#include "support/directions.h"

namespace chromeball {
namespace {

const V3d X(1, 0, 0), Y(0, 1, 0), Z(0, 0, 1);
const V3d kAxes[6] = {X, -X, Y, -Y, Z, -Z};

const CubeLayout& cells(std::string_view name) {
    for (const CubeLayout& layout : cube_layouts())
        if (layout.name == name) return layout;
    ADD_FAILURE() << "no layout " << name;
    return cube_layouts().front();
}

/// The contract's frames: what rows and columns of +X -X +Y -Y +Z -Z run along.
const V3d kFrames[6][2] = {{Z, -Y}, {-Z, -Y}, {X, -Z}, {X, Z}, {-X, -Y}, {X, -Y}};

/// The position of (a, b) in [0, 1]^2 of a face's cell.
V2d in_cell(const CubeLayout& layout, int face, double a, double b) {
    const Face& f = layout.faces[static_cast<std::size_t>(face)];
    return {(f.column + a) / layout.columns, (f.row + b) / layout.rows};
}

/// Which face stands in which cell, rows from the top: digits are indices of +X -X +Y -Y +Z -Z.
void expect_grid(const CubeLayout& layout, const std::vector<std::string>& grid) {
    ASSERT_EQ(layout.rows, static_cast<int>(grid.size()));
    ASSERT_EQ(layout.columns, static_cast<int>(grid[0].size()));
    const Cube cube(layout);
    for (int row = 0; row < layout.rows; ++row)
        for (int column = 0; column < layout.columns; ++column) {
            const V2d middle((column + 0.5) / layout.columns, (row + 0.5) / layout.rows);
            const char cell = grid[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
            const auto d = cube.to_direction(middle);
            if (cell == '.') {
                EXPECT_EQ(d, std::nullopt) << layout.name << " " << row << " " << column;
                EXPECT_EQ(cube.solid_angle(middle), 0);
                EXPECT_EQ(cube.face_at(middle), -1);
            } else {
                ASSERT_TRUE(d) << layout.name << " " << row << " " << column;
                EXPECT_EQ(*d, kAxes[cell - '0']) << layout.name << " " << row << " " << column;
                EXPECT_EQ(cube.face_at(middle), cell - '0');
            }
        }
}

/// What rows and columns of a face run along, from the picture itself.
void expect_frame(const CubeLayout& layout, int face, V3d right, V3d down) {
    const Cube cube(layout);
    const double h = 1e-3;
    const auto at = [&](double a, double b) {
        return cube.to_direction(in_cell(layout, face, a, b)).value();
    };
    const V3d along_row = (at(0.5 + h, 0.5) - at(0.5 - h, 0.5)).normalized();
    const V3d along_column = (at(0.5, 0.5 + h) - at(0.5, 0.5 - h)).normalized();
    EXPECT_LT((along_row - right).length(), 1e-9) << layout.name << " face " << face;
    EXPECT_LT((along_column - down).length(), 1e-9) << layout.name << " face " << face;
}

TEST(Cube, IsAColumnInOpenExrsOrderByDefault) {
    EXPECT_EQ(Cube().layout().name, "openexr");
    expect_grid(Cube().layout(), {"0", "1", "2", "3", "4", "5"});
}

TEST(Cube, HasItsFacesInTheContractsCells) {
    expect_grid(cells("openexr"), {"0", "1", "2", "3", "4", "5"});
    expect_grid(cells("strip-h"), {"012345"});
    expect_grid(cells("cross-h"), {".2..", "0415", ".3.."});
    expect_grid(cells("cross-v"), {".2.", "041", ".3.", ".5."});
    // -X -Y +X over -Z +Z +Y of Blender's world; our (x, y, z) is its (x, -z, y)
    expect_grid(cells("blender-3x2"), {"140", "325"});
    expect_grid(cells("faces-opengl"), {"0", "1", "2", "3", "4", "5"});
}

TEST(Cube, HasTheContractsFramesInColumnAndStrips) {
    for (const char* name : {"openexr", "strip-h", "blender-3x2"})
        for (int face = 0; face < 6; ++face)
            expect_frame(cells(name), face, kFrames[face][0], kFrames[face][1]);
}

TEST(Cube, HasTopAndBottomOfACrossTurnedToJoinPlusZ) {
    for (const char* name : {"cross-h", "cross-v"}) {
        for (const int face : {0, 1, 4})
            expect_frame(cells(name), face, kFrames[face][0], kFrames[face][1]);
        expect_frame(cells(name), 2, -X, Z);
        expect_frame(cells(name), 3, -X, -Z);
    }
    expect_frame(cells("cross-h"), 5, X, -Y);
    expect_frame(cells("cross-v"), 5, -X, Y);  // turned by 180 degrees
}

TEST(Cube, JoinsAllNeighboursInACross) {
    for (const char* name : {"cross-h", "cross-v"}) {
        const CubeLayout& layout = cells(name);
        const Cube cube(layout);
        const double h = 1e-9;
        int joints = 0;
        const auto compare = [&](V2d one, V2d other) {
            const auto a = cube.to_direction(one), b = cube.to_direction(other);
            if (!a || !b) return;
            ++joints;
            // A step of 2e-9 of the picture is at most 4 x 2e-9 x 2 of the face's plane.
            EXPECT_LT(angle_between(*a, *b), 2e-8) << name << " at " << one;
        };
        for (int row = 0; row < layout.rows; ++row)
            for (int column = 0; column < layout.columns; ++column)
                for (const double t : {0.1, 0.45, 0.8}) {
                    const double right = (column + 1.0) / layout.columns,
                                 bottom = (row + 1.0) / layout.rows;
                    const double x = (column + t) / layout.columns, y = (row + t) / layout.rows;
                    if (column + 1 < layout.columns) compare({right - h, y}, {right + h, y});
                    if (row + 1 < layout.rows) compare({x, bottom - h}, {x, bottom + h});
                }
        EXPECT_EQ(joints, 3 * 5) << name;  // six faces unfolded hang together at five edges
    }
}

TEST(Cube, MeetsADirectionWhereItsLargestComponentIsOne) {
    for (const CubeLayout& layout : cube_layouts()) {
        const Cube cube(layout);
        for (int face = 0; face < 6; ++face) {
            const Face& f = layout.faces[static_cast<std::size_t>(face)];
            const V3d r = kAxes[face] + f.right * 0.5 - f.down * 0.25;
            const V2d p = cube.to_position(r * 3.0).value();
            EXPECT_LT((p - in_cell(layout, face, 0.75, 0.375)).length(), 1e-15) << layout.name;
        }
    }
}

TEST(Cube, KeepsDirectionsOnEdgesAndCornersInTheirFace) {
    // A cell's right and lower border belong to its neighbour, which shows something else there.
    for (const CubeLayout& layout : cube_layouts()) {
        const Cube cube(layout);
        for (const V3d& d : cube_directions()) {
            const auto back = cube.to_direction(cube.to_position(d).value());
            ASSERT_TRUE(back) << layout.name << d;
            EXPECT_LT(angle_between(d, *back), 1e-9) << layout.name << d;
        }
    }
}

TEST(Cube, ShowsNothingOutsideThePicture) {
    const Cube cube;
    for (const V2d& p : {V2d(-0.01, 0.5), V2d(1.01, 0.5), V2d(0.5, -0.01), V2d(0.5, 1.01),
                         V2d(std::nan(""), 0.5)}) {
        EXPECT_EQ(cube.to_direction(p), std::nullopt);
        EXPECT_EQ(cube.solid_angle(p), 0);
    }
    EXPECT_TRUE(cube.to_direction(V2d(1, 1)));
}

TEST(Cube, HasTwiceTheSolidAngleOfALinearMapInTheMiddleOfAFace) {
    // A face's plane has area 4 and stands at distance 1; in its corner the distance is sqrt(3)
    // and the slant as much again.
    EXPECT_DOUBLE_EQ(Cube().solid_angle({0.5, 0.5 / 6}), 24);
    EXPECT_NEAR(Cube().solid_angle({1, 1}), 24 / std::pow(3, 1.5), 1e-12);
}

TEST(Cube, HasAFaceForEveryTie) {
    EXPECT_EQ(face_of({1, 1, 1}), 0);
    EXPECT_EQ(face_of({-1, 1, 1}), 1);
    EXPECT_EQ(face_of({0, 1, 1}), 2);
    EXPECT_EQ(face_of({0, -1, 1}), 3);
    EXPECT_EQ(face_of({0, 0.5, 1}), 4);
    EXPECT_EQ(face_of({0.5, 0.5, -1}), 5);
}

TEST(Cube, AgreesWithTheOpenExrLibraryHalfAPixelApart) {
    namespace exr = OPENEXR_IMF_NAMESPACE;
    constexpr int n = 16;
    const Imath::Box2i window({0, 0}, {n - 1, 6 * n - 1});
    ASSERT_EQ(exr::CubeMap::sizeOfFace(window), n);
    const Cube cube(cells("openexr"));
    for (int face = 0; face < 6; ++face) {
        const auto their_face = static_cast<exr::CubeMapFace>(face);
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const Imath::V2f in_face(static_cast<float>(i), static_cast<float>(j));
                const V3d theirs(exr::CubeMap::direction(their_face, window, in_face));
                const V2d pixel(exr::CubeMap::pixelPosition(their_face, window, in_face));
                // Its outermost pixel centres lie on the face's border.
                const V3d ours = cube.direction_on(face, 2 * pixel.x / (n - 1) - 1,
                                                   2 * (pixel.y - face * n) / (n - 1) - 1);
                EXPECT_LT(angle_between(ours, theirs), 1e-6) << face << " " << i << " " << j;
            }
    }
    for (const V3d& d : directions_on_sphere(500)) {
        exr::CubeMapFace face{};
        Imath::V2f in_face;
        exr::CubeMap::faceAndPixelPosition(Imath::V3f(d), window, face, in_face);
        const V2d pixel(exr::CubeMap::pixelPosition(face, window, in_face));
        const int index = face;
        EXPECT_EQ(face_of(d), index);
        const V2d ours = cube.to_position(d).value();
        EXPECT_NEAR(ours.x, pixel.x / (n - 1), 1e-6);  // theirs is in floats
        EXPECT_NEAR(6 * ours.y - index, (pixel.y - index * n) / (n - 1), 1e-5);
    }
}

}  // namespace
}  // namespace chromeball
