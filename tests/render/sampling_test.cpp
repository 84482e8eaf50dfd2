#include "render/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace chromeball {
namespace {

TEST(SpreadPoints, FillEveryCellOnce) {
    for (const std::uint32_t seed : {0U, 1U, 77U})
        for (const auto& [across, down] :
             {std::pair(4, 4), std::pair(16, 1), std::pair(1, 16), std::pair(8, 2)}) {
            std::set<std::pair<int, int>> cells;
            for (std::uint32_t i = 16; i < 32; ++i) {
                const V2f p = spread_point(i, seed);
                ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
                cells.insert({int(p.x * float(across)), int(p.y * float(down))});
            }
            EXPECT_EQ(cells.size(), 16u) << across << " x " << down;
        }
}

TEST(PixelSamples, HaveTheirFiltersMeanAndVariance) {
    const auto variance_of = [](PixelFilter filter, int count, std::uint32_t round) {
        const PixelSamples samples = pixel_samples(filter, count, round);
        double mean = 0, square = 0;
        for (const V2f& p : samples.offsets) {
            mean += (p.x + p.y - 1.0) / (2.0 * count);
            square += ((p.x - 0.5) * (p.x - 0.5) + (p.y - 0.5) * (p.y - 0.5)) / (2.0 * count);
        }
        EXPECT_EQ(samples.offsets.size(), std::size_t(count));
        EXPECT_NEAR(mean, 0, 0.02);
        return square;
    };
    for (const int count : {64, 60, 256}) {
        for (const std::uint32_t round : {0U, 5U}) {
            EXPECT_NEAR(variance_of(PixelFilter::box, count, round), 1.0 / 12, 0.004) << count;
            EXPECT_NEAR(variance_of(PixelFilter::triangle, count, round), 1.0 / 6, 0.015) << count;
            EXPECT_NEAR(variance_of(PixelFilter::gaussian, count, round), 0.25, 0.045) << count;
        }
    }
    EXPECT_FLOAT_EQ(pixel_samples(PixelFilter::box, 16, 0).step, 0.25F);
}

TEST(CosineDirections, HaveTheirDensity) {
    double height = 0;
    for (std::uint32_t i = 0; i < 1024; ++i) {
        const V3f d = cosine_direction(spread_point(i, 3));
        EXPECT_NEAR(d.length(), 1, 1e-5);
        height += d.z / 1024.0;
    }
    EXPECT_NEAR(height, 2.0 / 3, 1e-3);
}

TEST(Facets, HaveTheirDensity) {
    // The integral of D(h) h.z over the hemisphere is 1, and so is that of visible facets.
    for (const float alpha : {0.05F, 0.3F, 1.0F}) {
        double sum = 0;
        constexpr int kSteps = 4000;
        for (int i = 0; i < kSteps; ++i) {
            const double theta = (i + 0.5) / kSteps * std::numbers::pi / 2;
            const V3f h(float(std::sin(theta)), 0, float(std::cos(theta)));
            sum += double(ggx_density(h, alpha)) * std::cos(theta) * std::sin(theta) * 2 *
                   std::numbers::pi * (std::numbers::pi / 2 / kSteps);
        }
        EXPECT_NEAR(sum, 1, 2e-3) << alpha;
        // Mean of 1 / density x known integrand: sum of D v.h over visible facets is v.z (1 +
        // Lambda).
        const V3f v = V3f(0.6F, 0, 0.8F);
        double mean = 0;
        for (std::uint32_t i = 0; i < 4096; ++i) {
            const V3f h = visible_facet(v, alpha, spread_point(i, 9));
            EXPECT_GE(v.dot(h), -1e-4F);
            mean += h.z / v.dot(h) / 4096.0;
        }
        // E[h.z / v.h] = integral of D h.z / (v.z (1 + Lambda)) over facets that v sees; those
        // that it does not see are few where the surface is smooth.
        const double wanted = 1 / (double(v.z) * (1 + double(ggx_lambda(v, alpha))));
        EXPECT_NEAR(mean, wanted, alpha > 0.5F ? 0.25 : 0.02) << alpha;
    }
}

}  // namespace
}  // namespace chromeball
