#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "core/image.h"
#include "map/mirror_ball.h"
#include "map/orientation.h"

// Places with something to see all around, and mirror balls that stand in them.

namespace chromeball::test {

/// A place made of soft spots of light of many sizes and colours; each number gives another one.
class Place {
public:
    explicit Place(unsigned number) {
        std::mt19937 random(number);  // its numbers are the same everywhere; distributions' are not
        const auto next = [&](double low, double high) {
            return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
        };
        for (int i = 0; i < 60; ++i) {
            V3d d;
            do d = V3d(next(-1, 1), next(-1, 1), next(-1, 1));
            while (d.length() > 1 || d.length() < 0.1);
            spots_.push_back({d.normalized(),
                              {next(0, 2), next(0, 2), next(0, 2)},
                              1 / std::pow(next(0.05, 0.35), 2)});
        }
    }
    V3d operator()(V3d d) const {
        V3d sum(0.2, 0.2, 0.2);
        for (const Spot& spot : spots_)
            sum += spot.color * std::exp(-spot.narrow * (1 - spot.direction.dot(d)));
        return sum;
    }

private:
    struct Spot {
        V3d direction, color;
        double narrow;
    };
    std::vector<Spot> spots_;
};

/// What a ball shows in a direction of the world, which is `seen` in the camera's frame.
using Shown = std::function<V3d(V3d world, V3d seen)>;

/// The photo of a ball over grey, RGB; 3 x 3 samples a pixel.
inline Image ball_view(Size size, const MirrorBall& ball, const Rotation& to_world,
                       const Shown& shown, double background = 0.05) {
    Image photo(size, 3);
    constexpr int kGrid = 3;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            V3d sum(0, 0, 0);
            for (int k = 0; k < kGrid * kGrid; ++k) {
                const V2d p(x + (k % kGrid + 0.5) / kGrid, y + (k / kGrid + 0.5) / kGrid);
                const auto d = ball.to_direction(p);
                sum += d ? shown(to_world * *d, *d) : V3d(background, background, background);
            }
            for (int c = 0; c < 3; ++c)
                photo.pixel(x, y)[c] = static_cast<float>(sum[c] / (kGrid * kGrid));
        }
    return photo;
}

/// Somebody dark who stands at the camera, some 12 degrees wide and from 10 above to 30 below it.
inline V3d with_photographer(V3d light, V3d seen) {
    const double right = std::atan2(seen.x, seen.z), up = std::asin(seen.y);
    const bool there = std::abs(right) < 0.1 && up < 0.17 && up > -0.52;
    return there ? V3d(0.03, 0.03, 0.04) : light;
}

inline double degrees_between(const Rotation& a, const Rotation& b) {
    const Rotation d = a * b.inverse();
    const V3d sine(d.at(2, 1) - d.at(1, 2), d.at(0, 2) - d.at(2, 0), d.at(1, 0) - d.at(0, 1));
    return std::atan2(sine.length(), d.at(0, 0) + d.at(1, 1) + d.at(2, 2) - 1) * 180 /
           3.141592653589793;
}

}  // namespace chromeball::test
