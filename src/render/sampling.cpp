#include "render/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chromeball {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

std::uint32_t reversed(std::uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffU) << 8) | ((x & 0xff00ff00U) >> 8);
    x = ((x & 0x0f0f0f0fU) << 4) | ((x & 0xf0f0f0f0U) >> 4);
    x = ((x & 0x33333333U) << 2) | ((x & 0xccccccccU) >> 2);
    return ((x & 0x55555555U) << 1) | ((x & 0xaaaaaaaaU) >> 1);
}

std::uint32_t sobol_second(std::uint32_t i) {
    std::uint32_t out = 0;
    for (std::uint32_t v = 1U << 31; i != 0; i >>= 1, v ^= v >> 1)
        if (i & 1U) out ^= v;
    return out;
}

/// 24 bits, so that the largest is below 1 as a float.
float unit_float(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24F; }

/// Where a filter's integral reaches t, from its middle.
float warped(PixelFilter filter, float t) {
    switch (filter) {
        case PixelFilter::box:
            return t - 0.5F;
        case PixelFilter::triangle:
            return t < 0.5F ? std::sqrt(2 * t) - 1 : 1 - std::sqrt(2 * (1 - t));
        case PixelFilter::gaussian: {
            constexpr double kDeviation = 0.5, kReach = 1.5;
            const auto integral = [](double x) {
                return 0.5 * std::erf(x / (kDeviation * std::numbers::sqrt2));
            };
            double low = -kReach, high = kReach;
            const double most = integral(kReach), wanted = (2 * static_cast<double>(t) - 1) * most;
            for (int i = 0; i < 40; ++i) {
                const double middle = 0.5 * (low + high);
                (integral(middle) < wanted ? low : high) = middle;
            }
            return static_cast<float>(low);
        }
    }
    return 0;
}

/// The width of a box of the same variance.
float width_of(PixelFilter filter) {
    switch (filter) {
        case PixelFilter::box:
            return 1;
        case PixelFilter::triangle:
            return std::numbers::sqrt2_v<float>;
        case PixelFilter::gaussian:
            return 0.5F * std::sqrt(12.0F);
    }
    return 1;
}

}  // namespace

V2f spread_point(std::uint32_t i, std::uint32_t seed) {
    return {unit_float(reversed(i) ^ hashed(seed)),
            unit_float(sobol_second(i) ^ hashed(seed ^ 0x9e3779b9U))};
}

PixelSamples pixel_samples(PixelFilter filter, int count, std::uint32_t round) {
    PixelSamples samples;
    const int side = static_cast<int>(std::lround(std::sqrt(count)));
    // Later rounds are moved by the golden ratio's relatives in two dimensions.
    const auto moved = [&](float t, double by) {
        const double x = static_cast<double>(t) + by * round;
        return static_cast<float>(x - std::floor(x));
    };
    for (int i = 0; i < count; ++i) {
        V2f at((static_cast<float>(i % side) + 0.5F) / static_cast<float>(side),
               (static_cast<float>(i / side) + 0.5F) / static_cast<float>(side));
        if (side * side != count) at = spread_point(static_cast<std::uint32_t>(i), 0);
        if (round > 0) at = V2f(moved(at.x, 0.7548776662466927), moved(at.y, 0.5698402909980532));
        samples.offsets.emplace_back(0.5F + warped(filter, at.x), 0.5F + warped(filter, at.y));
    }
    samples.step = width_of(filter) / std::sqrt(static_cast<float>(count));
    return samples;
}

V3f cosine_direction(const V2f& at) {
    const float r = std::sqrt(at.x), around = 2 * kPi * at.y;
    return {r * std::cos(around), r * std::sin(around), std::sqrt(std::max(0.0F, 1 - at.x))};
}

V3f visible_facet(const V3f& v, float alpha, const V2f& at) {
    const V3f stretched = V3f(alpha * v.x, alpha * v.y, v.z).normalized();
    const float across = stretched.x * stretched.x + stretched.y * stretched.y;
    const V3f t1 =
        across > 0 ? V3f(-stretched.y, stretched.x, 0) / std::sqrt(across) : V3f(1, 0, 0);
    const V3f t2 = stretched.cross(t1);
    const float r = std::sqrt(at.x), around = 2 * kPi * at.y;
    const float x = r * std::cos(around);
    const float s = 0.5F * (1 + stretched.z);
    const float y = (1 - s) * std::sqrt(std::max(0.0F, 1 - x * x)) + s * r * std::sin(around);
    const V3f h = t1 * x + t2 * y + stretched * std::sqrt(std::max(0.0F, 1 - x * x - y * y));
    return V3f(alpha * h.x, alpha * h.y, std::max(0.0F, h.z)).normalized();
}

float ggx_density(const V3f& h, float alpha) {
    const float a2 = alpha * alpha, c = h.z * h.z * (a2 - 1) + 1;
    return a2 / (kPi * c * c);
}

float ggx_lambda(const V3f& v, float alpha) {
    const float c2 = std::max(v.z * v.z, 1e-12F);
    return 0.5F * (std::sqrt(1 + alpha * alpha * (1 - c2) / c2) - 1);
}

}  // namespace chromeball
