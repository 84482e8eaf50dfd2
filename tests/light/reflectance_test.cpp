#include "light/reflectance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/balls.h"

namespace chromeball {
namespace {

TEST(Fresnel, AgreesWithKnownValues) {
    // Glass: ((n - 1) / (n + 1))^2 straight on.
    EXPECT_NEAR(fresnel(1, 1.5, 0), 0.04, 1e-12);
    // ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2).
    EXPECT_NEAR(fresnel(1, 3.18, 3.33), (2.18 * 2.18 + 3.33 * 3.33) / (4.18 * 4.18 + 3.33 * 3.33),
                1e-12);
    EXPECT_NEAR(fresnel(0, 3.18, 3.33), 1, 1e-12);
    EXPECT_NEAR(fresnel(0, 1.5, 0), 1, 1e-12);
    // At Brewster's angle only light polarised across comes back: half of ((n^2 - 1)/(n^2 + 1))^2.
    const double brewster = std::cos(std::atan(1.5));
    EXPECT_NEAR(fresnel(brewster, 1.5, 0), std::pow(1.25 / 3.25, 2) / 2, 1e-12);
}

TEST(Fresnel, OfDielectricsFollowsSnell) {
    for (double i = 0.1; i < 1.5; i += 0.2) {
        const double t = std::asin(std::sin(i) / 1.33);
        const double across = std::pow(std::sin(i - t) / std::sin(i + t), 2);
        const double along = std::pow(std::tan(i - t) / std::tan(i + t), 2);
        EXPECT_NEAR(fresnel(std::cos(i), 1.33, 0), (across + along) / 2, 1e-12) << i;
    }
}

TEST(BallMaterials, GiveBackWhatSuchMirrorsDo) {
    const auto green = [](const char* name) {
        return Reflectance{{1, 1, 1}, find_ball_material(name)->constants}.at(1)[1];
    };
    EXPECT_NEAR(green("chromium"), 0.55, 0.03);
    EXPECT_NEAR(green("silver"), 0.98, 0.01);
    EXPECT_NEAR(green("aluminium"), 0.915, 0.01);
    EXPECT_EQ(find_ball_material("butter"), nullptr);
    for (const BallMaterial& material : ball_materials())
        for (double cosine = 0; cosine <= 1; cosine += 0.125)
            for (const double r : Reflectance{{1, 1, 1}, material.constants}.at(cosine)) {
                EXPECT_GT(r, 0.3) << material.name;
                EXPECT_LE(r, 1) << material.name;
            }
}

TEST(UndoReflectance, DividesByWhatComesBackAtEachPixelsAngle) {
    const Reflectance chrome{{0.9, 0.8, 0.7}, find_ball_material("chromium")->constants};
    for (const NamedBall& named : balls_in_photos()) {
        if (named.ball.outline().a < 100) continue;
        Image pixels({640, 480}, 3);
        for (int y = 0; y < 480; ++y) std::fill_n(pixels.row(y), 640 * 3, 1.0f);
        undo_reflectance(pixels, named.ball, {}, chrome);
        const Outline& e = named.ball.outline();
        const int x = static_cast<int>(e.cx + 0.5 * e.b), y = static_cast<int>(e.cy);
        if (x < 0 || x >= 640 || y < 0 || y >= 480) continue;
        const V2d at(x + 0.5, y + 0.5);
        const V3d q = named.ball.ray(at);
        const V3d d = V3d(*named.ball.to_direction(at)).normalized();
        // By the normal, not by half the angle.
        const double cosine = -(d - q).normalized().dot(q);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(static_cast<double>(pixels.pixel(x, y)[c]) * chrome.at(cosine)[c], 1, 1e-5)
                << named.name;
    }
}

}  // namespace
}  // namespace chromeball
