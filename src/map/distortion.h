#pragma once

#include <cmath>

#include "map/dual.h"

namespace chromeball {

/// Radial lens distortion as OpenCV (Brown) writes it: a ray (x, y, 1) of the pinhole is seen at
/// (x, y) (1 + k1 r^2 + k2 r^4 + k3 r^6), r^2 = x^2 + y^2. All 0: none.
/// Brown: Decentering Distortion of Lenses, 1966.
struct Distortion {
    double k1 = 0;
    double k2 = 0;
    double k3 = 0;

    bool operator==(const Distortion&) const = default;
    bool none() const { return *this == Distortion(); }

    /// From the pinhole's coordinates (focal length 1) to those in the photo.
    template <class T>
    Vec2<T> distorted(const Vec2<T>& p) const {
        const T square = p.x * p.x + p.y * p.y;
        const T factor = T(1.0) + square * (T(k1) + square * (T(k2) + square * T(k3)));
        return {p.x * factor, p.y * factor};
    }

    /// Back. Beyond the radius where the lens folds over (real pictures end before) the result is
    /// that radius' own.
    template <class T>
    Vec2<T> undistorted(const Vec2<T>& p) const {
        if (none()) return p;
        const T radius = length_of(p.x, p.y);
        if (value_of(radius) < 1e-12) return p;
        const T ratio = pinhole_radius(radius) / radius;
        return {p.x * ratio, p.y * ratio};
    }

private:
    double seen_radius(double r) const {
        return r * (1 + r * r * (k1 + r * r * (k2 + r * r * k3)));
    }
    double slope(double r) const {
        return 1 + r * r * (3 * k1 + r * r * (5 * k2 + r * r * 7 * k3));
    }
    /// Newton from the seen radius; steps that would leave the rising part are halved.
    double pinhole_radius(double seen) const {
        double r = seen;
        while (slope(r) <= 0.05 && r > 1e-6) r *= 0.9;
        for (int step = 0; step < 30; ++step) {
            const double move = (seen_radius(r) - seen) / slope(r);
            double next = r - move;
            while (slope(next) <= 0.01 && next != r) next = 0.5 * (next + r);
            if (std::abs(next - r) < 1e-15 * (1 + r)) return next;
            r = next;
        }
        return r;
    }
    Dual pinhole_radius(const Dual& seen) const {
        const double r = pinhole_radius(seen.value);
        return chain(seen, r, 1 / slope(r));
    }
};

}  // namespace chromeball
