#include "map/mirror_ball.h"

#include <gtest/gtest.h>

#include "support/balls.h"

namespace chromeball {
namespace {

using std::numbers::pi;

const V2d kPrincipal(320, 240);
const double kDistances[] = {1.05, 1.5, 4, 10, 100};

// The distant ball.

TEST(DistantBall, ShowsTheCameraInItsMiddle) {
    const MirrorBall ball(Outline{300, 200, 100, 100, 0});
    EXPECT_EQ(ball.to_direction(V2d(300, 200)), V3d(0, 0, 1));
    EXPECT_EQ(ball.to_position(V3d(0, 0, 1)), V2d(300, 200));
    EXPECT_EQ(ball.facing({0, 0, 1}), 1);
    EXPECT_TRUE(ball.orthographic());
    EXPECT_TRUE(std::isinf(ball.distance()));
    EXPECT_EQ(ball.hidden_half_angle(), 0);
}

TEST(DistantBall, MirrorsTheHorizonOfTheCameraWhereItsNormalLeansBy45Degrees) {
    const MirrorBall ball(Outline{300, 200, 100, 100, 0});
    const double r = 100 * std::sqrt(0.5);
    const std::pair<V2d, V3d> pairs[] = {{{300 + r, 200}, {1, 0, 0}},
                                         {{300 - r, 200}, {-1, 0, 0}},
                                         {{300, 200 - r}, {0, 1, 0}},  // up in the photo
                                         {{300, 200 + r}, {0, -1, 0}}};
    for (const auto& [position, direction] : pairs) {
        EXPECT_LT((ball.to_direction(position).value() - direction).length(), 1e-14);
        EXPECT_LT((ball.to_position(direction).value() - position).length(), 1e-12);
    }
}

TEST(DistantBall, FollowsTheSphereMapOfOpenGl) {
    // v = (0, 0, 1), n = (s, t, sqrt(1 - s^2 - t^2)), r = 2 (n.v) n - v
    const MirrorBall ball;
    for (double s = -0.9; s < 1; s += 0.15)
        for (double t = -0.9; t < 1; t += 0.15) {
            if (s * s + t * t > 1) continue;
            const V3d n(s, t, std::sqrt(1 - s * s - t * t)), v(0, 0, 1);
            const V3d r = n * (2 * n.dot(v)) - v;
            const V2d p(s / 2 + 0.5, 0.5 - t / 2);
            EXPECT_LT((ball.to_direction(p).value() - r).length(), 1e-14);
            const double m = std::sqrt(r.x * r.x + r.y * r.y + (r.z + 1) * (r.z + 1));
            const V2d back = ball.to_position(r).value();
            EXPECT_NEAR(back.x, r.x / m / 2 + 0.5, 1e-12);
            EXPECT_NEAR(back.y, 0.5 - r.y / m / 2, 1e-12);
        }
}

TEST(DistantBall, ShowsFourSteradiansPerUnitOfDiskEverywhere) {
    const MirrorBall ball(Outline{300, 200, 100, 80, 20});
    for (const V2d& p : {V2d(300, 200), V2d(340, 230), V2d(390, 220)}) {
        EXPECT_DOUBLE_EQ(ball.solid_angle(p), 4.0 / (100 * 80));
        EXPECT_NEAR(solid_angle_from_jacobian(ball, p), 4.0 / (100 * 80), 1e-15);
    }
    EXPECT_EQ(ball.solid_angle({300, 290}), 0);
}

TEST(DistantBall, TakesAnEllipseAsAStretchedCircleWithoutTurningIt) {
    const Outline outline{300, 200, 100, 80, 30};
    const MirrorBall ball(outline);
    for (int i = 0; i < 12; ++i) {
        const double t = i * pi / 6;
        const V2d centre(outline.cx, outline.cy);
        const auto at = [&](double part) {
            return ball.to_direction(centre + (rim_point(outline, t) - centre) * part).value();
        };
        EXPECT_LT(angle_between(at(1 - 1e-15), {0, 0, -1}), 1e-6);  // a rim is all -Z
        EXPECT_NEAR(angle_between(at(std::sqrt(0.5)), {0, 0, 1}), pi / 2, 1e-12);
        // along the ellipse's axes, which are stretched, directions are those in the photo
        if (i % 3 == 0) {
            const V2d out = rim_point(outline, t) - centre;
            EXPECT_NEAR(std::remainder(std::atan2(at(0.5).y, at(0.5).x) - std::atan2(-out.y, out.x),
                                       2 * pi),
                        0, 1e-12);
        }
    }
}

TEST(DistantBall, KeepsItsDigitsAtTheBackPole) {
    const double radius = 1000;
    const MirrorBall ball(Outline{0, 0, radius, radius, 0});
    for (double e = 1e-150; e < 0.5; e *= 7)
        for (const double around : {0.1, 2.0, 4.5}) {
            const V3d d(std::sin(e) * std::cos(around), std::sin(e) * std::sin(around),
                        -std::cos(e));
            const long double X = d.x, Y = d.y, Z = d.z;
            const long double across = X * X + Y * Y, L = std::sqrt(across + Z * Z);
            const long double scale = radius / std::sqrt(2 * L * (across / (L - Z)));
            const V2d p = ball.to_position(d).value();
            EXPECT_NEAR(p.x, static_cast<double>(X * scale), 2e-4) << e;
            EXPECT_NEAR(p.y, static_cast<double>(-Y * scale), 2e-4) << e;
            EXPECT_NEAR(p.length(), radius * std::cos(e / 2), 2e-4) << e;
        }
}

TEST(DistantBall, ShowsStraightBehindNowhereAndAllAroundTheRim) {
    EXPECT_EQ(MirrorBall().to_position(V3d(0, 0, -1)), std::nullopt);
    EXPECT_EQ(MirrorBall().to_direction(V2d(1, 1)), std::nullopt);
    EXPECT_FALSE(MirrorBall().curved(off_axis(radians(35), 1)));
    EXPECT_TRUE(MirrorBall().curved(off_axis(radians(25), 1)));
}

// The near ball.

MirrorBall near_ball(double distance, double off = 0, double around = 0) {
    return {camera_for(distance, 150, kPrincipal), cone_at(distance, off, around)};
}

TEST(NearBall, AgreesWithTracedRays) {
    for (const double distance : kDistances)
        for (const double off : {0.0, 5.0, 17.0, 40.0}) {
            const Camera camera = camera_for(distance, 150, kPrincipal);
            const Cone cone = cone_at(distance, off, 100);
            if (!outline_of(cone, camera)) continue;  // it reaches the camera's plane
            const MirrorBall ball(camera, cone);
            EXPECT_EQ(ball.outline(), outline_of(cone, camera).value());
            const Outline& o = ball.outline();
            int shown = 0;
            for (int i = 0; i < 60; ++i)
                for (int j = 0; j < 60; ++j) {
                    const V2d p(o.cx + o.a * (i / 29.5 - 1), o.cy + o.a * (j / 29.5 - 1));
                    const auto exact = traced(camera, cone, p), d = ball.to_direction(p);
                    ASSERT_EQ(d.has_value(), exact.has_value()) << distance << " " << off << p;
                    if (!d) continue;
                    ++shown;
                    // The straightforward root loses D^2 of 1e-16, more at the rim.
                    EXPECT_LT(angle_between(*d, *exact), 1e-10 * distance) << p;
                    const V2d back = ball.to_position(*exact).value();
                    EXPECT_LT((back - p).length(), 1e-9 * o.a * distance) << p;
                }
            EXPECT_GT(shown, 500);
        }
}

TEST(NearBall, TurnsByTwiceTheIncidenceLessTheViewAngle) {
    for (const double distance : kDistances) {
        const MirrorBall ball = near_ball(distance);
        const double focal = *camera_for(distance, 150, kPrincipal).focal;
        for (double part = 0.05; part < 1; part += 0.05) {
            const double alpha = part * std::asin(1 / distance);
            const double theta = 2 * std::asin(distance * std::sin(alpha)) - alpha;
            const V2d up(kPrincipal.x, kPrincipal.y - focal * std::tan(alpha));
            const V3d expected(0, std::sin(theta), std::cos(theta));
            EXPECT_LT(angle_between(ball.to_direction(up).value(), expected), 1e-12);
            EXPECT_LT((ball.to_position(expected).value() - up).length(), 1e-9);
        }
    }
}

TEST(NearBall, HidesTheConeBehindItAndNothingElse) {
    for (const double distance : kDistances)
        for (const double off : {0.0, 12.0}) {
            const Cone cone = cone_at(distance, off, -30);
            const MirrorBall ball = near_ball(distance, off, -30);
            EXPECT_DOUBLE_EQ(ball.hidden_half_angle(), std::asin(1 / distance));
            EXPECT_NEAR(ball.distance(), distance, 1e-9 * distance);
            const V3d side = cone.axis.cross(V3d(0.3, 0.9, 0.1)).normalized();
            const auto around_the_back = [&](double angle) {
                return cone.axis * std::cos(angle) + side * std::sin(angle);
            };
            EXPECT_EQ(ball.to_position(cone.axis), std::nullopt);
            EXPECT_EQ(ball.to_position(around_the_back(cone.half_angle * (1 - 1e-6))),
                      std::nullopt);
            EXPECT_TRUE(ball.to_position(around_the_back(cone.half_angle * (1 + 1e-6))));
            EXPECT_TRUE(ball.curved(around_the_back(cone.half_angle + 0.1)));
            EXPECT_FALSE(ball.curved(-cone.axis));
            EXPECT_NEAR(ball.facing(-cone.axis), 1, 1e-15);
        }
}

TEST(NearBall, BendsBeyond150DegreesOrNearTheHiddenCone) {
    for (const double distance : kDistances) {
        const MirrorBall ball = near_ball(distance);
        // 0.2: what is called near the cone, radians
        const double limit = std::max(radians(30), std::asin(1 / distance) + 0.2);
        EXPECT_TRUE(ball.curved(off_axis(limit - 1e-6, 2))) << distance;
        EXPECT_FALSE(ball.curved(off_axis(limit + 1e-6, 2))) << distance;
        EXPECT_FALSE(ball.curved({0, 0, 1}));
    }
}

TEST(NearBall, HasNoZeroOverZeroTowardsTheCamera) {
    for (const double off : {0.0, 20.0}) {
        const Cone cone = cone_at(4, off, 50);
        const Camera camera = camera_for(4, 150, kPrincipal);
        const MirrorBall ball(camera, cone);
        const V2d centre(kPrincipal.x - *camera.focal * cone.axis.x / cone.axis.z,
                         kPrincipal.y + *camera.focal * cone.axis.y / cone.axis.z);
        EXPECT_LT((ball.to_position(-cone.axis).value() - centre).length(), 1e-9);
        EXPECT_LT(angle_between(ball.to_direction(centre).value(), -cone.axis), 1e-12);
        for (const double tiny : {1e-12, 1e-9, 1e-8}) {  // through where the formula changes
            const V3d d = (-cone.axis + V3d(tiny, 0, 0)).normalized();
            EXPECT_LT(angle_between(ball.to_direction(*ball.to_position(d)).value(), d), 1e-14);
        }
        EXPECT_TRUE(std::isfinite(ball.solid_angle(centre)));
        // Towards the camera theta = (2 D - 1) alpha: a pixel there shows (2 D - 1)^2 of its own
        // solid angle.
        const double cosine = -cone.axis.z;
        EXPECT_NEAR(ball.solid_angle(centre),
                    49 * std::pow(cosine, 3) / (*camera.focal * *camera.focal), 1e-9);
    }
}

TEST(NearBall, GoesOverIntoTheDistantOneAsItMovesAway) {
    const double radius = 150;
    const MirrorBall distant(Outline{kPrincipal.x, kPrincipal.y, radius, radius, 0});
    double last = 1;
    for (double distance = 10; distance <= 1e6; distance *= 10) {
        const MirrorBall near(camera_for(distance, radius, kPrincipal), cone_at(distance));
        double largest = 0, farthest = 0;
        for (const V3d& d : directions_on_sphere(2000)) {
            if (angle_between(d, {0, 0, 1}) > radians(150)) continue;
            const V2d p = distant.to_position(d).value();
            largest = std::max(largest, angle_between(near.to_direction(p).value(), d));
            farthest = std::max(farthest, (near.to_position(d).value() - p).length());
        }
        // theta = 2i - alpha and alpha <= 1/D; tan instead of sin and 150 degrees add a little:
        // 1/D of contract's 5.5 degrees at D = 10 is one degree of 1/D.
        EXPECT_LT(largest, 1.1 / distance) << distance;
        EXPECT_LT(farthest, radius / distance) << distance;
        EXPECT_LT(largest, last / 5) << distance;
        last = largest;
    }
}

/// The largest angle, in degrees, by which the distant formulas are wrong at a distance, for
/// directions up to 150 degrees.
double orthographic_error(double distance) {
    const MirrorBall near = near_ball(distance);
    const MirrorBall distant(near.outline());
    double largest = 0;
    for (double degree = 0; degree <= 150; degree += 0.1) {
        const V3d d(std::sin(radians(degree)), 0, std::cos(radians(degree)));
        const V3d wrong = distant.to_direction(near.to_position(d).value()).value();
        largest = std::max(largest, angle_between(wrong, d));
    }
    return degrees(largest);
}

TEST(NearBall, CostsWhatTheContractSaysIfTakenAsDistant) {
    EXPECT_NEAR(orthographic_error(4), 13.8, 0.05);  // the contract's figures are rounded
    EXPECT_NEAR(orthographic_error(10), 5.5, 0.05);
    EXPECT_NEAR(orthographic_error(20), 2.8, 0.05);
}

TEST(NearBall, HasNoPositionForWhatLiesBehindTheCamerasPlane) {
    const MirrorBall ball = near_ball(6, 40, 0);
    EXPECT_EQ(ball.to_direction(V2d(-20000, 240)), std::nullopt);  // the line's other side
    EXPECT_EQ(ball.solid_angle({0, 0}), 0);
}

TEST(NearBall, KeepsTheFrameOfTheCamerasAxesNotOfTheLineToTheBall) {
    // A ball to the right mirrors, in the middle it shows the camera: which lies to the left.
    const MirrorBall ball = near_ball(10, 30, 0);
    EXPECT_LT(angle_between(-ball.axis(), {-0.5, 0, std::sqrt(0.75)}), 1e-12);
    const V2d p = ball.to_position(V3d(-0.5, 0, std::sqrt(0.75))).value();
    EXPECT_GT(p.x, kPrincipal.x);
    EXPECT_NEAR(p.y, kPrincipal.y, 1e-9);
}

}  // namespace
}  // namespace chromeball
