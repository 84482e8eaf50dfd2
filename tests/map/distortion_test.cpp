#include "map/distortion.h"

#include <gtest/gtest.h>

#include <numbers>

#include "map/camera.h"
#include "map/mirror_ball.h"

namespace chromeball {
namespace {

// A wide lens' barrel, with terms of every order; and a tele's pincushion.
const Distortion kBarrel{-0.25, 0.08, -0.01};
const Distortion kPincushion{0.12, 0.03, 0};

TEST(Distortion, FollowsTheFormulaOfOpenCv) {
    const V2d seen = kBarrel.distorted(V2d(0.3, 0.4));
    const double factor = 1 - 0.25 * 0.25 + 0.08 * 0.25 * 0.25 - 0.01 * 0.25 * 0.25 * 0.25;
    EXPECT_NEAR(seen.x, 0.3 * factor, 1e-15);
    EXPECT_NEAR(seen.y, 0.4 * factor, 1e-15);
}

TEST(Distortion, IsUndoneExactly) {
    for (const Distortion& lens : {kBarrel, kPincushion, Distortion{}})
        for (double r = 0; r < 0.8; r += 0.01) {
            const V2d p(r * std::cos(7 * r), r * std::sin(7 * r));
            EXPECT_LT((lens.undistorted(lens.distorted(p)) - p).length(), 1e-13) << r;
        }
}

TEST(Distortion, BeyondTheFoldStaysFinite) {
    // 1 - r^2 folds over at r = 0.577, where 0.385 is seen: nothing can be seen beyond.
    const Distortion folding{-1, 0, 0};
    const V2d p = folding.undistorted(V2d(0.5, 0));
    EXPECT_TRUE(std::isfinite(p.x));
    EXPECT_LT(p.x, 0.6);
}

TEST(Distortion, DerivativesAreThoseOfTheInverse) {
    const V2d seen(0.31, -0.22);
    const auto p = kBarrel.undistorted(with_derivatives(seen));
    constexpr double h = 1e-6;
    const V2d by_x =
        (kBarrel.undistorted(seen + V2d(h, 0)) - kBarrel.undistorted(seen - V2d(h, 0))) / (2 * h);
    EXPECT_NEAR(p.x.du, by_x.x, 1e-8);
    EXPECT_NEAR(p.y.du, by_x.y, 1e-8);
}

TEST(DistortingCamera, ConeAndOutlineStayTwoSidesOfOneThing) {
    for (const Distortion& lens : {kBarrel, kPincushion}) {
        const Camera camera{1500.0, V2d(960, 540), lens};
        const Cone cone{V3d(0.3, 0.15, -1).normalized(), std::asin(1 / 7.0)};
        const Outline outline = outline_of(cone, camera).value();
        const Cone back = cone_of(outline, camera);
        // The rim is an ellipse only nearly; what that costs is far below what anyone measures.
        EXPECT_NEAR(back.distance(), 7, 1e-3);
        EXPECT_LT((back.axis - cone.axis).length(), 1e-5);
        // Without the lens' terms the same outline would be another ball.
        const Cone wrong = cone_of(outline, Camera{1500.0, V2d(960, 540)});
        EXPECT_GT((wrong.axis - cone.axis).length(), 1e-3);
    }
}

TEST(DistortingCamera, TheBallIsSeenWhereTheLensPutsIt) {
    const Camera straight{1500.0, V2d(960, 540)};
    Camera bent = straight;
    bent.distortion = kBarrel;
    const Cone cone{V3d(0.3, 0.15, -1).normalized(), std::asin(1 / 7.0)};
    const MirrorBall through_lens(bent, cone), pinhole(straight, cone);
    for (int i = 0; i < 500; ++i) {
        const double z = 1 - 1.9 * i / 500, a = 2.4 * i, s = std::sqrt(1 - z * z);
        const V3d d(s * std::cos(a), s * std::sin(a), z);
        const auto ideal = pinhole.to_position(d), seen = through_lens.to_position(d);
        ASSERT_EQ(ideal.has_value(), seen.has_value());
        if (!ideal) continue;
        const V2d expected =
            kBarrel.distorted((*ideal - V2d(960, 540)) / 1500.0) * 1500.0 + V2d(960, 540);
        EXPECT_LT((*seen - expected).length(), 1e-9);
        EXPECT_LT((*through_lens.to_direction(*seen) - d).length(), 1e-6);
    }
}

}  // namespace
}  // namespace chromeball
