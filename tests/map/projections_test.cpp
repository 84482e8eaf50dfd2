// Laws that hold for every projection of the list, whatever it is.
#include "map/projections.h"

#include <gtest/gtest.h>

#include "map/layouts.h"
#include "support/balls.h"

namespace chromeball {
namespace {

using std::numbers::pi;

/// A projection with what a law must know of it.
template <class P>
struct Specimen {
    std::string name;
    P projection;
    V2d corner{0, 0};  ///< of the picture
    V2d side{1, 1};
};

template <class P>
std::vector<Specimen<P>> specimens() {
    return {{std::string(P::name), P{}}};
}
template <>
std::vector<Specimen<Cube>> specimens() {
    std::vector<Specimen<Cube>> all{{"cube", Cube()}};
    for (const CubeLayout& layout : cube_layouts())
        all.push_back({std::string(layout.name), Cube(layout)});
    return all;
}
template <>
std::vector<Specimen<MirrorBall>> specimens() {
    std::vector<Specimen<MirrorBall>> all;
    for (const auto& [name, ball] : balls_in_photos()) {
        const Outline& o = ball.outline();
        all.push_back({name, ball, V2d(o.cx - o.a, o.cy - o.a), V2d(2 * o.a, 2 * o.a)});
    }
    return all;
}

/// Random positions in the picture; the same ones every time.
template <class P>
std::vector<V2d> positions_in(const Specimen<P>& specimen, int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(0, 1);
    std::vector<V2d> positions;
    for (int i = 0; i < count; ++i) {
        const double x = part(random), y = part(random);
        positions.push_back(specimen.corner + V2d(x, y) * specimen.side);
    }
    return positions;
}

/// Whether the picture is smooth around a position: derivatives can be told from differences.
template <class P>
bool smooth_around(const Specimen<P>& specimen, V2d p) {
    const double step = 0.01 * specimen.side.x;
    for (const V2d& d : {V2d(1, 0), V2d(-1, 0), V2d(0, 1), V2d(0, -1)}) {
        const auto here = specimen.projection.to_direction(p),
                   there = specimen.projection.to_direction(p + d * step);
        if (!here || !there || angle_between(*here, *there) > 0.5) return false;
    }
    return true;
}

/// Directions hidden behind the ball have no position; none others.
template <class P>
bool hidden(const P&, V3d) {
    return false;
}
bool hidden(const MirrorBall& ball, V3d d) {
    return angle_between(ball.axis(), d) < ball.hidden_half_angle();
}

template <class P>
class EveryProjection : public testing::Test {};

template <class Tuple>
struct TypesOf;
template <class... P>
struct TypesOf<std::tuple<P...>> {
    using type = testing::Types<P...>;
};
TYPED_TEST_SUITE(EveryProjection, TypesOf<Projections>::type);

TYPED_TEST(EveryProjection, TakesADirectionToThePictureAndBack) {
    for (const auto& [name, projection, corner, side] : specimens<TypeParam>()) {
        int shown = 0;
        for (const V3d& d : directions_on_sphere(3000)) {
            const auto position = projection.to_position(d);
            EXPECT_EQ(position.has_value(), !hidden(projection, d)) << name << d;
            if (!position) continue;
            ++shown;
            EXPECT_GE(position->x, corner.x - 1e-9 * side.x) << name;
            EXPECT_LE(position->x, corner.x + side.x * (1 + 1e-9)) << name;
            EXPECT_GE(position->y, corner.y - 1e-9 * side.y) << name;
            EXPECT_LE(position->y, corner.y + side.y * (1 + 1e-9)) << name;
            const auto back = projection.to_direction(*position);
            ASSERT_TRUE(back) << name << d;
            // Rounding, 1e-16, is stretched by the slope at a ball's rim (1e4 for the last of
            // 3000 directions) and by |C|^2 of the distant one.
            EXPECT_LT(angle_between(d, *back), 1e-9) << name << d;
        }
        EXPECT_GT(shown, 1000) << name;
    }
}

TYPED_TEST(EveryProjection, TakesAPositionToItsDirectionAndBack) {
    for (const auto& specimen : specimens<TypeParam>()) {
        int shown = 0;
        for (const V2d& p : positions_in(specimen, 3000)) {
            const auto d = specimen.projection.to_direction(p);
            if (!d) continue;
            ++shown;
            const auto back = specimen.projection.to_position(*d);
            ASSERT_TRUE(back) << specimen.name << p;
            // 1e-9 of the picture: rounding of a direction, near a pole or the edge of an angular
            // map divided by the sine of some 1e-4
            EXPECT_LT((*back - p).length(), 1e-9 * specimen.side.x) << specimen.name << p;
        }
        EXPECT_GT(shown, 1000) << specimen.name;
    }
}

TYPED_TEST(EveryProjection, GivesUnitDirectionsAndTakesAnyLength) {
    for (const auto& specimen : specimens<TypeParam>()) {
        for (const V2d& p : positions_in(specimen, 300))
            if (const auto d = specimen.projection.to_direction(p)) {
                EXPECT_NEAR(d->length(), 1, 1e-12) << specimen.name;
            }
        for (const V3d& d : directions_on_sphere(300)) {
            const auto one = specimen.projection.to_position(d),
                       other = specimen.projection.to_position(d * 7.5);
            ASSERT_EQ(one.has_value(), other.has_value()) << specimen.name;
            if (one) {
                EXPECT_LT((*one - *other).length(), 1e-9 * specimen.side.x) << specimen.name;
            }
        }
    }
}

TYPED_TEST(EveryProjection, SurvivesAxesEdgesAndCorners) {
    for (const auto& specimen : specimens<TypeParam>())
        for (const V3d& d : cube_directions()) {
            const auto position = specimen.projection.to_position(d);
            if (!position) continue;
            EXPECT_TRUE(std::isfinite(position->x) && std::isfinite(position->y)) << specimen.name;
            const auto back = specimen.projection.to_direction(*position);
            ASSERT_TRUE(back) << specimen.name << d;
            EXPECT_LT(angle_between(d, *back), 1e-7) << specimen.name << d;
        }
}

TYPED_TEST(EveryProjection, HasTheJacobianThatDifferencesHave) {
    for (const auto& specimen : specimens<TypeParam>()) {
        const auto& projection = specimen.projection;
        const double h = 1e-6 * specimen.side.x;
        int compared = 0;
        for (const V2d& p : positions_in(specimen, 1000)) {
            if (!smooth_around(specimen, p)) continue;
            ++compared;
            const auto d = projection.to_direction(with_derivatives(p)).value();
            EXPECT_LT((value_of(d) - *projection.to_direction(p)).length(), 1e-15);
            const auto slope = [&](V2d step) {
                return (*projection.to_direction(p + step) - *projection.to_direction(p - step)) /
                       (2 * h);
            };
            const V3d by_u = slope({h, 0}), by_v = slope({0, h});
            // Rounding of 1e-16 over h = 1e-6 of the side, and h^2 times third derivatives
            // (largest, 1e5, where a ball's rim begins).
            const double tolerance = 1e-6 * std::max(1.0, by_u.length() + by_v.length());
            EXPECT_LT((by_u - V3d(d.x.du, d.y.du, d.z.du)).length(), tolerance)
                << specimen.name << p;
            EXPECT_LT((by_v - V3d(d.x.dv, d.y.dv, d.z.dv)).length(), tolerance)
                << specimen.name << p;
        }
        EXPECT_GT(compared, 300) << specimen.name;
    }
}

TYPED_TEST(EveryProjection, HasInverseJacobiansInItsTwoDirections) {
    for (const auto& specimen : specimens<TypeParam>())
        for (const V2d& p : positions_in(specimen, 1000)) {
            const auto d = specimen.projection.to_direction(with_derivatives(p));
            if (!d) continue;
            const auto back = specimen.projection.to_position(*d).value();
            // 1e-6: near a pole or a rim, rounding over a sine of 1e-4 twice
            EXPECT_NEAR(back.x.du, 1, 1e-6) << specimen.name << p;
            EXPECT_NEAR(back.x.dv, 0, 1e-6) << specimen.name << p;
            EXPECT_NEAR(back.y.du, 0, 1e-6) << specimen.name << p;
            EXPECT_NEAR(back.y.dv, 1, 1e-6) << specimen.name << p;
        }
}

TYPED_TEST(EveryProjection, HasTheSolidAngleOfItsJacobian) {
    for (const auto& specimen : specimens<TypeParam>())
        for (const V2d& p : positions_in(specimen, 1000)) {
            const double stated = specimen.projection.solid_angle(p);
            const double derived = solid_angle_from_jacobian(specimen.projection, p);
            EXPECT_NEAR(stated, derived, 1e-9 * std::max(stated, derived)) << specimen.name << p;
            EXPECT_EQ(stated > 0, specimen.projection.to_direction(p).has_value())
                << specimen.name << p;
        }
}

/// Integral of the solid angle over a picture, at the middles of n x n cells.
template <class P>
double integral(const Specimen<P>& specimen, int n) {
    double sum = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            sum += specimen.projection.solid_angle({(i + 0.5) / n, (j + 0.5) / n});
    return sum / (n * n);
}

/// The same over a disk: r = 1 - (1 - s)^2, in equal steps of s, takes away the infinity at a near
/// ball's rim.
template <class P>
double integral_over(const Outline& disk, const P& projection, int n) {
    double sum = 0;
    for (int j = 0; j < n; ++j) {
        const double s = (j + 0.5) / n, r = 1 - (1 - s) * (1 - s);
        for (int i = 0; i < 64; ++i) {
            const V2d centre(disk.cx, disk.cy);
            const V2d p = centre + (rim_point(disk, 2 * pi * (i + 0.5) / 64) - centre) * r;
            sum += projection.solid_angle(p) * r * 2 * (1 - s);
        }
    }
    return sum * disk.a * disk.b * 2 * pi / 64 / n;
}

template <class P>
double whole_integral(const Specimen<P>& specimen) {
    return integral(specimen, 288);  // a multiple of all cell counts: no cell is cut
}
template <>
double whole_integral(const Specimen<Angular>& specimen) {
    return integral_over({0.5, 0.5, 0.5, 0.5, 0}, specimen.projection, 400);
}
template <>
double whole_integral(const Specimen<MirrorBall>& specimen) {
    return integral_over(specimen.projection.outline(), specimen.projection, 400);
}

double hidden_solid_angle(const auto&) { return 0; }
double hidden_solid_angle(const MirrorBall& ball) {
    return 2 * pi * (1 - std::cos(ball.hidden_half_angle()));
}

TYPED_TEST(EveryProjection, ShowsTheWholeSphereOnce) {
    for (const auto& specimen : specimens<TypeParam>()) {
        const double shown = 4 * pi - hidden_solid_angle(specimen.projection);
        // 2e-4: midpoints of 48 cells across a face of the coarsest cube, of 400 across a disk
        EXPECT_NEAR(whole_integral(specimen) / shown, 1, 2e-4) << specimen.name;
    }
}

/// +1 where right x down points the way the picture shows, as for writing seen from inside; -1
/// where it is mirrored.
int handedness(const AnyProjection& any, V2d p) {
    return std::visit(
        [&](const auto& projection) {
            const auto d = projection.to_direction(with_derivatives(p));
            if (!d) return 0;
            const V3d by_u(d->x.du, d->y.du, d->z.du), by_v(d->x.dv, d->y.dv, d->z.dv);
            return by_u.cross(by_v).dot(value_of(*d)) > 0 ? 1 : -1;
        },
        any);
}

TEST(EveryLayout, MirrorsNothingButTheBallItselfAndOpenGl) {
    for (const Layout& layout : layouts()) {
        const bool mirrored = layout.name == "mirror-ball" || layout.name == "faces-opengl";
        for (const V2d& p : positions_in(Specimen<LatLong>{}, 300)) {
            const int hand = handedness(layout.projection, p);
            EXPECT_NE(hand, mirrored ? 1 : -1) << layout.name << p;
        }
    }
}

TEST(EveryLayout, ShowsEveryDirection) {
    for (const Layout& layout : layouts())
        std::visit(
            [&](const auto& projection) {
                for (const V3d& d : directions_on_sphere(1000)) {
                    const auto p = projection.to_position(d);
                    ASSERT_TRUE(p) << layout.name;
                    EXPECT_LT(angle_between(projection.to_direction(*p).value(), d), 1e-9)
                        << layout.name;
                }
            },
            layout.projection);
}

}  // namespace
}  // namespace chromeball
