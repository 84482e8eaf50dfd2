#include "light/grey_ball.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "support/balls.h"
#include "support/directions.h"

namespace chromeball {
namespace {

using std::numbers::pi;
using Rgb = std::array<double, 3>;
using Sky = std::function<Rgb(V3d)>;

constexpr Size kSize{400, 200};
const Outline kMirror{100, 100, 80, 80, 0}, kGrey{300, 100, 80, 80, 0};

const V3d kSun = V3d(0.5, 0.7, 0.5).normalized();

/// A sky with a sun of 6 degrees' radius.
Rgb sunny(V3d d) {
    if (d.dot(kSun) > std::cos(6 * pi / 180)) return {120, 100, 70};
    return {0.4 + 0.3 * d.y, 0.5 + 0.3 * d.y, 0.6 + 0.2 * d.y};
}

/// Both balls under a sky, seen from far away. The grey one is lit by 24000 directions.
struct Scene {
    Image photo{kSize, 3};
    std::vector<char> clipped, usable;
    MirrorBall mirror{kMirror}, grey{kGrey};

    /// beside: the mirror ball hides a part of the sky from the grey one; what it throws there does
    /// not arrive (something stands in between).
    Scene(const Sky& sky, Rgb albedo, float clip, bool beside = false) {
        std::vector<V3d> directions;
        std::vector<Rgb> light;
        constexpr int kCount = 24000;
        for (int i = 0; i < kCount; ++i) {  // a spiral of equal areas
            const double z = 1 - 2 * (i + 0.5) / kCount, around = i * pi * (3 - std::sqrt(5.0));
            const double s = std::sqrt(1 - z * z);
            directions.emplace_back(s * std::cos(around), s * std::sin(around), z);
            light.push_back(sky(directions.back()));
        }
        for (int y = 0; y < kSize.height; ++y)
            for (int x = 0; x < kSize.width; ++x) {
                const V2d at(x + 0.5, y + 0.5);
                float* p = photo.pixel(x, y);
                bool clips = false;
                if (const auto d = mirror.to_direction(at)) {
                    const Rgb seen = sky(V3d(*d).normalized());
                    for (std::size_t c = 0; c < 3; ++c) {
                        clips = clips || seen[c] >= static_cast<double>(clip);
                        p[c] = std::min(clip, static_cast<float>(seen[c]));
                    }
                } else if (const auto r = grey.to_direction(at); r && (x + y) % 4 == 0) {
                    shade(V3d(*r).normalized(), albedo, directions, light, beside, p);
                }
                clipped.push_back(clips);
                usable.push_back((x + y) % 4 == 0);  // a quarter of them, to save time
            }
    }
    static void shade(V3d r, Rgb albedo, const std::vector<V3d>& directions,
                      const std::vector<Rgb>& light, bool beside, float* p) {
        const V3d n = (r + V3d(0, 0, 1)).normalized();
        const V3d to = V3d((kMirror.cx - kGrey.cx) / kGrey.a, 0, 0) - n;  // balls of one size
        const V3d axis = to.normalized();
        const double hidden = std::sqrt(1 - 1 / to.dot(to));
        Rgb sum{};
        for (std::size_t i = 0; i < directions.size(); ++i)
            if (const double cosine = n.dot(directions[i]);
                cosine > 0 && !(beside && directions[i].dot(axis) > hidden))
                for (std::size_t c = 0; c < 3; ++c) sum[c] += cosine * light[i][c];
        const double each = 4 * pi / static_cast<double>(directions.size());
        for (std::size_t c = 0; c < 3; ++c)
            p[c] = static_cast<float>(albedo[c] / pi * sum[c] * each);
    }
    BallPicture mirror_picture() const { return {&photo, mirror, {}}; }
    BallPicture grey_picture() const { return {&photo, grey, {}}; }
};

TEST(IrradianceFrom, AnEvenSkyIsPiTimesItsRadiance) {
    const Scene scene([](V3d) { return Rgb{1, 2, 3}; }, {0.18, 0.18, 0.18}, 10);
    for (const V3d& n : {V3d(0, 0, 1), V3d(0, 1, 0), V3d(1, 0, 0), V3d(0, 0, -1)}) {
        const Rgb light = irradiance_from(scene.mirror_picture(), n);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(light[c] / (pi * double(c + 1)), 1, 0.01);
    }
}

TEST(GreyBall, TellsTheLightOfAClippedSun) {
    const Scene scene(sunny, {0.18, 0.2, 0.22}, 2);
    GreyBallOptions options;
    options.reflectance = {0.18, 0.2, 0.22};
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable, options);
    ASSERT_EQ(fit.regions.size(), 1U);
    EXPECT_GT(fit.regions[0].direction.dot(kSun), std::cos(1 * pi / 180));
    const double steradians = 2 * pi * (1 - std::cos(6 * pi / 180));
    EXPECT_NEAR(fit.regions[0].steradians / steradians, 1, 0.05);
    const Rgb sun = sunny(kSun);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(fit.irradiance[c] / ((sun[c] - 2) * steradians), 1, 0.05) << c;
    EXPECT_LT(fit.residual, 0.03);
    EXPECT_GT(fit.residual_before, 0.3);

    // In its pixels it lights a surface that faces it as the whole sky does.
    Image filled = scene.photo;
    add_missing_light(filled, fit);
    const Scene whole(sunny, {0.18, 0.18, 0.18}, 1e6f);
    const BallPicture picture{&filled, scene.mirror, {}};
    for (const V3d& n : {kSun, V3d(0, 0, 1), V3d(0, 1, 0)}) {
        const Rgb light = irradiance_from(picture, n);
        const Rgb truth = irradiance_from(whole.mirror_picture(), n);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(light[c] / truth[c], 1, 0.05) << c;
    }
}

TEST(GreyBall, AddsNothingWhereNothingIsMissing) {
    const Scene scene([](V3d d) { return Rgb{2 + d.y, 2 + d.y, 2 + d.y}; }, {0.18, 0.18, 0.18}, 10);
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable);
    EXPECT_TRUE(fit.regions.empty());
    EXPECT_LT(fit.residual, 0.02);
}

TEST(GreyBall, ShadowsOnItHardlyCount) {
    Scene scene(sunny, {0.18, 0.18, 0.18}, 2);
    for (int y = 110; y < 150; ++y)  // a tenth of it is in something's shadow
        for (int x = 270; x < 310; ++x)
            for (int c = 0; c < 3; ++c) scene.photo.pixel(x, y)[c] *= 0.3f;
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable);
    const double steradians = 2 * pi * (1 - std::cos(6 * pi / 180));
    EXPECT_NEAR(fit.irradiance[1] / (98 * steradians), 1, 0.1);
}

/// Its whole irradiance over that of the truth, for surfaces of all directions: the mean of
/// |ratio - 1|.
double irradiance_error(const Scene& scene, const GreyBallFit& fit, const Sky& sky) {
    Image filled = scene.photo;
    add_missing_light(filled, fit);
    const Scene whole(sky, {0.18, 0.18, 0.18}, 1e6f);
    const BallPicture picture{&filled, scene.mirror, {}};
    double sum = 0;
    int count = 0;
    for (const V3d& n : directions_on_sphere(60)) {
        const Rgb light = irradiance_from(picture, n);
        const Rgb truth = irradiance_from(whole.mirror_picture(), n);
        for (std::size_t c = 0; c < 3; ++c, ++count) sum += std::abs(light[c] / truth[c] - 1);
    }
    return sum / count;
}

TEST(GreyBall, WhatTheMirrorBallHidesFromItDoesNotLookLikeMissingLight) {
    // A lamp on either side clips; only the right one has more than what is seen of it.
    const auto sky = [](double right) {
        return [right](V3d d) {
            if (d.dot(V3d(0.85, 0.3, 0.43).normalized()) > 0.99) return Rgb{right, right, right};
            if (d.dot(V3d(0.7, 0.3, -0.6).normalized()) > 0.99) return Rgb{2.1, 2.1, 2.1};
            if (d.dot(V3d(-0.7, 0.3, 0.6).normalized()) > 0.99) return Rgb{2.1, 2.1, 2.1};
            return Rgb{1 + 0.3 * d.y, 1 + 0.3 * d.y, 1 + 0.2 * d.y};
        };
    };
    const Scene scene(sky(8), {0.18, 0.18, 0.18}, 2, true);
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable);
    ASSERT_EQ(fit.regions.size(), 3U);
    EXPECT_LT(irradiance_error(scene, fit, sky(8)), 0.01);
}

TEST(GreyBall, RegionsBehindItDoNotMendWhatIsPaint) {
    // What clips behind it lights but its rim: any flaw of the paint would ask for much there.
    const Sky sky = [](V3d d) {
        if (d.dot(V3d(-0.3, 0.5, -0.81).normalized()) > 0.995) return Rgb{2.2, 2.2, 2.2};
        if (d.dot(V3d(0.5, -0.3, -0.81).normalized()) > 0.995) return Rgb{2.2, 2.2, 2.2};
        return sunny(d);
    };
    Scene scene(sky, {0.18, 0.18, 0.18}, 2);
    for (int y = 20; y < 180; ++y)
        for (int x = 220; x < 380; ++x)
            for (int c = 0; c < 3; ++c)
                scene.photo.pixel(x, y)[c] *=
                    1 + 0.03f * std::sin(0.05f * static_cast<float>(x + 2 * y));
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable);
    ASSERT_EQ(fit.regions.size(), 3U);
    EXPECT_LT(irradiance_error(scene, fit, sky), 0.03);
}

TEST(GreyBall, ItsReflectanceIsFoundWhereTheLightIsKnown) {
    const Scene scene(sunny, {0.3, 0.25, 0.2}, 1e6f);
    GreyBallOptions options;
    options.solve_reflectance = true;
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable, options);
    // A ball 160 pixels across shows the sun's disc to some per cent of its area.
    const Rgb truth{0.3, 0.25, 0.2};
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(fit.reflectance[c] / truth[c], 1, 0.05) << c;
}

}  // namespace
}  // namespace chromeball
