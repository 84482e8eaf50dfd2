#include "render/preview.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "render/shapes.h"
#include "render/tracer.h"
#include "support/world.h"

namespace chromeball {
namespace {

using std::numbers::pi;

Environment world_light(const World& world, int size = 128) {
    return {painted_map(*find_layout("latlong"), size, world), *find_layout("latlong")};
}
Environment white_light() {
    return world_light([](V3d) { return V3d(1, 1, 1); }, 16);
}

Scene one(const char* material, const char* mesh = nullptr) {
    Object object{"it", {}, std::nullopt, *find_material(material)};
    if (mesh)
        object.mesh = *shape(mesh);
    else
        object.ball = Ball{};
    Scene scene;
    scene.objects.push_back(object);
    return scene;
}

Image picture(const Scene& scene, const Environment& light, const View& view,
              const PreviewOptions& options = {}) {
    return preview(scene, Tracer(scene), light, view, options);
}

View small_orbit(double azimuth = 30, double elevation = 15) {
    return View::orbit({96, 64}, azimuth, elevation, 4, 35);
}

double largest_difference(const Image& a, const Image& b) {
    double largest = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x)
            for (int c = 0; c < 4; ++c)
                largest = std::max(largest,
                                   std::abs(double(a.pixel(x, y)[c]) - double(b.pixel(x, y)[c])));
    return largest;
}

/// Colours of pixels that are wholly covered, against what a direction that the test works out by
/// itself would show.
template <class Direction>
void expect_directions(const Image& image, double tolerance, const Direction& direction) {
    int compared = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const float* p = image.pixel(x, y);
            if (p[3] < 1) continue;
            const std::optional<V3d> d = direction(x + 0.5, y + 0.5);
            if (!d) continue;
            ++compared;
            const V3d wanted = direction_as_color(*d);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(p[c], wanted[c], tolerance) << x << "," << y;
        }
    EXPECT_GT(compared, 200);
}

TEST(Preview, OfAMirrorBallShowsWhatTheBallsProjectionSays) {
    const Environment light = world_light(direction_as_color, 256);
    Camera lens;
    lens.focal = 250;
    lens.principal = V2d(60, 50);
    const MirrorBall ball(lens, {V3d(0.1, -0.05, -1).normalized(), std::asin(1 / 5.0)});
    const Rotation turn = Rotation::yaw_pitch_roll(70, 20, -30);
    const Image image = picture(one("mirror"), light, View::of_ball({160, 120}, lens, ball, turn));
    // 0.02: a pixel near the rim is the mean over many degrees.
    expect_directions(image, 0.02, [&](double x, double y) -> std::optional<V3d> {
        const V2d at(x, y);
        const V2d from(at.x - ball.outline().cx, at.y - ball.outline().cy);
        if (from.length() > 0.9 * ball.outline().b) return std::nullopt;
        return turn * *ball.to_direction(at);
    });
}

TEST(Preview, OfWritingIsMirroredAsAMirrorDoesIt) {
    // From +Z a ball shows what lies to the right, +X, on its right, and what is up above.
    const Image image = picture(one("mirror"), world_light(direction_as_color), small_orbit(0, 0));
    EXPECT_GT(image.pixel(60, 32)[0], image.pixel(36, 32)[0]);
    EXPECT_GT(image.pixel(48, 20)[1], image.pixel(48, 44)[1]);
    EXPECT_GT(image.pixel(48, 32)[2], 0.95F) << "its middle shows the camera's side";
    // A flat mirror on the ground shows the far side upside down.
    const Image floor =
        picture(one("mirror", "plane"), world_light(direction_as_color), small_orbit(0, 45));
    EXPECT_NEAR(floor.pixel(48, 32)[1], 0.5 + 0.5 * std::sqrt(0.5), 0.01);
    EXPECT_NEAR(floor.pixel(48, 32)[2], 0.5 - 0.5 * std::sqrt(0.5), 0.01);
}

TEST(Preview, OfAFineMeshIsThatOfTheBall) {
    const Environment light = world_light(smooth_world);
    Scene mesh = one("mirror");
    mesh.objects[0].ball.reset();
    mesh.objects[0].mesh = tessellated_sphere(256, 128);
    const Image by_mesh = picture(mesh, light, small_orbit()),
                by_ball = picture(one("mirror"), light, small_orbit());
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 96; ++x)
            if (by_ball.pixel(x, y)[3] == 1 && by_mesh.pixel(x, y)[3] == 1)
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(by_mesh.pixel(x, y)[c], by_ball.pixel(x, y)[c], 0.02)
                        << x << "," << y;
                }
}

TEST(Preview, FiltersWhatTheMirrorShrinks) {
    // A fine checker: at the rim of the ball it must be grey, not noise.
    const auto checker = [](V3d d) {
        const double lon = std::atan2(d.x, d.z), lat = std::asin(d.y);
        const bool odd = (int(std::floor(lon * 20)) + int(std::floor(lat * 20))) % 2 != 0;
        return V3d(1, 1, 1) * (odd ? 1.0 : 0.0);
    };
    const Environment light = world_light(checker, 256);
    PreviewOptions few, many;
    few.samples = 1;
    many.samples = 144;
    for (const char* mesh : {"sphere", "torus"}) {
        const Scene scene = one("mirror", std::string(mesh) == "sphere" ? nullptr : mesh);
        const Image a = picture(scene, light, small_orbit(), few),
                    b = picture(scene, light, small_orbit(), many);
        double square = 0;
        int count = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 96; ++x)
                if (a.pixel(x, y)[3] == 1 && b.pixel(x, y)[3] == 1) {
                    square += std::pow(double(a.pixel(x, y)[0]) - double(b.pixel(x, y)[0]), 2);
                    ++count;
                }
        // Without a filter one sample is 0 or 1 where the mean is 1/2: an RMS of 0.5.
        EXPECT_LT(std::sqrt(square / count), 0.12) << mesh;
    }
}

/// A ray and a direction that it is turned towards, by an angle.
V3d turned(const V3d& d, const V3d& towards, double angle) {
    return d * std::cos(angle) + towards * std::sin(angle);
}

/// In the plane of the ray and the ball's middle, at the incidence i and sin t = sin i / n: what is
/// reflected turns outwards by pi - 2 i; what goes through is bent inwards by i - t twice, and by
/// pi - 2 t for each time that it is reflected inside.
TEST(Preview, OfGlassFollowsSnellAndFresnelThroughABall) {
    const Environment light = world_light(direction_as_color, 128);
    const View view = small_orbit(20, 10);
    PreviewOptions options;
    options.samples = 36;
    const Image image = picture(one("glass"), light, view, options);
    int compared = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const V3d o = view.eye(), d(view.beam(x + 0.5, y + 0.5, 1).direction);
            const double middle = -o.dot(d), off = (o + d * middle).length();
            if (off > 0.9 || off < 1e-3) continue;
            const double i = std::asin(off), t = std::asin(off / 1.5);
            const double r = fresnel_dielectric(static_cast<float>(std::cos(i)), 1.5F);
            const V3d inward = -(o + d * middle).normalized();
            V3d wanted = direction_as_color(turned(d, -inward, pi - 2 * i)) * r;
            for (int k = 0; k < 6; ++k)
                wanted += direction_as_color(turned(d, inward, 2 * (i - t) + k * (pi - 2 * t))) *
                          ((1 - r) * (1 - r) * std::pow(r, k));
            // A pixel near the rim is the mean over many degrees.
            const double tolerance = off < 0.7 ? 0.01 : 0.03;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(image.pixel(x, y)[c], wanted[c], tolerance) << x << "," << y;
            ++compared;
        }
    EXPECT_GT(compared, 500);
}

TEST(Preview, OfGlassAndMirrorsInAWhiteWorldIsWhite) {
    for (const Shading shading : {Shading::pixel, Shading::raytrace})
        for (const auto& [material, mesh] : {std::pair<const char*, const char*>{"mirror", "torus"},
                                             {"glass", nullptr},
                                             {"glass", "knot"},
                                             {"mirror", "bean"}}) {
            PreviewOptions options;
            options.shading = shading;
            options.samples = 4;
            const Image image = picture(one(material, mesh), white_light(), small_orbit(), options);
            for (int y = 0; y < 64; ++y)
                for (int x = 0; x < 96; ++x)
                    EXPECT_NEAR(image.pixel(x, y)[1], image.pixel(x, y)[3], 2e-3) << material;
        }
}

TEST(Preview, OfRoughMirrorsLosesOnlyWhatIsMasked) {
    for (const float roughness : {0.1F, 0.3F, 1.0F}) {
        Scene scene = one("mirror");
        scene.objects[0].material.roughness = roughness;
        const Image image = picture(scene, white_light(), small_orbit());
        const float middle = image.pixel(48, 32)[0];
        EXPECT_LE(middle, 1.0001F);
        // At alpha = 1 and straight on the integral can be done: 1 - ln 2 comes back.
        if (roughness < 0.5F)
            EXPECT_GT(middle, 0.98F);
        else
            EXPECT_NEAR(middle, 1 - std::log(2.0), 0.01);
    }
    // In a world of formula d.z a rough mirror blurs about the mirrored direction: still its value
    // times a bit less, and smooth across the ball.
    const Environment light = world_light([](V3d d) { return V3d(1 + 0.9 * d.z, 1, 1); });
    Scene polished = one("mirror"), rough = one("mirror");
    rough.objects[0].material.roughness = 0.2F;
    const Image a = picture(polished, light, small_orbit(0, 0)),
                b = picture(rough, light, small_orbit(0, 0));
    for (int x = 36; x < 60; ++x) EXPECT_NEAR(a.pixel(x, 32)[0], b.pixel(x, 32)[0], 0.06) << x;
}

TEST(Preview, OfMatteIsIrradiance) {
    const Environment light =
        world_light([](V3d d) { return V3d(1 + 0.9 * d.z, 1 + 0.6 * d.y, 1); });
    const View view = small_orbit(0, 0);
    const Image image = picture(one("diffuse"), light, view);
    int compared = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 96; ++x) {
            if (image.pixel(x, y)[3] < 1) continue;
            const V3d o = view.eye(), d(view.beam(x + 0.5, y + 0.5, 1).direction);
            const double middle = -o.dot(d), room = 1 - (o + d * middle).length2();
            const V3d n = o + d * (middle - std::sqrt(std::max(0.0, room)));
            EXPECT_NEAR(image.pixel(x, y)[0], 0.8 * (1 + 0.6 * n.z), 0.02);
            EXPECT_NEAR(image.pixel(x, y)[1], 0.8 * (1 + 0.4 * n.y), 0.02);
            ++compared;
        }
    EXPECT_GT(compared, 500);
}

TEST(Preview, CoversWhatItCovers) {
    // The ball's disk: the tangent cone from 4 radii away.
    const Image image = picture(one("mirror"), white_light(), small_orbit());
    double area = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 96; ++x) {
            area += double(image.pixel(x, y)[3]);
            EXPECT_NEAR(image.pixel(x, y)[0], image.pixel(x, y)[3], 1e-4)
                << "colour is multiplied by alpha";
        }
    const double focal = 32 / std::tan(17.5 * pi / 180), radius = focal * std::tan(std::asin(0.25));
    EXPECT_NEAR(area, pi * radius * radius, 0.005 * pi * radius * radius);
    PreviewOptions options;
    options.background = true;
    const Image all = picture(one("mirror"), white_light(), small_orbit(), options);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 96; ++x) EXPECT_EQ(all.pixel(x, y)[3], 1);
}

TEST(Preview, HasTheMapBehindItRightWayRound) {
    PreviewOptions options;
    options.background = true;
    const View view = small_orbit(40, 10);
    const Image image = picture(one("mirror"), world_light(direction_as_color), view, options);
    for (const auto& [x, y] :
         {std::pair(2, 2), std::pair(93, 3), std::pair(4, 60), std::pair(90, 61)}) {
        const V3d wanted = direction_as_color(V3d(view.beam(x + 0.5, y + 0.5, 1).direction));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.pixel(x, y)[c], wanted[c], 3e-3);
    }
}

TEST(Preview, IsTheSameForAnyNumberOfThreads) {
    const Environment light = world_light(smooth_world, 32);
    for (const auto& [material, mesh] : {std::pair<const char*, const char*>{"mirror", "torus"},
                                         {"glossy", nullptr},
                                         {"glass", "knot"}}) {
        PreviewOptions options;
        options.noise = 0.003;
        options.most_rounds = 5;
        options.samples = 2;
        options.shading = Shading::raytrace;
        const Image many = picture(one(material, mesh), light, small_orbit(), options);
        const ThreadLimit limit(1);
        const Image single = picture(one(material, mesh), light, small_orbit(), options);
        EXPECT_EQ(largest_difference(many, single), 0) << material;
    }
}

TEST(Preview, TakesMoreSamplesWhereItIsNoisy) {
    const auto lamp = [](V3d d) { return d.y > 0.995 ? V3d(400, 400, 400) : V3d(0.5, 0.5, 0.5); };
    const Environment light = world_light(lamp);
    const Scene scene = one("glossy");
    PreviewOptions once, settled;
    once.samples = settled.samples = 4;
    settled.noise = 0.004;
    settled.most_rounds = 16;
    PreviewStatistics before, after;
    const Tracer tracer(scene);
    preview(scene, tracer, light, small_orbit(), once, &before);
    preview(scene, tracer, light, small_orbit(), settled, &after);
    EXPECT_EQ(before.camera_rays, 96u * 64 * 4);
    EXPECT_GT(after.camera_rays, before.camera_rays * 4) << "four rounds are the least";
    EXPECT_LT(after.camera_rays, before.camera_rays * 16) << "but not all where nothing is seen";
}

TEST(Preview, StopsWhenAskedTo) {
    const std::atomic<bool> stop = true;
    const Scene scene = one("mirror");
    const Environment light = white_light();
    EXPECT_THROW(preview(scene, Tracer(scene), light, small_orbit(), {}, nullptr, {.stop = &stop}),
                 Error);
}

}  // namespace
}  // namespace chromeball
