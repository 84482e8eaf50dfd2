#include "render/bake.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/compare.h"
#include "render/shapes.h"
#include "support/directions.h"
#include "support/world.h"

namespace chromeball {
namespace {

Environment sky(const World& world, int size = 64) {
    return {painted_map(*find_layout("latlong"), size, world), *find_layout("latlong")};
}

Object flat_ball(const std::string& name, const V3d& center, double radius, const V3f& color) {
    return {name, {}, Ball{center, radius}, {.kind = Material::Kind::flat, .color = color}};
}

TEST(Bake, OfAnEmptySceneIsTheSkyWithEveryFaceInItsPlace) {
    const Environment light = sky(direction_as_color, 128);
    const Scene nothing;
    const Image column =
        bake(nothing, Tracer(nothing), light, V3d(3, 1, 2), {.size = 32, .samples = 4});
    const Image wanted = painted_map(*find_layout("openexr"), 32, direction_as_color);
    ASSERT_EQ(column.size(), wanted.size());
    for (int y = 0; y < column.height(); ++y)
        for (int x = 0; x < column.width(); ++x) {
            EXPECT_EQ(column.pixel(x, y)[3], 1);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(column.pixel(x, y)[c], wanted.pixel(x, y)[c], 3e-3) << x << "," << y;
        }
}

TEST(Bake, ShowsThingsWhereTheyAre) {
    Scene scene;
    const V3d at(1, 2, 3);
    const V3d directions[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int i = 0; i < 6; ++i)
        scene.objects.push_back(
            flat_ball("ball", at + directions[i] * 5.0, 1, V3f(float(i + 1), 0, 0)));
    const Image column =
        bake(scene, Tracer(scene), sky([](V3d) { return V3d(0, 0, 0); }), at, {.size = 32});
    for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(column.pixel(16, 32 * i + 16)[0], i + 1, 1e-4);
        EXPECT_EQ(column.pixel(2, 32 * i + 2)[0], 0);
    }
}

/// A mirror ball amid others, at a distance; how far environment mapping is from ray tracing.
double psnr_at(double distance) {
    Scene around;
    int i = 0;
    for (const V3d& d : directions_on_sphere(24)) {
        ++i;
        around.objects.push_back(
            flat_ball("other", d * distance, 0.2 * distance,
                      V3f(float(i % 3 == 0), float(i % 3 == 1), float(i % 3 == 2)) * 0.8F));
    }
    const Environment light = sky([](V3d) { return V3d(0.5, 0.5, 0.5); });
    const Environment baked(bake(around, Tracer(around), light, V3d(0, 0, 0), {.size = 256}),
                            *find_layout("openexr"));
    Scene scene = around;
    scene.objects.push_back({"mirror", {}, Ball{}, {}});
    const Tracer tracer(scene);
    const View view = View::orbit({96, 96}, 20, 10, 3, 40);
    PreviewOptions traced, mapped;
    traced.shading = Shading::raytrace;
    mapped.reflected = &baked;
    traced.samples = mapped.samples = 25;
    return compared(preview(scene, tracer, light, view, traced),
                    preview(scene, tracer, light, view, mapped))
        .psnr;
}

TEST(Bake, OfADistantSceneMakesMappingAgreeWithRayTracing) {
    const double near_by = psnr_at(5), further = psnr_at(50), far_away = psnr_at(2000);
    EXPECT_LT(near_by, 20) << "the ball's own size shows";
    EXPECT_GT(further, near_by + 3);
    EXPECT_GT(far_away, 38) << "all that is left is the map's resolution";
}

TEST(MirrorPlane, MirrorsPointsInPlanesOfAnyOrientation) {
    // e' = e - 2 (n.e - n.p) n, worked out by hand: the plane x + 2y + 2z = 9 at (1, 2, 2).
    const Plane plane{V3d(1, 2, 2), V3d(1, 2, 2) / 3.0};
    EXPECT_LT((mirrored(V3d(0, 0, 0), plane) - V3d(2, 4, 4)).length(), 1e-12);
    for (const V3d& n : directions_on_sphere(50)) {
        const Plane any{V3d(0.3, -2, 5), n};
        const V3d eye(4, -1, 2.5), image = mirrored(eye, any);
        EXPECT_LT((mirrored(image, any) - eye).length(), 1e-12) << "twice is where it was";
        EXPECT_NEAR(((eye + image) * 0.5 - any.point).dot(n), 0, 1e-12) << "the plane is half way";
        EXPECT_LT((eye - image).cross(n).length(), 1e-12) << "straight across";
    }
}

TEST(MirrorPlane, IsFoundThroughPointsAndFlatObjects) {
    const auto plane = plane_through(V3d(0, 1, 0), V3d(0, 1, 2), V3d(3, 1, 0));
    ASSERT_TRUE(plane);
    EXPECT_LT((plane->normal - V3d(0, 1, 0)).length(), 1e-12);
    EXPECT_FALSE(plane_through(V3d(0, 0, 0), V3d(1, 1, 1), V3d(3, 3, 3)));
    const auto floor = plane_of({"floor", *shape("plane"), std::nullopt, {}});
    ASSERT_TRUE(floor);
    EXPECT_LT((floor->normal - V3d(0, 1, 0)).length(), 1e-6);
    EXPECT_FALSE(plane_of({"torus", *shape("torus"), std::nullopt, {}}));
    EXPECT_FALSE(plane_of({"ball", {}, Ball{}, {}}));
}

/// A tilted flat mirror with things before and behind it, shaded with the map from the eye's image:
/// exact, wherever the things are. From a point on the mirror it is not.
TEST(MirrorPlane, MakesMappingExactForAFlatMirror) {
    const Rotation tilt = Rotation::yaw_pitch_roll(25, 60, 10);
    const V3d normal = tilt * V3d(0, 1, 0);
    Scene around;
    around.objects.push_back(
        flat_ball("near", normal * 0.8 + tilt * V3d(0.3, 0, 0.2), 0.3, V3f(1, 0, 0)));
    around.objects.push_back(flat_ball("far", normal * 4 + tilt * V3d(-2, 0, -1), 1, V3f(0, 1, 0)));
    around.objects.push_back(flat_ball("behind", -normal, 0.5, V3f(0, 0, 1)));
    Scene scene = around;
    Object mirror{"mirror", *shape("plane"), std::nullopt, {}};
    for (V3f& p : mirror.mesh.positions) p = V3f(tilt * V3d(p));
    for (V3f& n : mirror.mesh.normals) n = V3f(tilt * V3d(n));
    scene.objects.push_back(mirror);
    const Plane plane = *plane_of(mirror);
    const View view = View::orbit({128, 96}, 25, 35, 5, 30);
    const V3d eye = view.eye(), image = mirrored(eye, plane);
    ASSERT_GT((eye - plane.point).dot(plane.normal), 0);
    const Environment light = sky(direction_as_color, 128);
    const Tracer around_tracer(around), tracer(scene);
    const Environment from_image(
        bake(around, around_tracer, light, image,
             {.size = 512, .samples = 4, .clip = ClipPlane{plane.point, plane.normal}}),
        *find_layout("openexr"));
    const Environment from_mirror(
        bake(around, around_tracer, light, plane.point + plane.normal * 1e-3,
             {.size = 512, .samples = 4}),
        *find_layout("openexr"));
    PreviewOptions how;
    how.shading = Shading::raytrace;
    const Image traced = preview(scene, tracer, light, view, how);
    how.shading = Shading::pixel;
    how.reflected = &from_image;
    const Image by_image = preview(scene, tracer, light, view, how);
    how.reflected = &from_mirror;
    const Image by_mirror = preview(scene, tracer, light, view, how);
    EXPECT_GT(compared(traced, by_image).psnr, 38);
    EXPECT_LT(compared(traced, by_mirror).psnr, 25);
}

}  // namespace
}  // namespace chromeball
