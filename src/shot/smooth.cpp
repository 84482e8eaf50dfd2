#include "shot/smooth.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/statistics.h"

namespace chromeball {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

/// Pseudo-observations that say that the deviations are right.
constexpr double kBelief = 8;
/// Softest and stiffest curve; at the soft end every sample is met, at the stiff end waves shorter
/// than about a hundred frames are not, and the system is still solved to 1e-6.
constexpr double kSoftest = 4, kStiffest = -9;  // powers of ten

/// The penalty D'D of differences of an order.
Sparse penalty(int count, int order) {
    std::vector<double> stencil{1};
    for (int i = 0; i < order; ++i) {
        stencil.push_back(0);
        for (std::size_t j = stencil.size() - 1; j > 0; --j) stencil[j] -= stencil[j - 1];
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (int row = 0; row + order < count; ++row)
        for (int i = 0; i <= order; ++i)
            entries.emplace_back(row, row + i, stencil[static_cast<std::size_t>(i)]);
    Sparse differences(std::max(count - order, 0), count);
    differences.setFromTriplets(entries.begin(), entries.end());
    return Sparse(differences.transpose() * differences);
}

/// The system for one stiffness after the other.
class Curve {
public:
    Curve(const Samples& samples, int order)
        : count_(samples.count),
          order_(order),
          right_(Vector::Zero(samples.count)),
          values_(Vector::Zero(samples.count)),
          weights_(Vector::Zero(samples.count)),
          penalty_(penalty(samples.count, order)) {
        for (std::size_t i = 0; i < samples.at.size(); ++i) {
            const double w = samples.weight[i] / (samples.deviation[i] * samples.deviation[i]);
            weights_[samples.at[i]] = w;
            values_[samples.at[i]] = samples.value[i];
            right_[samples.at[i]] = w * samples.value[i];
            trusted_ += samples.weight[i];
        }
        Sparse diagonal(count_, count_);
        diagonal.setIdentity();
        solver_.analyzePattern(Sparse(penalty_ + diagonal));
    }

    /// Minus twice the log of the marginal likelihood, up to a constant. Keeps the curve.
    double badness(double ratio) {
        Sparse system = penalty_ * (1 / ratio);
        for (int i = 0; i < count_; ++i) system.coeffRef(i, i) += weights_[i];
        solver_.factorize(system);
        curve_ = solver_.solve(right_);
        const Vector residual = values_ - curve_;
        const double misfit =
            residual.dot(weights_.cwiseProduct(residual)) + curve_.dot(penalty_ * curve_) / ratio;
        const double free = std::max(0.0, trusted_ - order_) + kBelief;
        // A detection may be a few times worse than it thinks. What differs more is no noise of its
        // own but a shake to be followed.
        constexpr double kLeastNoise = 0.5, kMostNoise = 4;
        variance_ = std::clamp((misfit + kBelief) / free, kLeastNoise * kLeastNoise,
                               kMostNoise * kMostNoise);
        const double volume = solver_.vectorD().array().max(1e-300).log().sum();
        // Paths are smooth rather than not: a softer curve has to pay its way.
        constexpr double kSmoothness = 2;  // per power of ten
        return free * std::log(variance_) + (misfit + kBelief) / variance_ + volume +
               (count_ - order_ + kSmoothness / std::numbers::ln10) * std::log(ratio);
    }

    const Vector& curve() const { return curve_; }
    double variance() const { return variance_; }

private:
    int count_, order_;
    double trusted_ = 0;
    Vector right_, values_, weights_;
    Sparse penalty_;
    Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> solver_;
    Vector curve_;
    double variance_ = 1;
};

/// The power of ten with the least badness: the best of a coarse row, then golden sections.
double best_power(Curve& curve) {
    double best = kSoftest, least = curve.badness(std::pow(10, kSoftest));
    for (double power = kSoftest - 1; power >= kStiffest; --power)
        if (const double badness = curve.badness(std::pow(10, power)); badness < least) {
            least = badness;
            best = power;
        }
    constexpr double kGolden = 1 / std::numbers::phi;
    double low = best - 1, high = best + 1;
    double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    double at_a = curve.badness(std::pow(10, a)), at_b = curve.badness(std::pow(10, b));
    for (int step = 0; step < 8; ++step) {  // to a twentieth of a decade
        if (at_a < at_b) {
            high = b;
            b = a;
            at_b = at_a;
            a = high - kGolden * (high - low);
            at_a = curve.badness(std::pow(10, a));
        } else {
            low = a;
            a = b;
            at_a = at_b;
            b = low + kGolden * (high - low);
            at_b = curve.badness(std::pow(10, b));
        }
    }
    return 0.5 * (low + high);
}

/// Without those that are told.
Samples seen(const Samples& samples) {
    Samples some;
    some.count = samples.count;
    for (std::size_t i = 0; i < samples.at.size(); ++i) {
        if (samples.told[i]) continue;
        some.at.push_back(samples.at[i]);
        some.value.push_back(samples.value[i]);
        some.deviation.push_back(samples.deviation[i]);
        some.weight.push_back(samples.weight[i]);
    }
    return some;
}

}  // namespace

Smoothed smooth(const Samples& samples, const Stiffness& stiffness) {
    assert(!samples.at.empty());
    // Around 0 and in units of a typical deviation, so that the powers of ten mean something.
    const double unit = median(samples.deviation), middle = median(samples.value);
    Samples scaled = samples;
    for (double& value : scaled.value) value = (value - middle) / unit;
    for (double& deviation : scaled.deviation) deviation /= unit;
    for (std::size_t i = 0; i < scaled.told.size(); ++i)
        if (scaled.told[i]) scaled.deviation[i] = 1;

    Smoothed result;
    const int order = std::min(stiffness.order, static_cast<int>(samples.at.size()) - 1);
    if (order == 0) {
        result.value.assign(static_cast<std::size_t>(samples.count), samples.value.front());
        return result;
    }
    // A told place that lies off what is seen must not make the whole curve soft.
    const bool some_told =
        std::find(samples.told.begin(), samples.told.end(), true) != samples.told.end();
    const Samples judged = some_told ? seen(scaled) : scaled;
    const bool enough = std::ssize(judged.at) > order + 1;
    Curve free(enough ? judged : scaled, order);
    const double ratio =
        stiffness.variance_ratio > 0 ? stiffness.variance_ratio : std::pow(10, best_power(free));
    free.badness(ratio);
    result.noise = std::sqrt(free.variance());
    Curve curve(scaled, order);
    curve.badness(ratio);
    for (int i = 0; i < samples.count; ++i)
        result.value.push_back(middle + unit * curve.curve()[i]);
    return result;
}

}  // namespace chromeball
