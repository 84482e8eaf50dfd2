#include "map/dual.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>

namespace chromeball {
namespace {

/// Both derivatives of f at (x, y), from dual numbers, against central differences.
template <class F>
void expect_derivatives(const F& f, double x, double y) {
    constexpr double h = 1e-5;
    const Dual exact = f(Dual(x, 1, 0), Dual(y, 0, 1));
    EXPECT_DOUBLE_EQ(exact.value, f(x, y));
    // 1e-9: h^2 times third derivatives of order 10, and rounding 1e-16 / h
    EXPECT_NEAR(exact.du, (f(x + h, y) - f(x - h, y)) / (2 * h), 2e-9);
    EXPECT_NEAR(exact.dv, (f(x, y + h) - f(x, y - h)) / (2 * h), 2e-9);
}

TEST(Dual, DerivesArithmetic) {
    expect_derivatives([](auto x, auto y) { return x + y * y - x * y; }, 1.2, -0.7);
    expect_derivatives([](auto x, auto y) { return -(x / y); }, 1.2, -0.7);
    expect_derivatives([](auto x, auto y) { return decltype(x)(2.0) - y / (x * x); }, 1.2, -0.7);
}

TEST(Dual, DerivesFunctions) {
    using std::sin, std::cos, std::sqrt, std::atan2;
    expect_derivatives([](auto x, auto y) { return sin(x * y); }, 1.2, -0.7);
    expect_derivatives([](auto x, auto y) { return cos(x - y); }, 1.2, -0.7);
    expect_derivatives([](auto x, auto y) { return sqrt(x * x + y); }, 1.2, -0.7);
    for (const double x : {1.2, -1.2})
        for (const double y : {0.7, -0.7})
            expect_derivatives([](auto a, auto b) { return atan2(a, b); }, x, y);
    expect_derivatives([](auto x, auto y) { return length_of(x, y); }, 1.2, -0.7);
}

TEST(Dual, DerivesVectors) {
    const V3d fixed(0.3, -0.5, 2);
    expect_derivatives([&]<class T>(T x, T y) { return along(unit(Vec3<T>(x, y, x * y)), fixed); },
                       1.2, -0.7);
    expect_derivatives(
        [&]<class T>(T x, T y) { return dot(Vec3<T>(x, y, x * y), constant<T>(fixed)); }, 1.2,
        -0.7);
}

TEST(Dual, HasNoInfinitiesAtTheOriginOfRootAndAngle) {
    const Dual zero(0, 1, 0);
    EXPECT_EQ(sqrt(zero).du, 0);
    EXPECT_EQ(atan2(zero, zero).du, 0);
}

TEST(Dual, NamesThePositionAsItsParameters) {
    const auto p = with_derivatives({3, 4});
    EXPECT_EQ(value_of(p), V2d(3, 4));
    EXPECT_EQ(V2d(p.x.du, p.x.dv), V2d(1, 0));
    EXPECT_EQ(V2d(p.y.du, p.y.dv), V2d(0, 1));
    EXPECT_EQ(value_of(Vec3<Dual>(1.0, 2.0, 3.0)), V3d(1, 2, 3));
}

}  // namespace
}  // namespace chromeball
