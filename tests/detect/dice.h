#pragma once

#include <cmath>
#include <random>

#include "map/camera.h"

namespace chromeball::painted {

/// Numbers that are the same on every machine, unlike the standard library's distributions.
class Dice {
public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
    }
    double log_uniform(double low, double high) {
        return std::exp(uniform(std::log(low), std::log(high)));
    }
    bool chance(double part) { return uniform(0, 1) < part; }
    int whole(int low, int high) { return static_cast<int>(std::floor(uniform(low, high + 1.0))); }
    /// Nearly normal; fast, for there are many.
    double normal() {
        const auto bits = engine_();
        const auto part = [&](int shift) { return static_cast<double>(bits >> shift & 255) / 255; };
        return 1.73 * (part(0) + part(8) + part(16) + part(24) - 2);
    }
    V3d color(double spread) {
        const double level = log_uniform(0.02, 1);
        return V3d(uniform(1 - spread, 1), uniform(1 - spread, 1), uniform(1 - spread, 1)) * level;
    }
    V3d direction() {
        const double y = uniform(-1, 1), turn = uniform(0, 6.2832), s = std::sqrt(1 - y * y);
        return {s * std::cos(turn), y, s * std::sin(turn)};
    }

private:
    std::mt19937 engine_;
};

}  // namespace chromeball::painted
