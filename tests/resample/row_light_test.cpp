#include "resample/row_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "resample/simd.h"

namespace chromeball {
namespace {

TEST(RowLight, IsTheSumAndTheMostOfEveryChannelOnEveryTarget) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(-1, 3);
    for (const std::string& target : simd_targets()) {
        ASSERT_TRUE(use_simd_target(target));
        for (std::size_t count = 0; count < 70; ++count) {
            std::vector<float> pixels(4 * count);
            for (float& v : pixels) v = value(random);
            if (count > 5) {
                pixels[4] = std::numeric_limits<float>::quiet_NaN();
                pixels[9] = std::numeric_limits<float>::infinity();
                pixels[14] = -std::numeric_limits<float>::infinity();
            }
            double sum[3] = {}, highest[3] = {};
            for (std::size_t i = 0; i < pixels.size(); ++i)
                if (i % 4 < 3 && std::isfinite(pixels[i]) && pixels[i] > 0) {
                    sum[i % 4] += static_cast<double>(pixels[i]);
                    highest[i % 4] = std::max(highest[i % 4], static_cast<double>(pixels[i]));
                }
            const RowLight row = row_light(pixels.data(), count);
            for (std::size_t c = 0; c < 3; ++c) {
                // 70 sums of floats, of three at most
                EXPECT_NEAR(row.sum[c], sum[c], 70 * 3 * 1e-6) << target << " " << count;
                EXPECT_EQ(static_cast<double>(row.highest[c]), highest[c]) << target << count;
            }
        }
    }
    use_simd_target("");
}

}  // namespace
}  // namespace chromeball
