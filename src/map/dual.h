#pragma once

#include <Imath/ImathVec.h>

#include <cmath>

namespace chromeball {

using Imath::V2d;
using Imath::V3d;

/// A number with its derivatives by two parameters, here always the position in an image.
///
/// A formula written once for a number type T gives values with T = double, and values with their
/// exact Jacobian with T = Dual (forward-mode differentiation).
struct Dual {
    double value = 0;
    double du = 0;
    double dv = 0;

    constexpr Dual() = default;
    constexpr Dual(double constant) : value(constant) {}
    constexpr Dual(double v, double by_u, double by_v) : value(v), du(by_u), dv(by_v) {}
};

constexpr double value_of(double x) { return x; }
constexpr double value_of(const Dual& x) { return x.value; }

/// f(x) from f's value and slope at x.
constexpr Dual chain(const Dual& x, double f, double slope) {
    return {f, slope * x.du, slope * x.dv};
}

constexpr Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.du + b.du, a.dv + b.dv};
}
constexpr Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.du - b.du, a.dv - b.dv};
}
constexpr Dual operator-(const Dual& a) { return {-a.value, -a.du, -a.dv}; }
constexpr Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.du * b.value + a.value * b.du, a.dv * b.value + a.value * b.dv};
}
constexpr Dual operator/(const Dual& a, const Dual& b) {
    const double q = a.value / b.value;
    return {q, (a.du - q * b.du) / b.value, (a.dv - q * b.dv) / b.value};
}

inline Dual sin(const Dual& x) { return chain(x, std::sin(x.value), std::cos(x.value)); }
inline Dual cos(const Dual& x) { return chain(x, std::cos(x.value), -std::sin(x.value)); }
/// Slope 0 where it is infinite, at 0: those who ask there (an axis) treat it apart.
inline Dual sqrt(const Dual& x) {
    const double root = std::sqrt(x.value);
    return chain(x, root, root > 0 ? 0.5 / root : 0);
}
/// Slope 0 at the origin, where the angle has none.
inline Dual atan2(const Dual& y, const Dual& x) {
    const double square = x.value * x.value + y.value * y.value;
    const double scale = square > 0 ? 1 / square : 0;
    return {std::atan2(y.value, x.value), (x.value * y.du - y.value * x.du) * scale,
            (x.value * y.dv - y.value * x.dv) * scale};
}

/// sqrt(x^2 + y^2).
template <class T>
T length_of(const T& x, const T& y) {
    using std::sqrt;
    return sqrt(x * x + y * y);
}

template <class T>
using Vec2 = Imath::Vec2<T>;
template <class T>
using Vec3 = Imath::Vec3<T>;

template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// a and a constant direction.
template <class T>
T along(const Vec3<T>& a, const V3d& direction) {
    return a.x * T(direction.x) + a.y * T(direction.y) + a.z * T(direction.z);
}

template <class T>
Vec3<T> unit(const Vec3<T>& a) {
    using std::sqrt;
    const T scale = T(1.0) / sqrt(dot(a, a));
    return {a.x * scale, a.y * scale, a.z * scale};
}

/// A constant vector as one of numbers of type T.
template <class T>
Vec3<T> constant(const V3d& a) {
    return {T(a.x), T(a.y), T(a.z)};
}

inline V2d value_of(const Vec2<Dual>& a) { return {a.x.value, a.y.value}; }
inline V3d value_of(const Vec3<Dual>& a) { return {a.x.value, a.y.value, a.z.value}; }

/// A position as the two parameters that everything computed from it is differentiated by.
inline Vec2<Dual> with_derivatives(V2d position) {
    return {Dual(position.x, 1, 0), Dual(position.y, 0, 1)};
}

}  // namespace chromeball
