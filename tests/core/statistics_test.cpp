#include "core/statistics.h"

#include <gtest/gtest.h>

namespace chromeball {
namespace {

TEST(Statistics, TheMedianIsTheMiddleOrTheUpperOfTwo) {
    EXPECT_EQ(median({}), 0);
    EXPECT_EQ(median({-7}), -7);
    EXPECT_EQ(median({9, 1, 5}), 5);
    EXPECT_EQ(median({9, 1, 5, 4}), 5);
    EXPECT_EQ(median({2, 2, 2, 100, -100}), 2);
}

}  // namespace
}  // namespace chromeball
