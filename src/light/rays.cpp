#include "light/rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chromeball {
namespace {

using std::numbers::pi;

}  // namespace

std::size_t Rays::cell_of(V3d d) {
    const auto row = static_cast<std::size_t>(std::clamp((d.y + 1) / 2 * kRows, 0.0, kRows - 1.0));
    const double around = std::atan2(d.x, d.z) / (2 * pi) + 0.5;
    const auto column =
        static_cast<std::size_t>(std::clamp(around * kColumns, 0.0, kColumns - 1.0));
    return row * kColumns + column;
}

V3d Rays::middle(std::size_t cell) {
    const double y = (static_cast<double>(cell / kColumns) + 0.5) / kRows * 2 - 1;
    const double around = ((static_cast<double>(cell % kColumns) + 0.5) / kColumns - 0.5) * 2 * pi;
    const double across = std::sqrt(1 - y * y);
    return {across * std::sin(around), y, across * std::cos(around)};
}

void Rays::add(V3d d, const float* rgb, double steradians) {
    Ray& ray = rays_[cell_of(d)];
    ray.direction += d * steradians;
    ray.steradians += steradians;
    for (std::size_t c = 0; c < 3; ++c) ray.flux[c] += static_cast<double>(rgb[c]) * steradians;
}

void Rays::add_unknown(V3d d, double steradians) { unknown_[cell_of(d)] += steradians; }

std::vector<Ray> Rays::take() const {
    std::vector<Ray> all;
    for (Ray ray : rays_) {
        if (!(ray.steradians > 0)) continue;
        ray.direction.normalize();
        all.push_back(ray);
    }
    return all;
}

void Rays::fill() {
    const std::vector<Ray> known = take();
    if (known.empty()) return;
    // Pixels are no finer than cells, so that even where all is seen some cells hold too little
    // and others too much; together they tell what is not seen.
    double seen = 0, lacking = 0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        seen += rays_[i].steradians + unknown_[i];
        lacking += std::max(0.0, kCellArea - rays_[i].steradians - unknown_[i]);
    }
    const double part = lacking > 0 ? std::clamp((4 * pi - seen) / lacking, 0.0, 1.0) : 0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        const double empty = std::max(0.0, kCellArea - rays_[i].steradians - unknown_[i]);
        const double missing = unknown_[i] + part * empty;
        if (missing < 0.01 * kCellArea) continue;
        const V3d direction = middle(i);
        Ray around;
        double total = 0;
        for (const Ray& ray : known) {
            const double apart = 1 - direction.dot(ray.direction);  // half its square
            const double weight = 1 / (1e-4 + apart * apart * apart);
            total += weight * ray.steradians;
            for (std::size_t c = 0; c < 3; ++c) around.flux[c] += weight * ray.flux[c];
        }
        rays_[i].direction += direction * missing;
        rays_[i].steradians += missing;
        for (std::size_t c = 0; c < 3; ++c) rays_[i].flux[c] += around.flux[c] * missing / total;
    }
}

std::array<double, 3> Rays::radiance(V3d d) const {
    std::array<double, 3> mean = rays_[cell_of(d)].flux;
    for (double& v : mean) v /= kCellArea;
    return mean;
}

std::array<double, 3> irradiance_of(const std::vector<Ray>& rays, V3d normal) {
    std::array<double, 3> sum{};
    for (const Ray& ray : rays) {
        const double cosine = normal.dot(ray.direction);
        if (cosine <= 0) continue;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += cosine * ray.flux[c];
    }
    return sum;
}

}  // namespace chromeball
