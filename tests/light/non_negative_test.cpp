#include "light/non_negative.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chromeball {
namespace {

using Values = std::vector<double>;
using Columns = std::vector<EquationColumn>;

Values solved(const Columns& columns, const Values& wanted) {
    return non_negative_least_squares(columns, wanted, Values(wanted.size(), 1));
}

/// The solver's answers are good to the part by which it holds collinear unknowns apart.
constexpr double kExact = 1e-5;

TEST(NonNegative, IsLeastSquaresWhereNothingIsBelowZero) {
    // A line through (0, 1), (1, 2), (2, 4): 1.5 t + 5/6.
    const Values x = solved({{0, 1, 2}, {1, 1, 1}}, {1, 2, 4});
    ASSERT_EQ(x.size(), 2U);
    EXPECT_NEAR(x[0], 1.5, kExact);
    EXPECT_NEAR(x[1], 5.0 / 6, kExact);
}

TEST(NonNegative, HoldsAtZeroWhatWouldBeBelow) {
    // Freely (3, -1); the first column alone is the mean.
    const Columns columns{{1, 1, 1}, {1, 0, 0}};
    const Values wanted{2, 3, 3};
    const Values x = solved(columns, wanted);
    EXPECT_NEAR(x[0], 8.0 / 3, kExact);
    EXPECT_EQ(x[1], 0);
}

TEST(NonNegative, LeavesNoStepThatWouldLessenTheMisfit) {
    // Karush, Kuhn and Tucker: where x is above 0 the misfit's slope is 0, elsewhere it must not
    // fall. So for any equations, among them ones that make unknowns leave and come back.
    for (int seed = 1; seed <= 200; ++seed) {
        const auto noise = [&, state = static_cast<unsigned>(seed) * 2654435761U]() mutable {
            state = state * 1664525U + 1013904223U;
            return static_cast<double>(state >> 8) / (1U << 23) - 1;  // -1 to 1
        };
        Columns columns(5, EquationColumn(12));
        const double common = 0.2 * (seed % 5);  // the columns' likeness
        Values shared(12), wanted(12);
        auto next = noise;
        for (double& v : shared) v = next();
        for (auto& column : columns)
            for (std::size_t i = 0; i < 12; ++i) column[i] = common * shared[i] + next();
        for (double& v : wanted) v = next();
        const Values x = solved(columns, wanted);
        Values left = combined(columns, x, 12);
        for (std::size_t i = 0; i < 12; ++i) left[i] = wanted[i] - left[i];
        for (std::size_t j = 0; j < 5; ++j) {
            double fall = 0;
            for (std::size_t i = 0; i < 12; ++i) fall += columns[j][i] * left[i];
            EXPECT_GE(x[j], 0) << seed;
            EXPECT_LT(fall, 1e-4) << seed;
            EXPECT_NEAR(x[j] > 0 ? fall : 0, 0, 1e-4) << seed;
        }
    }
}

TEST(NonNegative, GivesNothingWhereAllWouldBeBelowZero) {
    EXPECT_EQ(solved({{1, 1}, {1, 2}}, {-1, -3}), (Values{0, 0}));
    EXPECT_TRUE(solved({}, {1, 2}).empty());
}

TEST(NonNegative, SharesAmongThoseThatCannotBeToldApart) {
    const Values x = solved({{1, 2, 3}, {1, 2, 3}}, {4, 8, 12});
    EXPECT_NEAR(x[0] + x[1], 4, kExact);
    EXPECT_NEAR(x[0], x[1], 1e-3);
}

TEST(NonNegative, CountsEquationsByTheirWeights) {
    const Values x = non_negative_least_squares(Columns{{1, 1}}, Values{1, 5}, Values{3, 1});
    EXPECT_NEAR(x[0], 2, kExact);
}

TEST(RobustNonNegative, LeavesOutliersOut) {
    // 2 t + 1, of which every fifth is far below: a shadow.
    Columns columns(2);
    Values wanted;
    for (int i = 0; i < 50; ++i) {
        columns[0].push_back(0.1 * i);
        columns[1].push_back(1);
        wanted.push_back((0.2 * i + 1) * (i % 5 == 2 ? 0.3 : 1) + 0.001 * (i % 3 - 1));
    }
    const Values x = robust_non_negative(columns, wanted, 0.01);
    EXPECT_NEAR(x[0], 2, 0.01);
    EXPECT_NEAR(x[1], 1, 0.01);
    EXPECT_GT(std::abs(solved(columns, wanted)[0] - 2), 0.2);
}

TEST(RobustNonNegative, WhatIsWithinTheNoiseIsNoOutlier) {
    // One of four is the odd one out.
    const Columns ones{{1, 1, 1, 1}};
    EXPECT_NEAR(robust_non_negative(ones, Values{1, 1, 1, 2}, 10)[0], 1.25, kExact);
    EXPECT_LT(robust_non_negative(ones, Values{1, 1, 1, 2}, 1e-3)[0], 1.1);
}

TEST(Combined, AddsColumnsTimesUnknowns) {
    EXPECT_EQ(combined(Columns{{1, 2}, {10, 20}}, Values{3, 0.5}, 2), (Values{8, 16}));
    EXPECT_EQ(combined(Columns{}, Values{}, 2), (Values{0, 0}));
}

}  // namespace
}  // namespace chromeball
