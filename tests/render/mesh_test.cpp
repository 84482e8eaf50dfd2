#include "render/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "render/shapes.h"
#include "render/solids.h"

namespace chromeball {
namespace {

using test::cube_mesh;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string refusal(Mesh mesh) {
    std::vector<std::string> notes;
    try {
        repaired(std::move(mesh), "it", notes);
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), Error::Kind::failed);
        return e.what();
    }
    return "";
}

TEST(RepairedMesh, OfACubeKeepsItsEdgesAndIsStillClosed) {
    std::vector<std::string> notes;
    const Mesh cube = repaired(cube_mesh(), "cube", notes);
    EXPECT_TRUE(notes.empty());
    EXPECT_EQ(cube.triangles.size(), 12u);
    EXPECT_EQ(cube.positions.size(), 24u) << "each corner once for each of its faces";
    for (std::size_t i = 0; i < cube.positions.size(); ++i) {
        const V3f& n = cube.normals[i];
        EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-6);
        EXPECT_NEAR(n.dot(cube.positions[i]), 1, 1e-6) << "outwards";
    }
    EXPECT_NEAR(six_volumes(cube), 6 * 8, 1e-9);
}

TEST(RepairedMesh, OfASphereIsSmooth) {
    Mesh sphere = tessellated_sphere(48, 24);
    sphere.normals.clear();
    std::vector<std::string> notes;
    const Mesh smooth = repaired(sphere, "sphere", notes);
    for (std::size_t i = 0; i < smooth.positions.size(); ++i)
        EXPECT_GT(smooth.normals[i].dot(smooth.positions[i]), std::cos(0.02));
    EXPECT_EQ(smooth.triangles.size(), sphere.triangles.size());
}

TEST(RepairedMesh, LosesTrianglesWithoutNumbersOrAreaAndSaysSo) {
    Mesh mesh = cube_mesh();
    mesh.positions.emplace_back(kNan, 0.0F, 0.0F);
    mesh.positions.emplace_back(0.0F, std::numeric_limits<float>::infinity(), 0.0F);
    mesh.triangles.push_back({0, 1, 8});
    mesh.triangles.push_back({0, 1, 9});
    mesh.triangles.push_back({0, 0, 1});
    mesh.triangles.push_back({0, 1, 77});  // no such position
    std::vector<std::string> notes;
    EXPECT_EQ(repaired(mesh, "it", notes).triangles.size(), 12u);
    ASSERT_EQ(notes.size(), 2u);
    EXPECT_NE(notes[0].find("it: 3 of 16 triangles"), std::string::npos) << notes[0];
    EXPECT_NE(notes[1].find("it: 1 of 16 triangles have no area"), std::string::npos) << notes[1];
}

TEST(RepairedMesh, IsRefusedWhereNothingIsLeft) {
    EXPECT_EQ(refusal({}), "it: has no faces; a surface is needed");
    Mesh points;
    points.positions.emplace_back(0.0F, 0.0F, 0.0F);
    EXPECT_EQ(refusal(points), "it: has no faces, only points or lines; a surface is needed");
    Mesh numbers = cube_mesh();
    for (V3f& p : numbers.positions) p.x = kNan;
    EXPECT_NE(refusal(numbers).find("it: none of its 12 triangles"), std::string::npos);
    Mesh flat = cube_mesh();
    for (V3f& p : flat.positions) p = V3f(1, 2, 3);
    EXPECT_NE(refusal(flat).find("12 have no area"), std::string::npos);
}

TEST(RepairedMesh, HasUnitNormalsWhateverWasGiven) {
    Mesh mesh = tessellated_sphere(24, 12);
    mesh.normals[3] = V3f(0, 0, 0);
    mesh.normals[50] = V3f(kNan, 0, 0);
    mesh.normals[60] *= 17.0F;
    std::vector<std::string> notes;
    const Mesh whole = repaired(mesh, "it", notes);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("2 normals"), std::string::npos) << notes[0];
    for (std::size_t i = 0; i < whole.normals.size(); ++i) {
        EXPECT_NEAR(whole.normals[i].length(), 1, 1e-5);
        EXPECT_GT(whole.normals[i].dot(whole.positions[i]), 0.98F);
    }
}

TEST(RepairedMesh, IsTurnedWhereItIsInsideOut) {
    Mesh mesh = cube_mesh();
    for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    std::vector<std::string> notes;
    const Mesh whole = repaired(mesh, "it", notes);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("inside out"), std::string::npos);
    EXPECT_GT(six_volumes(whole), 0);
    for (std::size_t i = 0; i < whole.normals.size(); ++i)
        EXPECT_GT(whole.normals[i].dot(whole.positions[i]), 0);
    // An open one has no inside.
    mesh.triangles.pop_back();
    notes.clear();
    EXPECT_LT(six_volumes(repaired(mesh, "it", notes)), 0);
    EXPECT_TRUE(notes.empty());
}

TEST(Mesh, FitsIntoTheUnitSphereWhereverItWas) {
    for (const float size : {1e-20F, 1.0F, 1e18F}) {
        Mesh mesh = cube_mesh();
        for (V3f& p : mesh.positions) p = (p + V3f(30, -20, 10)) * size;
        fit_into_unit_sphere(mesh);
        for (const V3f& p : mesh.positions) EXPECT_NEAR(p.length(), 1, 1e-5);
    }
}

}  // namespace
}  // namespace chromeball
