#include <gtest/gtest.h>

#include <map>

#include "render/bake.h"
#include "render/load.h"
#include "render/preview.h"

// data/scenes/spheres.gltf: where environment mapping departs from ray tracing.

namespace chromeball {
namespace {

constexpr Size kSize{512, 288};

/// How many pixels show each of the spheres 1 to 4 (0: the mirror).
struct Seen {
    std::map<int, int> direct, in_mirror;
};

class Spheres : public ::testing::Test {
protected:
    Spheres() : scene_(load_scene(std::string(CHROMEBALL_DATA) + "/scenes/spheres.gltf")) {
        std::vector<std::string> notes;
        repair(scene_, "spheres.gltf", notes);
        EXPECT_TRUE(notes.empty());
        // Each sphere glows in a colour of its own, so that a pixel tells which one it shows.
        for (Object& object : scene_.objects)
            if (const int n = number(object); n > 0)
                object.material = {.kind = Material::Kind::flat,
                                   .color = V3f(float(n & 1), float(n >> 1 & 1), float(n >> 2))};
    }

    static int number(const Object& object) {
        return object.name == "mirror" ? 0 : object.name.back() - '0';
    }

    Seen seen(const Scene& scene, Shading shading) const {
        const Layout& latlong = *find_layout("latlong");
        const Environment black(Image(latlong.picture(1), 3), latlong);
        Scene matte = scene;
        matte.hide("mirror");
        const Environment baked(
            bake(matte, Tracer(matte), black, *scene_.place("probe"), {.size = 512, .samples = 1}),
            *find_layout("openexr"));
        const SceneCamera& viewer = scene_.cameras.at(0);
        const View view = View::at(kSize, viewer.position, viewer.to_world, viewer.fov_degrees);
        PreviewOptions options;
        options.samples = 1;
        options.shading = shading;
        options.reflected = &baked;
        const Tracer tracer(scene);
        const Image image = preview(scene, tracer, black, view, options);
        Seen seen;
        for (int y = 0; y < kSize.height; ++y)
            for (int x = 0; x < kSize.width; ++x) {
                const Beam beam = view.beam(x + 0.5, y + 0.5, 1);
                const Hit hit = tracer.intersect(beam.origin, beam.direction, 0);
                if (!hit) continue;
                const float* p = image.pixel(x, y);
                const int n = (p[0] > 0.5F ? 1 : 0) + (p[1] > 0.5F ? 2 : 0) + (p[2] > 0.5F ? 4 : 0);
                const bool mirror = number(scene.objects[hit.object]) == 0;
                ++(mirror ? seen.in_mirror : seen.direct)[n];
            }
        return seen;
    }
    Scene only(int n) const {
        Scene scene = scene_;
        std::erase_if(scene.objects,
                      [&](const Object& o) { return number(o) != n && number(o) != 0; });
        return scene;
    }

    Scene scene_;
};

TEST_F(Spheres, AreAMirrorFourOthersAViewerAndAPointOffItsCentre) {
    EXPECT_EQ(scene_.objects.size(), 5u);
    EXPECT_EQ(scene_.objects[0].material, *find_material("mirror"));
    ASSERT_EQ(scene_.cameras.size(), 1u);
    EXPECT_EQ(scene_.cameras[0].name, "viewer");
    ASSERT_TRUE(scene_.place("probe"));
    const V3d middle = *scene_.place("mirror");
    const double radius =
        0.5 * (box_of(scene_.objects[0].mesh).high.x - box_of(scene_.objects[0].mesh).low.x);
    const double off = (*scene_.place("probe") - middle).length();
    EXPECT_GT(off, 0.25 * radius);
    EXPECT_LT(off, radius) << "inside the mirror";
}

// What each of the two sees:
//
//          ray tracing                               environment mapping
//     1    nowhere                                   in the mirror
//     2    partly, in the mirror only                nowhere
//     3    partly directly, and in the mirror        as ray tracing
//     4    directly and in the mirror                as ray tracing
TEST_F(Spheres, AreSeenAsTheTableSays) {
    constexpr int kSome = 20;  // pixels; no rounding
    Seen traced = seen(scene_, Shading::raytrace), mapped = seen(scene_, Shading::pixel);
    EXPECT_EQ(traced.direct[1], 0);
    EXPECT_EQ(traced.in_mirror[1], 0);
    EXPECT_EQ(mapped.direct[1], 0);
    EXPECT_GT(mapped.in_mirror[1], kSome);

    EXPECT_EQ(traced.direct[2], 0);
    EXPECT_GT(traced.in_mirror[2], kSome);
    EXPECT_EQ(mapped.direct[2], 0);
    EXPECT_EQ(mapped.in_mirror[2], 0);
    EXPECT_LT(traced.in_mirror[2], 0.9 * seen(only(2), Shading::raytrace).in_mirror[2]) << "partly";

    EXPECT_GT(traced.direct[3], 3 * kSome);
    EXPECT_GT(traced.in_mirror[3], kSome);
    EXPECT_GT(mapped.in_mirror[3], kSome);
    EXPECT_EQ(mapped.direct[3], traced.direct[3]);
    EXPECT_LT(traced.direct[3], 0.9 * seen(only(3), Shading::raytrace).direct[3]) << "partly";

    EXPECT_GT(traced.direct[4], 3 * kSome);
    EXPECT_GT(traced.in_mirror[4], kSome);
    EXPECT_GT(mapped.in_mirror[4], kSome);
    EXPECT_EQ(mapped.direct[4], traced.direct[4]);
}

TEST_F(Spheres, HidesTwoBehindFour) {
    Scene without = scene_;
    without.hide("sphere 4");
    EXPECT_GT(seen(without, Shading::raytrace).direct[2], 100) << "4 hides it directly";
}

}  // namespace
}  // namespace chromeball
