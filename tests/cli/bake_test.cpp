#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cli/program.h"
#include "cli/world.h"

// The views of a scene from a point, as a user asks for them.

namespace chromeball {
namespace {

using namespace test;

/// A floor from -2 to 2 at y = 0, and a small square before each face's middle, 4 away from
/// (0, 1, 0), whose light tells which one it is: red is 1 to 6 in our order of faces.
std::string room() {
    std::string obj = "mtllib room.mtl\n";
    int count = 0;
    const auto quad = [&](const std::string& name, const V3d& middle, const V3d& a, const V3d& b) {
        obj += fmt::format("o {0}\nusemtl {0}\n", name);
        for (const V3d& p : {middle - a - b, middle + a - b, middle + a + b, middle - a + b}) {
            obj += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
            ++count;
        }
        obj += "f";
        for (int i = 3; i >= 0; --i) obj += fmt::format(" {}", count - i);
        obj += "\n";
    };
    const V3d directions[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int i = 0; i < 6; ++i) {
        const V3d& d = directions[i];
        const V3d a(d.y, d.z, d.x), b = d.cross(a);
        quad(fmt::format("face{}", i + 1), V3d(0, 1, 0) + d * 4.0, a * 0.5, b * 0.5);
    }
    quad("floor", V3d(0, 0, 0), V3d(2, 0, 0), V3d(0, 0, -2));
    return obj;
}
std::string materials() {
    std::string mtl = "newmtl floor\nKd 0.5 0.5 0.5\n";
    for (int i = 1; i <= 6; ++i) mtl += fmt::format("newmtl face{0}\nKd 0 0 0\nKe {0} 0 0\n", i);
    return mtl;
}

class Bake : public ::testing::Test {
protected:
    Bake() {
        write_bytes(folder_ / "room.obj", room());
        write_bytes(folder_ / "room.mtl", materials());
    }
    Outcome bake(const Words& words) {
        Words all{"bake", "room.obj", "--quiet", "--size=32", "--samples=4"};
        all.insert(all.end(), words.begin(), words.end());
        return run(folder_, all);
    }
    TempFolder folder_;
};

TEST_F(Bake, WritesSixViewsFromAPointByThePresetsNames) {
    ASSERT_EQ(bake({"--at=0,1,0", "--hide=floor", "-o", "faces"}).status, 0);
    const char* names[] = {"px", "nx", "py", "ny", "pz", "nz"};
    for (int i = 0; i < 6; ++i) {
        const Image face = read_floats(folder_ / fmt::format("faces/{}.exr", names[i]));
        ASSERT_EQ(face.size(), (Size{32, 32})) << names[i];
        EXPECT_NEAR(face.pixel(16, 16)[0], i + 1, 1e-3) << names[i];
        EXPECT_NEAR(face.pixel(1, 1)[0], 1, 1e-3) << "the white sky";
    }
    ASSERT_EQ(bake({"--at=0,1,0", "--for=alias", "-o", "alias"}).status, 0);
    for (const char* name : {"right", "left", "top", "bottom", "front", "back"})
        EXPECT_TRUE(exists(folder_ / fmt::format("alias/{}.tif", name))) << name;
}

TEST_F(Bake, WritesAnyLayout) {
    const Outcome outcome = bake({"--at=0,1,0", "--hide=floor", "-o", "map.exr"});
    ASSERT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "") << "a white sky's alpha is not above 1 but for rounding";
    const Image map = read_floats(folder_ / "map.exr");
    ASSERT_EQ(map.size(), (Size{64, 32}));
    EXPECT_NEAR(map.pixel(32, 16)[0], 5, 0.1) << "+Z in the middle";
    EXPECT_NEAR(map.pixel(16, 16)[0], 1, 0.1) << "+X at a quarter";
    EXPECT_NEAR(map.pixel(48, 16)[0], 2, 0.1);
    EXPECT_NEAR(map.pixel(30, 0)[0], 3, 0.1) << "+Y at the top";
    ASSERT_EQ(bake({"--at=0,1,0", "--hide=floor", "--yaw=180", "-o", "turned.exr"}).status, 0);
    EXPECT_NEAR(read_floats(folder_ / "turned.exr").pixel(32, 16)[0], 6, 0.1);
}

TEST_F(Bake, HidesWhatItIsTold) {
    const auto below = [&](const Words& more) {
        Words words{"--at=0,1,0", "--layout=openexr", "-o", "column.exr"};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(bake(words).status, 0);
        return read_floats(folder_ / "column.exr").pixel(16, 3 * 32 + 16)[0];
    };
    EXPECT_LT(below({}), 0.6F) << "the grey floor";
    EXPECT_NEAR(below({"--hide=floor"}), 4, 1e-3);
    EXPECT_NEAR(below({"--hide=floor", "--hide=face4"}), 1, 1e-3);
}

TEST_F(Bake, IsLitByAMap) {
    write_exr(folder_ / "sky.exr", world_map(*find_layout("latlong"), 64));
    ASSERT_EQ(
        bake({"--at=0,1,0", "--hide=floor", "--light=sky.exr", "--layout=openexr", "-o", "c.exr"})
            .status,
        0);
    const Image column = read_floats(folder_ / "c.exr");
    // The corner of +X's face: the direction (1, 1, 1).
    EXPECT_NEAR(column.pixel(0, 0)[0], 0.5 + 0.5 / std::sqrt(3.0), 0.03);
}

TEST_F(Bake, LooksThroughAFlatMirror) {
    // The floor as a mirror, by its name, by a point and a normal, and by three points: the eye at
    // (0, 1, 0) is mirrored to (0, -1, 0); from there +Y shows face 3 and nothing that lies below.
    for (const char* plane : {"floor", "5,0,3,0,2,0", "0,0,0,0,0,1,1,0,0"}) {
        const Outcome outcome =
            run(folder_, {"bake", "room.obj", "--size=32", "--samples=4", "--at=0,1,0",
                          "--mirror-plane", plane, "--layout=openexr", "-o", "column.exr"});
        ASSERT_EQ(outcome.status, 0) << plane << outcome.err;
        EXPECT_TRUE(outcome.says("mirrored to 0,-1,0")) << outcome.err;
        const Image column = read_floats(folder_ / "column.exr");
        EXPECT_NEAR(column.pixel(16, 2 * 32 + 16)[0], 3, 1e-3) << plane;
        EXPECT_NEAR(column.pixel(16, 3 * 32 + 16)[0], 1, 1e-3) << "the sky, not face 4: " << plane;
    }
}

TEST_F(Bake, KnowsPlacesByTheirNames) {
    const auto middle = [&](const std::string& at) {
        EXPECT_EQ(bake({"--at", at, "--hide=floor", "--layout=openexr", "-o", "n.exr"}).status, 0);
        return read_bytes(folder_ / "n.exr");
    };
    EXPECT_EQ(middle("floor"), middle("0,0,0"));
    EXPECT_NE(middle("floor"), middle("0,1,0"));
}

TEST_F(Bake, TellsWhatIsWrong) {
    const auto refuses = [&](const Words& words, const std::string& text, int status = 2) {
        Words all = words;
        all.insert(all.end(), {"-o", "no.exr"});
        const Outcome outcome = bake(all);
        EXPECT_EQ(outcome.status, status) << text_of(words) << outcome.err;
        EXPECT_TRUE(outcome.says(text)) << outcome.err;
        EXPECT_EQ(outcome.lines_with("error: "), 1u) << outcome.err;
        EXPECT_FALSE(exists(folder_ / "no.exr"));
    };
    refuses({}, "--at");
    refuses({"--at=0,0"}, "--at");
    refuses({"--at=flor"}, "did you mean \"floor\"?");
    refuses({"--at=0,1,0", "--hide=flor"}, "did you mean \"floor\"?");
    refuses({"--at=0,1,0", "--mirror-plane=0,0,0,0,0,0"}, "normal has no length");
    refuses({"--at=0,1,0", "--mirror-plane=0,0,0,1,0,0,2,0,0"}, "on one line");
    refuses({"--at=0,1,0", "--mirror-plane=1,2"}, "--mirror-plane");
    refuses({"--at=0,1,0", "--mirror-plane=ceiling"}, "no object of that name");
    refuses({"--at=0,0,0", "--mirror-plane=floor"}, "nothing is seen in it");
    refuses({"--at=0,1,0", "--light=none.exr"}, "none.exr", 1);
    EXPECT_EQ(run(folder_, {"bake", "none.gltf", "--at=0,0,0", "-o", "no.exr"}).status, 1);
    const Outcome odd = run(
        folder_, {"bake", "room.obj", "--at=0,1,0", "--size=20", "--samples=1", "-o", "odd.exr"});
    EXPECT_EQ(odd.status, 0);
    EXPECT_TRUE(odd.says("prefer 32")) << odd.err;
}

}  // namespace
}  // namespace chromeball
