#include "map/camera.h"

#include <gtest/gtest.h>

#include "support/balls.h"

namespace chromeball {
namespace {

const V2d kPrincipal(960.5, 539.25);

V3d ray(const Camera& camera, V2d p) {
    return V3d((p.x - camera.principal.x) / *camera.focal,
               (camera.principal.y - p.y) / *camera.focal, -1)
        .normalized();
}

/// Random cones: near and far, on the axis and up to 40 degrees off it.
std::vector<Cone> random_cones(int count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> part(0, 1);
    std::vector<Cone> cones;
    for (int i = 0; i < count; ++i) {
        const double distance = 1.6 * std::pow(10, 5.8 * part(random));  // to 1e6
        const double off = i % 10 == 0 ? 0 : 40 * part(random);
        cones.push_back(cone_at(distance, off, 360 * part(random)));
    }
    return cones;
}

TEST(Camera, IsOrthographicWithoutAFocalLength) {
    EXPECT_TRUE(Camera{}.orthographic());
    EXPECT_FALSE(pinhole(1000, {0, 0}).orthographic());
}

TEST(Focal, FromSensorAndFromFieldOfView) {
    EXPECT_DOUBLE_EQ(focal_from_sensor(50, 36, 3600), 5000);
    EXPECT_NEAR(focal_from_hfov(90, 2000), 1000, 1e-9);
    EXPECT_NEAR(focal_from_hfov(degrees(2 * std::atan(18.0 / 50)), 3600), 5000, 1e-9);
}

TEST(RimPoint, RunsAroundTheEllipse) {
    const Outline outline{10, 20, 5, 3, 30};
    EXPECT_LT((rim_point(outline, 0) - V2d(10 + 5 * std::cos(radians(30)), 22.5)).length(), 1e-14);
    EXPECT_LT((rim_point(outline, std::numbers::pi / 2) - V2d(8.5, 20 + 3 * std::cos(radians(30))))
                  .length(),
              1e-14);
}

TEST(OutlineOf, IsTheContractsEllipse) {
    const Camera camera = pinhole(2000.0, kPrincipal);
    const double psi = radians(25), rho = std::asin(1 / 8.0);
    const double den = std::cos(psi) * std::cos(psi) - std::sin(rho) * std::sin(rho);
    for (const double around : {0.0, 30.0, 120.0, 200.0, 300.0}) {
        const Outline o = outline_of(cone_at(8, 25, around), camera).value();
        EXPECT_NEAR(o.a, 2000 * std::sin(rho) * std::cos(rho) / den, 1e-9);
        EXPECT_NEAR(o.b, 2000 * std::sin(rho) / std::sqrt(den), 1e-9);
        const double offset = 2000 * std::sin(psi) * std::cos(psi) / den;
        EXPECT_NEAR(o.cx, kPrincipal.x + offset * std::cos(radians(around)), 1e-9);
        EXPECT_NEAR(o.cy, kPrincipal.y - offset * std::sin(radians(around)), 1e-9);  // y down
        EXPECT_GT(offset, 2000 * std::tan(psi) + 1);  // not where the ball's centre is seen
        // The long axis points away from the middle; from +x towards +y (down), in [0, 180).
        EXPECT_NEAR(o.angle, std::fmod(720 - around, 180), 1e-9);
        EXPECT_TRUE(o.angle >= 0 && o.angle < 180);
    }
}

TEST(OutlineOf, TouchesTheBallWithEveryRay) {
    const Camera camera = pinhole(1500.0, kPrincipal);
    for (const Cone& cone : random_cones(100)) {
        const auto outline = outline_of(cone, camera);
        ASSERT_TRUE(outline);
        EXPECT_GE(outline->a, outline->b);
        for (int i = 0; i < 12; ++i) {
            const double angle =
                angle_between(ray(camera, rim_point(*outline, i * 0.55)), cone.axis);
            // 1e-15 of a direction far off the axis, over the cone's half-angle
            EXPECT_NEAR(angle / cone.half_angle, 1, 1e-14 / cone.half_angle + 1e-12);
        }
    }
}

TEST(OutlineOf, IsACircleOnTheAxis) {
    const Outline o = outline_of(cone_at(5), camera_for(5, 100, kPrincipal)).value();
    EXPECT_NEAR(o.cx, kPrincipal.x, 1e-12);
    EXPECT_NEAR(o.cy, kPrincipal.y, 1e-12);
    EXPECT_NEAR(o.a, 100, 1e-9);
    EXPECT_NEAR(o.b, 100, 1e-9);
    EXPECT_EQ(o.angle, 0);
}

TEST(OutlineOf, IsNothingWhereTheBallReachesTheCamerasPlane) {
    const Camera camera = pinhole(1000.0, kPrincipal);
    EXPECT_EQ(outline_of(cone_at(1.5, 60), camera), std::nullopt);
    EXPECT_EQ(outline_of(cone_at(10, 100), camera), std::nullopt);
    EXPECT_EQ(outline_of({V3d(0, 0, 1), 0.1}, camera), std::nullopt);  // behind
    EXPECT_EQ(outline_of(cone_at(10), Camera{}), std::nullopt);        // orthographic
}

TEST(ConeOf, FindsTheConeOfItsOutline) {
    for (const double focal : {600.0, 3000.0}) {
        const Camera camera = pinhole(focal, kPrincipal);
        for (const Cone& cone : random_cones(300)) {
            const Cone found = cone_of(outline_of(cone, camera).value(), camera);
            // The outline's numbers, of some 1000 pixels, hold 1e-13 pixels; relative to its
            // radius of focal x half_angle.
            const double loss = 1e-13 / (focal * cone.half_angle) * 100 + 1e-11;
            EXPECT_NEAR(found.half_angle / cone.half_angle, 1, loss) << cone.distance();
            EXPECT_LT(angle_between(found.axis, cone.axis) / cone.half_angle, loss)
                << cone.distance();
        }
    }
}

TEST(ConeOf, TurnsACircleOffTheAxisIntoTheNearestEllipse) {
    const Camera camera = pinhole(1500.0, kPrincipal);
    const Outline circle{1700, 800, 120, 120, 0};
    const Outline fitted = outline_of(cone_of(circle, camera), camera).value();
    EXPECT_NEAR(std::sqrt(fitted.a * fitted.b), 120, 0.5);
    EXPECT_GT(fitted.a, fitted.b + 5);
    // Halfway: no point of the rim is farther off than the half difference of the axes, and the
    // centre stays.
    EXPECT_LT(rim_deviation(circle, fitted), 0.5 * (fitted.a - fitted.b) + 0.5);
    EXPECT_LT(std::hypot(fitted.cx - 1700, fitted.cy - 800), 0.5);
}

TEST(ConeOf, IsTheLeastSquaresFitInPixels) {
    // Any cone a little aside leaves more; sums over the rim of squared distances in pixels.
    const Camera camera = pinhole(1500.0, kPrincipal);
    const Outline circle{1700, 800, 120, 120, 0};
    const auto loss = [&](const Cone& cone) {
        const Outline o = outline_of(cone, camera).value();
        const double c = std::cos(radians(o.angle)), s = std::sin(radians(o.angle));
        double sum = 0;
        for (int i = 0; i < 72; ++i) {
            const V2d p = rim_point(circle, i * std::numbers::pi / 36) - V2d(o.cx, o.cy);
            const double u = (p.x * c + p.y * s) / o.a, v = (p.y * c - p.x * s) / o.b;
            const double off = (u * u + v * v - 1) / (2 * std::hypot(u / o.a, v / o.b));
            sum += off * off;
        }
        return sum;
    };
    const Cone best = cone_of(circle, camera);
    for (const V3d& aside : {V3d(1, 0, 0), V3d(-1, 0, 0), V3d(0, 1, 0), V3d(0, -1, 0)}) {
        // 5e-4: most of a pixel; the weights are those of the round before, so the optimum is
        // hit to a part of that only.
        EXPECT_GT(loss({(best.axis + aside * 5e-4).normalized(), best.half_angle}), loss(best));
    }
    EXPECT_GT(loss({best.axis, best.half_angle * 1.005}), loss(best));
    EXPECT_GT(loss({best.axis, best.half_angle * 0.995}), loss(best));
}

TEST(Cone, KnowsItsDistanceAndWhatItHides) {
    EXPECT_NEAR(cone_at(7).distance(), 7, 1e-12);
    EXPECT_DOUBLE_EQ(cone_at(7).hidden_half_angle(), std::asin(1 / 7.0));
}

TEST(FocalFromDistance, IsTheFocalLengthThatGivesTheDistance) {
    for (const double distance : {1.5, 3.0, 10.0, 300.0})
        for (const double off : {0.0, 10.0, 30.0, 40.0}) {
            const Camera camera = pinhole(1400.0, kPrincipal);
            const auto outline = outline_of(cone_at(distance, off, 33), camera);
            ASSERT_TRUE(outline);
            const auto focal = focal_from_distance(*outline, kPrincipal, distance);
            EXPECT_TRUE(focal) << distance << " " << off;
            if (!focal) continue;
            // 1e-7: the distant ball's cone holds 1e-11 of its angle
            EXPECT_NEAR(*focal / 1400, 1, 1e-7) << distance << " " << off;
        }
}

TEST(FocalFromDistance, IsNothingInsideTheBall) {
    EXPECT_EQ(focal_from_distance({500, 500, 100, 100, 0}, {500, 500}, 1), std::nullopt);
    EXPECT_EQ(focal_from_distance({500, 500, 100, 100, 0}, {500, 500}, 0.5), std::nullopt);
    EXPECT_EQ(focal_from_distance({500, 500, 100, 100, 0}, {500, 500}, std::nan("")), std::nullopt);
}

TEST(FocalFromDistance, IsNothingWhereNoFocalLengthGivesIt) {
    // Far from the middle and tiny: even a wide lens sees it at a small angle.
    EXPECT_EQ(focal_from_distance({50000, 500, 100, 100, 0}, {500, 500}, 1.0001), std::nullopt);
}

TEST(Camera, AnEllipseOffTheAxisTellsTheFocalLength) {
    for (const double focal : {400.0, 1500.0, 9000.0})
        for (const double distance : {1.6, 4.0, 40.0})
            for (const double angle : {0.05, 0.3, 0.5}) {
                const Cone cone{V3d(std::sin(angle), 0, -std::cos(angle)), std::asin(1 / distance)};
                const auto outline = outline_of(cone, Camera{focal, kPrincipal, {}});
                if (!outline) continue;
                const auto found = focal_from_ellipse(outline->a, outline->b,
                                                      std::abs(outline->cx - kPrincipal.x));
                ASSERT_TRUE(found);
                EXPECT_NEAR(*found / focal, 1, 1e-9);
            }
}

TEST(Camera, NoFocalLengthMakesACircleOrTheWrongAxisLong) {
    EXPECT_EQ(focal_from_ellipse(100, 100, 300), std::nullopt);
    EXPECT_EQ(focal_from_ellipse(99, 100, 300), std::nullopt);
    EXPECT_EQ(focal_from_ellipse(101, 100, 0), std::nullopt);
    EXPECT_EQ(focal_from_ellipse(200, 100, 50), std::nullopt);
    EXPECT_EQ(focal_from_ellipse(std::nan(""), 100, 50), std::nullopt);
}

TEST(RimDeviation, IsHowFarRimsLieApart) {
    const Outline one{100, 100, 50, 50, 0};
    EXPECT_NEAR(rim_deviation(one, one), 0, 1e-12);
    // First order: right to the square of the deviation over the radius.
    EXPECT_NEAR(rim_deviation(one, {100.5, 100, 50, 50, 0}), 0.5, 0.01);
    EXPECT_NEAR(rim_deviation(one, {100, 99, 50, 50, 0}), 1, 0.03);
    EXPECT_NEAR(rim_deviation(one, {100, 100, 50.5, 50.5, 0}), 0.5, 0.01);
    EXPECT_NEAR(rim_deviation({100, 100, 50, 45, 90}, {100, 100, 50, 45, 0}), 5, 0.5);
    EXPECT_NEAR(rim_deviation({100, 100, 50, 45, 30}, {100, 100, 50, 45, 30}), 0, 1e-12);
}

}  // namespace
}  // namespace chromeball
