#include "light/grey_ball.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "light/view.h"
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

/// Both balls of one size under a sky, seen from far away, each hiding a part of it from the other.
/// The grey one is lit by 24000 directions.
struct Scene {
    Image photo{kSize, 3};
    std::vector<char> clipped, usable;
    MirrorBall mirror{kMirror}, grey{kGrey};

    /// thrown: the part of the mirrored light that arrives at the grey ball, 0 where something
    /// stands in between
    Scene(Sky sky_, Rgb albedo_, float clip, double thrown_ = 0)
        : sky(std::move(sky_)), albedo(albedo_), thrown(thrown_) {
        directions = fibonacci_directions(24000);
        for (const V3d& d : directions) light.push_back(sky(d));
        for (const V3d& n : normals) shades.push_back(shade(n));
        for (int y = 0; y < kSize.height; ++y)
            for (int x = 0; x < kSize.width; ++x) {
                const V2d at(x + 0.5, y + 0.5);
                float* p = photo.pixel(x, y);
                bool clips = false;
                if (const auto d = mirror.to_direction(at)) {
                    const Rgb seen = mirrored(V3d(*d).normalized());
                    for (std::size_t c = 0; c < 3; ++c) {
                        clips = clips || seen[c] >= static_cast<double>(clip);
                        p[c] = std::min(clip, static_cast<float>(seen[c]));
                    }
                } else if (const auto r = grey.to_direction(at); r && (x + y) % 4 == 0) {
                    const Rgb seen = shade((V3d(*r) + V3d(0, 0, 1)).normalized());
                    for (std::size_t c = 0; c < 3; ++c) p[c] = static_cast<float>(seen[c]);
                }
                clipped.push_back(clips);
                usable.push_back((x + y) % 4 == 0);  // a quarter of them, to save time
            }
    }
    /// Where, seen from a place on one unit ball, a ray meets the other one.
    static std::optional<V3d> met(V3d place, V3d d, V3d other) {
        const double along = (other - place).dot(d), away = (other - place).dot(other - place);
        if (along <= 0 || away - along * along >= 1) return std::nullopt;
        return place + d * (along - std::sqrt(1 - away + along * along));
    }
    /// What the grey ball shows with that normal.
    Rgb shade(V3d n) const {
        const V3d other((kMirror.cx - kGrey.cx) / kGrey.a, 0, 0);
        Rgb sum{};
        for (std::size_t i = 0; i < directions.size(); ++i) {
            const double cosine = n.dot(directions[i]);
            if (cosine <= 0) continue;
            Rgb from = light[i];
            if (const auto place = met(n, directions[i], other)) {
                const V3d m = *place - other;
                from = sky(directions[i] - m * (2 * directions[i].dot(m)));
                for (double& v : from) v *= thrown;
            }
            for (std::size_t c = 0; c < 3; ++c) sum[c] += cosine * from[c];
        }
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] *= albedo[c] * 4 / static_cast<double>(directions.size());
        return sum;
    }
    /// What the mirror ball shows in a direction: the sky, or the grey ball.
    Rgb mirrored(V3d d) const {
        const V3d other((kGrey.cx - kMirror.cx) / kMirror.a, 0, 0);
        const auto place = met((d + V3d(0, 0, 1)).normalized(), d, other);
        if (!place) return sky(d);
        const V3d n = *place - other;
        const auto nearest = std::ranges::max_element(normals, {}, [&](V3d m) { return m.dot(n); });
        return shades[static_cast<std::size_t>(nearest - normals.begin())];
    }
    BallPicture mirror_picture() const { return {&photo, mirror, {}}; }
    BallPicture grey_picture() const { return {&photo, grey, {}}; }

    Sky sky;
    Rgb albedo;
    double thrown;
    std::vector<V3d> directions, normals = fibonacci_directions(150);
    std::vector<Rgb> light, shades;
};

TEST(IrradianceFrom, AnEvenSkyIsPiTimesItsRadiance) {
    const Scene scene([](V3d) { return Rgb{1, 2, 3}; }, {1, 1, 1}, 10, 1);  // not to be seen in it
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
    const Scene scene(sky(8), {0.18, 0.18, 0.18}, 2);
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable);
    ASSERT_EQ(fit.regions.size(), 3U);
    EXPECT_LT(irradiance_error(scene, fit, sky(8)), 0.01);
}

TEST(GreyBall, WhatTheMirrorBallThrowsOnItIsNoMissingLight) {
    const Scene scene(sunny, {0.18, 0.18, 0.18}, 2, 1);
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable);
    EXPECT_LT(irradiance_error(scene, fit, sunny), 0.02);
}

TEST(GreyBall, ASunThatItHalfHidesFromTheMirrorBallIsFoundWhole) {
    // At the upper rim of the grey ball as the mirror ball shows it, which hides half of it.
    const V3d other((kGrey.cx - kMirror.cx) / kMirror.a, 0, 0);
    const V3d middle = V3d(0.93, 0, -0.36).normalized();
    V3d rim = middle;
    for (double up = 0; up < 1; up += 0.01) {
        const V3d d = middle * std::cos(up) + V3d(0, std::sin(up), 0);
        if (Scene::met((d + V3d(0, 0, 1)).normalized(), d, other)) rim = d;
    }
    const Sky sky = [&](V3d d) -> Rgb {
        if (d.dot(rim) > std::cos(6 * pi / 180)) return {90, 90, 90};
        return {1 + 0.3 * d.y, 1 + 0.3 * d.y, 1 + 0.3 * d.y};
    };
    const Scene scene(sky, {0.18, 0.18, 0.18}, 2);
    const GreyBallFit fit = solve_missing_light(scene.mirror_picture(), scene.clipped,
                                                scene.grey_picture(), scene.usable);
    ASSERT_EQ(fit.regions.size(), 1U);
    const double steradians = 2 * pi * (1 - std::cos(6 * pi / 180));
    EXPECT_LT(fit.regions[0].steradians, 0.75 * steradians);
    EXPECT_NEAR(fit.irradiance[1] / (88 * steradians), 1, 0.08);
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
