#include "light/non_negative.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/statistics.h"

namespace chromeball {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

Matrix matrix_of(std::span<const EquationColumn> columns, std::size_t equations) {
    Matrix all(static_cast<Eigen::Index>(equations), static_cast<Eigen::Index>(columns.size()));
    Eigen::Index at = 0;
    for (const EquationColumn& column : columns) {
        assert(column.size() == equations);
        all.col(at++) = Eigen::Map<const Vector>(column.data(), all.rows());
    }
    return all;
}

Eigen::Map<const Vector> vector_of(std::span<const double> values) {
    return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// Unknowns that may be above 0; the others are held at 0.
using Free = std::vector<bool>;

bool is_free(const Free& free, Eigen::Index i) { return free[static_cast<std::size_t>(i)]; }

/// The solution with no regard to signs.
Vector solved(const Matrix& normal, const Vector& right, const Free& free) {
    Matrix held = normal;
    Vector wanted = right;
    for (Eigen::Index i = 0; i < right.size(); ++i) {
        if (is_free(free, i)) continue;
        held.row(i).setZero();
        held.col(i).setZero();
        held(i, i) = 1;
        wanted[i] = 0;
    }
    return held.ldlt().solve(wanted);
}

/// Goes to the solution of the free unknowns; those that would fall below 0 on the way become held.
void settle(const Matrix& normal, const Vector& right, Free& free, Vector& x) {
    for (;;) {
        const Vector z = solved(normal, right, free);
        double part = 1;
        for (Eigen::Index i = 0; i < x.size(); ++i)
            if (is_free(free, i) && z[i] <= 0 && x[i] > z[i])
                part = std::min(part, x[i] / (x[i] - z[i]));
        x += part * (z - x);
        if (part == 1) return;
        for (Eigen::Index i = 0; i < x.size(); ++i)
            if (is_free(free, i) && x[i] <= 1e-15)
                free[static_cast<std::size_t>(i)] = false, x[i] = 0;
    }
}

/// The held unknown that would lessen the misfit most, were it above 0; -1: none would.
Eigen::Index best_held(const Vector& slope, const Vector& right, const Free& free) {
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < slope.size(); ++i)
        if (!is_free(free, i) && slope[i] > 1e-12 * std::abs(right[i]) &&
            (best < 0 || slope[i] > slope[best]))
            best = i;
    return best;
}

Vector least_squares(const Matrix& columns, const Vector& wanted, const Vector& weights) {
    const Matrix weighted = weights.asDiagonal() * columns;
    Matrix normal = weighted.transpose() * columns;
    // Unknowns that cannot be told apart share what they explain rather than fight over it.
    normal.diagonal() *= 1 + 1e-6;
    const Vector right = weighted.transpose() * wanted;
    Vector x = Vector::Zero(right.size());
    Free free(static_cast<std::size_t>(x.size()));
    for (Eigen::Index round = 0; round < 3 * x.size(); ++round) {
        const Vector slope = right - normal * x;
        const Eigen::Index best = best_held(slope, right, free);
        if (best < 0) break;
        free[static_cast<std::size_t>(best)] = true;
        settle(normal, right, free, x);
    }
    return x;
}

}  // namespace

std::vector<double> non_negative_least_squares(std::span<const EquationColumn> columns,
                                               std::span<const double> wanted,
                                               std::span<const double> weights) {
    assert(weights.size() == wanted.size());
    const Vector x =
        least_squares(matrix_of(columns, wanted.size()), vector_of(wanted), vector_of(weights));
    return {x.begin(), x.end()};
}

std::vector<double> robust_non_negative(std::span<const EquationColumn> columns,
                                        std::span<const double> wanted, double noise) {
    constexpr int kRounds = 12;
    const Matrix all = matrix_of(columns, wanted.size());
    const Vector right = vector_of(wanted);
    Vector weights = Vector::Ones(right.size());
    Vector x = Vector::Zero(all.cols());
    for (int round = 0; round < kRounds && all.cols() > 0; ++round) {
        x = least_squares(all, right, weights);
        const Vector off = (all * x - right).cwiseAbs();
        const double far = std::max(2.5 * median({off.begin(), off.end()}), noise);
        for (Eigen::Index i = 0; i < off.size(); ++i) weights[i] = off[i] > far ? far / off[i] : 1;
    }
    return {x.begin(), x.end()};
}

std::vector<double> combined(std::span<const EquationColumn> columns,
                             std::span<const double> unknowns, std::size_t equations) {
    assert(unknowns.size() == columns.size());
    std::vector<double> sums(equations);
    for (std::size_t j = 0; j < columns.size(); ++j)
        for (std::size_t i = 0; i < equations; ++i) sums[i] += columns[j][i] * unknowns[j];
    return sums;
}

}  // namespace chromeball
