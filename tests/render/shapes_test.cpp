#include "render/shapes.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

namespace chromeball {
namespace {

/// How often each edge is used, one way less the other; positions that are equal are one.
int open_edges(const Mesh& mesh) {
    std::map<std::tuple<float, float, float>, int> places;
    std::map<std::pair<int, int>, int> edges;
    for (const auto& t : mesh.triangles) {
        int at[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const V3f& p = mesh.positions[t[k]];
            at[k] =
                places.emplace(std::tuple(p.x + 0.0F, p.y + 0.0F, p.z + 0.0F), int(places.size()))
                    .first->second;
        }
        for (int k = 0; k < 3; ++k) {
            ++edges[{at[k], at[(k + 1) % 3]}];
            --edges[{at[(k + 1) % 3], at[k]}];
        }
    }
    int open = 0;
    for (const auto& [edge, balance] : edges) open += balance > 0;
    return open;
}

TEST(Shapes, AreWithinTheUnitSphereAndSmooth) {
    for (const std::string& name : shape_names()) {
        const Mesh mesh = *shape(name);
        ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
        float furthest = 0;
        for (const V3f& p : mesh.positions) furthest = std::max(furthest, p.length());
        EXPECT_NEAR(furthest, 1, 1e-3) << name;
        std::size_t against = 0;
        for (const auto& t : mesh.triangles) {
            const V3f &a = mesh.positions[t[0]], &b = mesh.positions[t[1]],
                      &c = mesh.positions[t[2]];
            const V3f face = (b - a).cross(c - a).normalized();
            for (const std::uint32_t i : t) {
                EXPECT_NEAR(mesh.normals[i].length(), 1, 1e-4) << name;
                against += mesh.normals[i].dot(face) < 0.7F;
            }
        }
        // The teapot's patches meet in creases at the bottom's middle and the lid's knob.
        EXPECT_LE(against, mesh.triangles.size() / 50) << name;
    }
}

TEST(Shapes, AreClosedAndOutsideOut) {
    for (const char* name : {"sphere", "torus", "knot", "bean"}) {
        const Mesh mesh = *shape(name);
        EXPECT_EQ(open_edges(mesh), 0) << name;
        EXPECT_GT(six_volumes(mesh), 0) << name;
    }
    EXPECT_GT(six_volumes(*shape("teapot")), 0);
}

TEST(Shapes, HaveTheirOwnProportions) {
    // The torus: tube 0.3 of an outer radius of 1, so its volume is 2 pi^2 R r^2.
    EXPECT_NEAR(six_volumes(*shape("torus")) / 6, 2 * 9.8696 * 0.7 * 0.09, 0.003);
    EXPECT_NEAR(six_volumes(*shape("sphere")) / 6, 4.18879, 0.01);
    EXPECT_EQ(shape("bean")->triangles.size(), 100352u);
    const Mesh plane = *shape("plane");
    for (const V3f& n : plane.normals) EXPECT_NEAR(n.y, 1, 1e-6);
    // Newell's teapot: 32 patches; with handle and spout twice as long as it is high.
    const Box pot = box_of(*shape("teapot"));
    EXPECT_NEAR((pot.high.x - pot.low.x) / (pot.high.y - pot.low.y), 6.43 / 3.15, 0.02);
    // The bean's arch: under its middle it is hollow.
    float lowest_middle = 1, lowest = 1;
    const Mesh bean = *shape("bean");
    for (const V3f& p : bean.positions) {
        lowest = std::min(lowest, p.y);
        if (std::abs(p.x) < 0.05F && std::abs(p.z) < 0.05F)
            lowest_middle = std::min(lowest_middle, p.y);
    }
    EXPECT_GT(lowest_middle, lowest + 0.15F);
}

TEST(Shapes, ThatAreNotKnownAreNone) { EXPECT_FALSE(shape("cup")); }

}  // namespace
}  // namespace chromeball
