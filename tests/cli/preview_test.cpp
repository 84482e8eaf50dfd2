#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cli/program.h"
#include "cli/world.h"

// An object in the light of a map, as a user asks for it.

namespace chromeball {
namespace {

using namespace test;

class Preview : public ::testing::Test {
protected:
    Preview() { write_exr(folder_ / "map.exr", world_map(*find_layout("latlong"), 64)); }

    Outcome preview(const Words& words) {
        Words all{"preview", "map.exr", "--quiet"};
        const auto is_size = [](const std::string& word) { return word.starts_with("--size"); };
        if (std::none_of(words.begin(), words.end(), is_size)) all.push_back("--size=64,48");
        all.insert(all.end(), words.begin(), words.end());
        return run(folder_, all);
    }
    /// A picture that must succeed without a word.
    Image picture(const Words& words, const std::string& name = "out.exr") {
        Words all = words;
        all.insert(all.end(), {"-o", name});
        const Outcome outcome = preview(all);
        EXPECT_EQ(outcome.status, 0) << text_of(all) << "\n" << outcome.err;
        EXPECT_EQ(outcome.err, "") << text_of(all);
        EXPECT_EQ(outcome.out, "");
        return exists(folder_ / name) ? read_floats(folder_ / name) : Image();
    }
    std::string bytes(const std::string& name) { return read_bytes(folder_ / name); }

    TempFolder folder_;
};

/// A pixel of the synthetic world as the direction it shows.
V3d direction_at(const Image& image, int x, int y) {
    const float* p = image.pixel(x, y);
    return (V3d(p[0], p[1], p[2]) * 2.0 - V3d(1, 1, 1)).normalized();
}

TEST_F(Preview, ShowsAMirrorBallFromTheCamerasSide) {
    const Image image = picture({"--orbit=0,0,4", "--float"});
    ASSERT_EQ(image.size(), (Size{64, 48}));
    EXPECT_EQ(image.channels(), 4);
    EXPECT_GT(direction_at(image, 32, 24).z, 0.99);
    EXPECT_GT(direction_at(image, 40, 24).x, 0.3);
    EXPECT_GT(direction_at(image, 32, 16).y, 0.3);
    EXPECT_EQ(image.pixel(1, 1)[3], 0) << "nothing behind it";
    // From the side.
    EXPECT_GT(direction_at(picture({"--orbit=90,0"}), 32, 24).x, 0.99);
}

TEST_F(Preview, TakesMapsOfAllShapes) {
    const Image wanted = picture({"--orbit=20,30,4", "--float"});
    for (const char* layout : {"openexr", "strip-h", "angular"}) {
        const Layout& shape = *find_layout(layout);
        write_exr(folder_ / "other.exr", world_map(shape, 128));
        Words words{"preview", "other.exr", "--size=64,48", "--orbit=20,30,4",
                    "--quiet", "-o",        "b.exr"};
        if (std::string(layout) == "angular") words.push_back("--from=angular");
        const Outcome outcome = run(folder_, words);
        ASSERT_EQ(outcome.status, 0) << layout << outcome.err;
        const Image image = read_floats(folder_ / "b.exr");
        for (int y = 14; y < 34; ++y)
            for (int x = 22; x < 42; ++x)
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(image.pixel(x, y)[c], wanted.pixel(x, y)[c], 0.01) << layout;
    }
    ASSERT_EQ(run(folder_, {"convert", "map.exr", "--from=latlong", "--layout=faces", "--size=64",
                            "-o", "faces", "--quiet"})
                  .status,
              0);
    EXPECT_EQ(run(folder_, {"preview", "faces", "--size=32", "-o", "c.png", "--quiet"}).status, 0);
}

TEST_F(Preview, OfAPhotosBallThroughItsCameraIsThePhoto) {
    const Size size{200, 150};
    const MirrorBall ball = near_ball(size, V3d(0.08, -0.05, -1).normalized(), 6, 250);
    write_exr(folder_ / "photo.exr", ball_photo(size, ball));
    const Outline& e = ball.outline();
    const std::string ellipse =
        fmt::format("--ellipse={},{},{},{},{}", e.cx, e.cy, e.a, e.b, e.angle);
    const Outcome outcome = run(folder_, {"preview", "photo.exr", "--through=photo",
                                          "--focal-px=250", ellipse, "--float", "-o", "again.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Image photo = read_floats(folder_ / "photo.exr"),
                again = read_floats(folder_ / "again.exr");
    ASSERT_EQ(again.size(), size);
    double worst = 0, covered = 0;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            covered += double(again.pixel(x, y)[3]);
            if (std::hypot(x + 0.5 - e.cx, y + 0.5 - e.cy) > 0.85 * e.b) continue;
            for (int c = 0; c < 3; ++c)
                worst =
                    std::max(worst, double(std::abs(photo.pixel(x, y)[c] - again.pixel(x, y)[c])));
        }
    EXPECT_LT(worst, 0.02);
    EXPECT_NEAR(covered, area(e), 0.02 * area(e)) << "it covers the ball and no more";
    // The same camera told by hand, for a map.
    const Words told{"--ellipse=120,60,40,40,0", "--focal-px=420", "--size=200,150",
                     "--orbit=1,2,3"};
    const Image by_hand = picture(told);
    ASSERT_EQ(by_hand.size(), size);
    EXPECT_EQ(by_hand.pixel(120, 60)[3], 1);
    EXPECT_EQ(by_hand.pixel(60, 100)[3], 0);
}

TEST_F(Preview, TurnsWithTheCamera) {
    // A quarter turn to the left about +Y takes -Z to -X: the ball's front shows +X.
    const Words camera{"--ball=32,24,20", "--orthographic"};
    Words turned = camera;
    turned.push_back("--camera-to-world=0,0,1,0,1,0,-1,0,0");
    EXPECT_GT(direction_at(picture(camera), 32, 24).z, 0.98);
    EXPECT_GT(direction_at(picture(turned), 32, 24).x, 0.98);
}

TEST_F(Preview, KnowsMeshesMaterialsAndSets) {
    std::vector<Words> commands;
    int n = 0;
    const auto add = [&](const Words& words) {
        Words all{"preview",
                  "map.exr",
                  "--size=48,32",
                  "--samples=4",
                  "--quiet",
                  "-o",
                  fmt::format("m{}.png", n++)};
        all.insert(all.end(), words.begin(), words.end());
        commands.push_back(all);
    };
    for (const char* mesh : {"sphere", "torus", "plane", "knot", "bean", "teapot"})
        add({"--mesh", mesh});
    for (const char* material : {"mirror", "chrome", "aluminium", "silver", "gold", "copper",
                                 "glass", "glossy", "diffuse"})
        add({"--material", material});
    add({"--material=gold", "--roughness=0.4", "--pixel-filter=gaussian"});
    add({"--material=glass", "--ior=1.33", "--color=0.9,1,0.9", "--pixel-filter=triangle"});
    add({"--set=lookdev", "--background", "--noise=0.02"});
    const auto outcomes = run_all(folder_, commands);
    std::set<std::string> different;
    for (std::size_t i = 0; i < commands.size(); ++i) {
        EXPECT_EQ(outcomes[i].status, 0) << text_of(commands[i]) << outcomes[i].err;
        different.insert(bytes(fmt::format("m{}.png", i)));
    }
    EXPECT_EQ(different.size(), commands.size() - 1) << "all differ but for the two mirror spheres";
}

TEST_F(Preview, HasTheSameBytesForAnyNumberOfThreads) {
    for (const char* material : {"mirror", "glossy"}) {
        picture({"--material", material, "--threads=1"}, "one.exr");
        picture({"--material", material, "--threads=3"}, "three.exr");
        EXPECT_EQ(bytes("one.exr"), bytes("three.exr")) << material;
    }
}

/// A grey plate with a ball through a known lens.
struct MadeUpPlate {
    Size size{200, 150};
    MirrorBall ball = near_ball(size, V3d(0.05, 0.02, -1).normalized(), 8, 300);
    Words words;

    explicit MadeUpPlate(const std::string& path) {
        write_exr(path, ball_photo(size, ball));
        const Outline& e = ball.outline();
        words = {"preview",
                 path,
                 "--over",
                 path,
                 "--focal-px=300",
                 "--quiet",
                 "--float",
                 fmt::format("--ellipse={},{},{},{},{}", e.cx, e.cy, e.a, e.b, e.angle)};
    }
    Words with(const Words& more) const {
        Words all = words;
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
};

TEST_F(Preview, PutsAnObjectInTheBallsPlace) {
    const MadeUpPlate plate(folder_ / "plate.exr");
    const Outline& e = plate.ball.outline();
    const Image photo = read_floats(folder_ / "plate.exr");
    // A mirror ball in the mirror ball's place is the photo again.
    ASSERT_EQ(run(folder_, plate.with({"-o", "same.exr"})).status, 0);
    const Image same = read_floats(folder_ / "same.exr");
    ASSERT_EQ(same.size(), plate.size);
    double worst = 0;
    for (int y = 0; y < 150; ++y)
        for (int x = 0; x < 200; ++x) {
            const double r = std::hypot(x + 0.5 - e.cx, y + 0.5 - e.cy) / e.a;
            if (r > 0.85 && r < 1.03) continue;
            for (int c = 0; c < 3; ++c)
                worst =
                    std::max(worst, double(std::abs(photo.pixel(x, y)[c] - same.pixel(x, y)[c])));
        }
    EXPECT_LT(worst, 0.03);
    // Half as large, and the rest of the ball painted out: grey as all around.
    ASSERT_EQ(run(folder_, plate.with({"--patch", "--scale=0.5", "-o", "small.exr"})).status, 0);
    const Image small = read_floats(folder_ / "small.exr");
    const int cx = int(e.cx), cy = int(e.cy);
    EXPECT_NEAR(small.pixel(cx + int(0.8 * e.a), cy)[0], 0.18, 0.01);
    EXPECT_NEAR(small.pixel(cx, cy - int(0.8 * e.a))[2], 0.18, 0.01);
    EXPECT_GT(small.pixel(cx, cy)[2], 0.9F) << "its middle shows the camera's side";
    // Without --patch the photo's ball is there still.
    ASSERT_EQ(run(folder_, plate.with({"--scale=0.5", "-o", "ball.exr"})).status, 0);
    const Image with_ball = read_floats(folder_ / "ball.exr");
    EXPECT_EQ(with_ball.pixel(cx + int(0.8 * e.a), cy)[0], photo.pixel(cx + int(0.8 * e.a), cy)[0]);
    // Lit by a map of its own.
    Words by_map = plate.with({"-o", "map_lit.exr"});
    by_map[1] = "map.exr";
    EXPECT_EQ(run(folder_, by_map).status, 0);
    EXPECT_LT(largest_difference(same, read_floats(folder_ / "map_lit.exr")), 0.3)
        << "the same world";
}

TEST_F(Preview, KeepsWhatDoesNotGoWithPlatesApart) {
    const MadeUpPlate plate(folder_ / "plate.exr");
    for (const Words& more :
         {Words{"--turntable=3", "-o", "a.#.exr"}, Words{"--background", "-o", "a.exr"},
          Words{"--set=lookdev", "-o", "a.exr"}, Words{"--size=20", "-o", "a.exr"},
          Words{"-o", "plate.exr"}})
        EXPECT_EQ(run(folder_, plate.with(more)).status, 2) << text_of(more);
    EXPECT_EQ(preview({"--patch", "-o", "a.exr"}).status, 2);
    EXPECT_FALSE(exists(folder_ / "a.exr"));
}

TEST_F(Preview, RendersAScenesOwnCamera) {
    const std::string scene = std::string(CHROMEBALL_DATA) + "/scenes/spheres.gltf";
    const Image traced =
        picture({"--scene", scene, "--shading=raytrace", "--samples=4", "--size=64,36"});
    const Image mapped =
        picture({"--scene", scene, "--reflect-from=probe", "--samples=4", "--size=64,36"});
    EXPECT_GT(largest_difference(traced, mapped), 0.1);
    // Side by side with their difference.
    const Image both = picture({"--scene", scene, "--compare=pixel,raytrace",
                                "--reflect-from=probe", "--samples=4", "--size=64,36"});
    EXPECT_EQ(both.size(), (Size{192, 36}));
    EXPECT_EQ(preview({"--scene", scene, "--reflect-from=prob", "-o", "no.png"}).status, 2);
    EXPECT_EQ(preview({"--compare=pixel", "-o", "no.png"}).status, 2);
    EXPECT_EQ(preview({"--compare=pixel,rays", "-o", "no.png"}).status, 2);
    EXPECT_EQ(preview({"--shading=flat", "-o", "no.png"}).status, 2);
}

TEST_F(Preview, WritesATurntable) {
    const Outcome outcome = preview({"--turntable=4", "--orbit=0,0", "-o", "turn.##.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const V3d fronts[] = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}};
    for (int i = 0; i < 4; ++i) {
        const Image image = read_floats(folder_ / (fmt::format("turn.0{}.exr", i + 1)));
        EXPECT_GT(direction_at(image, 32, 24).dot(fronts[i]), 0.98) << i;
    }
}

TEST_F(Preview, GoesThroughAView) {
    const Image plain = picture({"--bits=8"}, "plain.png");
    const Image viewed = picture({"--display=sRGB", "--view=ACES SDR", "--bits=8"}, "viewed.png");
    EXPECT_GT(largest_difference(plain, viewed), 0.05);
    EXPECT_EQ(plain.channels(), 4) << "PNG has alpha";
}

TEST_F(Preview, TellsWhatIsWrongWithWords) {
    const auto refuses = [&](const Words& words, const std::string& text) {
        Words all = words;
        all.insert(all.end(), {"-o", "no.png"});
        const Outcome outcome = preview(all);
        EXPECT_EQ(outcome.status, 2) << text_of(words) << outcome.err;
        EXPECT_TRUE(outcome.says(text)) << text_of(words) << ": " << outcome.err;
        EXPECT_EQ(outcome.lines_with("error: "), 1u);
        EXPECT_FALSE(exists(folder_ / "no.png"));
    };
    refuses({"--mesh=teapott"}, "did you mean \"teapot\"?");
    refuses({"--material=chrom"}, "did you mean \"chrome\"?");
    refuses({"--material=diffuse", "--roughness=0.5"}, "--roughness");
    refuses({"--ior=1.3"}, "glass");
    refuses({"--color=2"}, "--color 2");
    refuses({"--orbit=0,120"}, "elevation");
    refuses({"--orbit=0"}, "AZ,EL");
    refuses({"--orbit=0,0,nan"}, "--orbit");
    refuses({"--orbit=0,0,-3"}, "distance");
    refuses({"--fov=0"}, "--fov");
    refuses({"--samples=0"}, "--samples");
    refuses({"--from=ball"}, "--from ball");
    refuses({"--turntable=3"}, "turn.####.png");
    refuses({"--through=photo"}, "--ellipse");
    refuses({"--ball=32,24,10", "--turntable=3", "-o", "a.#.png"}, "");
    EXPECT_EQ(preview({"--size=0,10", "-o", "no.png"}).status, 2);
    EXPECT_EQ(preview({"-o", "no.gif"}).status, 2);
    EXPECT_EQ(preview({"-o", "map.exr"}).status, 2) << "would replace its input";
    EXPECT_EQ(preview({"-o", "nowhere/no.png"}).status, 1);
}

TEST_F(Preview, TellsWhatIsWrongWithFiles) {
    const auto fails = [&](const std::string& name, const std::string& text,
                           const std::string& says) {
        if (!text.empty() || name == "empty.obj") write_bytes(folder_ / name, text);
        const Outcome outcome = preview({"--mesh", name, "-o", "no.png"});
        EXPECT_EQ(outcome.status, 1) << name << outcome.err;
        EXPECT_TRUE(outcome.says("error: " + name + ": ")) << outcome.err;
        EXPECT_TRUE(outcome.says(says)) << outcome.err;
        EXPECT_EQ(outcome.lines_with("error: "), 1u);
        EXPECT_FALSE(exists(folder_ / "no.png"));
    };
    fails("none.obj", "", "no such file");
    fails("empty.obj", "", "is empty");
    fails("bad.ply", "ply\nnonsense", "cannot be read");
    fails("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "");
    fails("nan.obj", "v nan nan nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "");
    fails("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no area");
    EXPECT_EQ(run(folder_, {"preview", "nothing.exr", "-o", "no.png"}).status, 1);
    // A photo without a ball.
    write_exr(folder_ / "grey.exr", Image({60, 50}, 3));
    const Outcome outcome = run(folder_, {"preview", "grey.exr", "-o", "no.png"});
    EXPECT_EQ(outcome.status, 4) << outcome.err;
    EXPECT_FALSE(exists(folder_ / "no.png"));
}

TEST_F(Preview, RepairsAMeshAndSaysSo) {
    // Inside out, without normals, one triangle of no area.
    write_bytes(
        folder_ / "t.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\nf 1 1 2\n");
    const Outcome outcome = preview({"--mesh=t.obj", "--background", "-o", "t.png"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("warning: t.obj: is inside out")) << outcome.err;
}

}  // namespace
}  // namespace chromeball
