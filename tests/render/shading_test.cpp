#include <gtest/gtest.h>

#include <cmath>

#include "render/compare.h"
#include "render/preview.h"
#include "render/shapes.h"
#include "support/world.h"

// The three ways to shade, and pictures of what they differ in.

namespace chromeball {
namespace {

Environment sky(const World& world, int size = 64) {
    return {painted_map(*find_layout("latlong"), size, world), *find_layout("latlong")};
}

Image picture(const Scene& scene, const Environment& light, Shading shading) {
    PreviewOptions options;
    options.shading = shading;
    options.samples = 16;
    return preview(scene, Tracer(scene), light, View::orbit({96, 72}, 20, 20, 4, 35), options);
}

Scene one(Mesh mesh, Material material = {}) {
    Scene scene;
    scene.objects.push_back({"it", std::move(mesh), std::nullopt, material});
    return scene;
}

TEST(Shading, ByRaysIsThatByPixelsWhereNothingSeesItself) {
    const Environment light = sky(smooth_world);
    const Scene ball = one(tessellated_sphere());
    EXPECT_GT(
        compared(picture(ball, light, Shading::pixel), picture(ball, light, Shading::raytrace))
            .psnr,
        50);
    // A knot does see itself.
    const Scene knot = one(*shape("knot"));
    EXPECT_LT(
        compared(picture(knot, light, Shading::pixel), picture(knot, light, Shading::raytrace))
            .psnr,
        40);
}

TEST(Shading, ByRaysShowsTwoBallsInEachOther) {
    // A black ball before a mirror in a white world: where the mirror shows it is worked out here.
    Scene scene;
    scene.objects.push_back({"mirror", {}, Ball{}, {}});
    scene.objects.push_back({"black",
                             {},
                             Ball{V3d(2, 0.5, 1.5), 0.7},
                             {.kind = Material::Kind::flat, .color = V3f(0)}});
    const Environment white = sky([](V3d) { return V3d(1, 1, 1); }, 8);
    const View view = View::orbit({120, 120}, 0, 0, 5, 35);
    PreviewOptions options;
    options.shading = Shading::raytrace;
    options.samples = 1;
    const Image image = preview(scene, Tracer(scene), white, view, options);
    int black = 0, wrong = 0;
    const auto distance_off = [](const V3d& o, const V3d& d, const V3d& c) {
        const double along = (c - o).dot(d);
        return along > 0 ? (o + d * along - c).length() : 1e9;
    };
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 120; ++x) {
            const V3d o = view.eye(), d(view.beam(x + 0.5, y + 0.5, 1).direction);
            if (distance_off(o, d, V3d(2, 0.5, 1.5)) < 0.72) continue;  // in front
            const double off = distance_off(o, d, V3d(0, 0, 0));
            if (off > 0.98) continue;
            const V3d n = o + d * (-o.dot(d) - std::sqrt(1 - off * off));
            const V3d r = d - n * (2 * d.dot(n));
            const double shade = distance_off(n, r, V3d(2, 0.5, 1.5));
            if (std::abs(shade - 0.7) < 0.05) continue;  // its edge
            black += shade < 0.7;
            wrong += (image.pixel(x, y)[0] < 0.5F) != (shade < 0.7);
        }
    EXPECT_GT(black, 50);
    EXPECT_EQ(wrong, 0);
}

TEST(Shading, ByRaysDarkensWhereMatteThingsAreClose) {
    // A matte floor under a black ball in a white world; far off it is white, below the ball dark:
    // a ball of radius r at height h takes (r / h)^2 of the cosine-weighted sky right under it.
    Scene scene = one(*shape("plane"), {.kind = Material::Kind::diffuse});
    for (V3f& p : scene.objects[0].mesh.positions) p *= 20.0F;
    scene.objects.push_back(
        {"black", {}, Ball{V3d(0, 1, 0), 0.6}, {.kind = Material::Kind::flat, .color = V3f(0)}});
    const Environment white = sky([](V3d) { return V3d(1, 1, 1); }, 8);
    PreviewOptions options;
    options.shading = Shading::raytrace;
    options.samples = 256;
    const View side = View::orbit({9, 9}, 0, 3, 6, 2);  // looks under the ball, at the origin
    const Image image = preview(scene, Tracer(scene), white, side, options);
    EXPECT_NEAR(image.pixel(4, 4)[0], 1 - 0.36, 0.02);
    const View away = View::orbit({9, 9}, 0, 60, 3, 2, V3d(12, 0, 0));
    EXPECT_NEAR(preview(scene, Tracer(scene), white, away, options).pixel(4, 4)[0], 1, 0.01);
}

TEST(Shading, ByVerticesIsExactThereAndStraightBetween) {
    // A single large triangle facing the camera: its corners show the map, its middle their mean.
    Mesh mesh;
    for (const V3f& p : {V3f(-1, -1, 0), V3f(1, -1, 0), V3f(0, 1, 0)}) {
        mesh.positions.push_back(p);
        mesh.normals.push_back((V3f(p.x, p.y, 1.5F)).normalized());
    }
    mesh.triangles.push_back({0, 1, 2});
    const Scene scene = one(mesh);
    const View view = View::orbit({100, 100}, 0, 0, 4, 40);
    PreviewOptions options;
    options.shading = Shading::vertex;
    const Image image = preview(scene, Tracer(scene), sky(direction_as_color, 256), view, options);
    V3d mean(0, 0, 0);
    for (std::size_t i = 0; i < 3; ++i) {
        const V3d d = (V3d(mesh.positions[i]) - view.eye()).normalized(), n(mesh.normals[i]);
        mean += direction_as_color(d - n * (2 * d.dot(n))) / 3.0;
    }
    // The triangle's middle, (0, -1/3, 0), 4 away: half a picture is 4 tan 20 degrees.
    const int y = int(50 + 50 * (1.0 / 3) / (4 * std::tan(20 * 3.14159265 / 180)));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.pixel(50, y)[c], mean[c], 0.02);
}

TEST(Shading, ByVerticesIsTheMushThatItIsKnownFor) {
    const auto stripes = [](V3d d) {
        return V3d(1, 1, 1) * (std::sin(25 * std::atan2(d.x, d.z)) > 0 ? 1.0 : 0.0);
    };
    const Environment light = sky(stripes, 128);
    Scene ball;
    ball.objects.push_back({"ball", {}, Ball{}, {}});
    const Scene meshes = with_meshes_only(ball);
    EXPECT_FALSE(meshes.objects[0].ball);
    const Image pixel = picture(ball, light, Shading::pixel),
                vertex = picture(meshes, light, Shading::vertex);
    EXPECT_LT(compared(pixel, vertex).psnr, 20);
    const auto smooth = [](V3d d) { return smooth_world(d); };
    const Environment soft = sky(smooth, 64);
    EXPECT_GT(
        compared(picture(ball, soft, Shading::pixel), picture(meshes, soft, Shading::vertex)).psnr,
        25);
}

TEST(Comparison, HoldsBothPicturesAndTheirDifference) {
    Image a({2, 1}, 4), b({2, 1}, 4);
    const float values[] = {1, 0, 3, 1, 0, 0, 0, 0};
    std::copy_n(values, 8, a.row(0));
    b.pixel(0, 0)[0] = 0.5F;
    b.pixel(0, 0)[2] = 4;
    b.pixel(0, 0)[3] = 1;
    const Comparison comparison = compared(a, b);
    ASSERT_EQ(comparison.picture.size(), (Size{6, 1}));
    EXPECT_EQ(comparison.picture.pixel(0, 0)[2], 3);
    EXPECT_EQ(comparison.picture.pixel(2, 0)[2], 4);
    EXPECT_EQ(comparison.picture.pixel(4, 0)[0], 0.5F);
    EXPECT_EQ(comparison.picture.pixel(4, 0)[2], 1);
    // x / (1 + x): 1/2 - 1/3, 0, 4/5 - 3/4.
    EXPECT_NEAR(comparison.difference, (1.0 / 6 + 0.05) / 3, 1e-7);
    EXPECT_NEAR(comparison.psnr, -10 * std::log10((1.0 / 36 + 0.0025) / 3), 1e-4);
    EXPECT_TRUE(std::isinf(compared(a, a).psnr));
}

}  // namespace
}  // namespace chromeball
