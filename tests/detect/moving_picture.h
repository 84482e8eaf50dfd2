#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "detect/painted.h"
#include "detect/plain_world.h"

namespace chromeball::painted {

/// A ball that moved while the shutter was open.
struct Moving {
    Photo photo;
    Outline outline;  ///< in the middle of the exposure
    V2d motion;       ///< pixels, from shutter open to close
    double noise;     ///< codes
    Camera camera;
};

constexpr int kTimes = 40;  // shutter positions; spread over the pixel too

/// Mirror ball in a random world, moved by `part` of its radius. The exposure is the mean of many
/// instants in linear light; the background stands still. With `instants` it is that of a renderer:
/// each pixel's mean is over so many instants and places, random ones, and grainy where they
/// differ.
inline Moving moving_picture(unsigned seed, double part, int instants = 0) {
    Dice dice(seed), grain(seed + 1);
    const World world(dice);
    Moving made{};
    Scene scene;
    const int w = dice.whole(360, 640), h = w * dice.whole(60, 80) / 100;
    scene.size = {w, h};
    scene.camera = {dice.log_uniform(0.9, 2.5) * w, {0.5 * w, 0.5 * h}};
    const double f = *scene.camera.focal, radius = dice.log_uniform(36, 0.36 * h);
    const double reach = 1.1 * radius;
    const double x = dice.uniform(reach, w - reach), y = dice.uniform(reach, h - reach);
    scene.centre = V3d((x - 0.5 * w) / f, (0.5 * h - y) / f, -1) * (f / radius);
    made.outline = scene.outline();
    made.camera = scene.camera;
    const Outline rim = made.outline;
    const double heading = dice.uniform(0, 2 * std::numbers::pi);
    made.motion = V2d(std::cos(heading), std::sin(heading)) * (part * radius);
    const double reflects = dice.uniform(0.55, 0.95);
    made.noise = dice.log_uniform(0.5, 4);

    const auto seen = [&](double px, double py, double time) {
        const auto ray = [&](double qx, double qy) {
            return V3d((qx - 0.5 * w) / f, (0.5 * h - qy) / f, -1).normalized();
        };
        const V3d p = ray(px - time * made.motion.x, py - time * made.motion.y);
        const double along = p.dot(scene.centre);
        const double inside = along * along - scene.centre.length2() + 1;
        if (inside <= 0) return world.seen(ray(px, py));
        const V3d n = p * (along - std::sqrt(inside)) - scene.centre;
        return world.seen(p - n * (2 * p.dot(n))) * reflects;
    };
    std::vector<float> light;
    double mean = 0;
    const double far = rim.a + 0.5 * made.motion.length() + 2;
    for (int j = 0; j < h; ++j)
        for (int i = 0; i < w; ++i) {
            const bool near = std::hypot(i + 0.5 - rim.cx, j + 0.5 - rim.cy) < far;
            const int times = !near ? 4 : instants > 0 ? instants : kTimes;
            V3d sum(0);
            for (int k = 0; k < times; ++k)
                if (near && instants > 0)
                    sum += seen(i + grain.uniform(0, 1), j + grain.uniform(0, 1),
                                grain.uniform(-0.5, 0.5));
                else  // a lattice of pixel and time
                    sum += seen(i + std::fmod((k + 0.5) * 0.618034, 1.0),
                                j + std::fmod((k + 0.5) * 0.754878, 1.0), (k + 0.5) / times - 0.5);
            for (int c = 0; c < 3; ++c) light.push_back(static_cast<float>(sum[c] / times));
            mean += std::min(sum.y / times, 2.0) / (double(w) * h);
        }
    const auto exposure = static_cast<float>(dice.log_uniform(0.12, 0.4) / std::max(mean, 1e-3));
    for (float& v : light) v *= exposure;
    made.photo = camera_photo(light, scene.size, made.noise);
    return made;
}

}  // namespace chromeball::painted
