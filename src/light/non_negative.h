#pragma once

#include <span>
#include <vector>

namespace chromeball {

/// One unknown's part in each equation: equation i says that the sum over the unknowns j of
/// columns[j][i] x[j] is wanted[i].
using EquationColumn = std::vector<double>;

/// Weighted least squares with no unknown below 0: Lawson and Hanson, Solving Least Squares
/// Problems, 1974, chapter 23, on normal equations; meant for a few unknowns. Those whose columns
/// are the same share what they explain.
///
/// wanted    one an equation, as many as each column has
/// weights   one an equation, not negative
/// Gives one number a column, 0 or more.
std::vector<double> non_negative_least_squares(std::span<const EquationColumn> columns,
                                               std::span<const double> wanted,
                                               std::span<const double> weights);

/// The same where some equations are wrong: Huber's weights, in a few rounds. Outliers are off by
/// more than 2.5 times the median magnitude, and by more than `noise`; Huber: Robust Estimation of
/// a Location Parameter, 1964.
std::vector<double> robust_non_negative(std::span<const EquationColumn> columns,
                                        std::span<const double> wanted, double noise);

/// What unknowns make of the equations: one number an equation.
std::vector<double> combined(std::span<const EquationColumn> columns,
                             std::span<const double> unknowns, std::size_t equations);

}  // namespace chromeball
