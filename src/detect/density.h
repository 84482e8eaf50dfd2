#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace chromeball::detecting {

// Profiles of grey values along short lines across a rim, and Gaussian densities of them: what a
// rim at a certain place looks like is said by a covariance. Brightness and scale of a profile are
// free, so that neither counts.

constexpr int kSamples = 25;  ///< of a profile, half to either side of a first outline
constexpr int kHalf = kSamples / 2;
constexpr int kManySamples = 49;  ///< of one that is looked at closely

// With N samples, one of these two.
template <std::size_t N>
using ProfileOf = std::array<float, N>;
template <std::size_t N>
using SquareOf = std::array<std::array<double, N>, N>;
using Profile = ProfileOf<kSamples>;
using Square = SquareOf<kSamples>;

/// Adds `variance` times the square of `row`; only the lower triangle is kept.
template <std::size_t N>
void add_square(SquareOf<N>& covariance, const std::array<double, N>& row, double variance) {
    for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j <= i; ++j) covariance[i][j] += variance * row[i] * row[j];
}
/// Adds another one, `times` over.
template <std::size_t N>
void add(SquareOf<N>& covariance, const SquareOf<N>& other, double times) {
    for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j <= i; ++j) covariance[i][j] += times * other[i][j];
}

/// The inverse of the covariance's Cholesky factor, row by row, and the determinant.
template <std::size_t N>
struct DensityOf {
    std::array<float, N*(N + 1) / 2> whiten{};  ///< lower triangle
    float gain = 1;  ///< what the squared length of a whitened profile counts times, see Least
};
using Density = DensityOf<kSamples>;

/// Noise of samples side by side is a little correlated, for they share pixels.
template <std::size_t N>
DensityOf<N> density_of(SquareOf<N> covariance, double noise);

/// Takes the mean away and makes the sum of squares 1, so that floats suffice; the likelihood does
/// not mind. False if a sample is not known.
template <std::size_t N>
bool normalise(ProfileOf<N>& profile);

/// Profiles side by side, sample by sample, so that one pass serves them all.
constexpr std::size_t kBatch = 16;
template <std::size_t N>
struct BatchOf {
    std::array<std::array<float, kBatch>, N> samples{};

    void set(std::size_t at, const ProfileOf<N>& profile) {
        for (std::size_t k = 0; k < N; ++k) samples[k][at] = profile[k];
    }
};
using Batch = BatchOf<kSamples>;

/// The least -2 log likelihood of each profile of a batch by several densities, its scale left
/// free.
///
/// That is n log(squares / n) + log(determinant), with n samples, so the least has the least
/// squares * determinant^(1 / n): one logarithm serves all densities.
template <std::size_t N>
class LeastOf {
public:
    void take(const BatchOf<N>& batch, const DensityOf<N>& density);
    std::array<float, kBatch> costs() const;

private:
    std::array<float, kBatch> squares_ = [] {
        std::array<float, kBatch> most;
        most.fill(std::numeric_limits<float>::max());
        return most;
    }();
};
using Least = LeastOf<kSamples>;

/// The same by densities with long tails: what one sample holds beyond what those before it let
/// expect has Student's distribution, so that a lamp or a strong edge does not speak for the whole
/// profile. Of several scales, from that of a normal distribution down, the likeliest counts.
template <std::size_t N>
class RobustLeastOf {
public:
    void take(const BatchOf<N>& batch, const DensityOf<N>& density);
    const std::array<float, kBatch>& costs() const { return costs_; }

private:
    std::array<float, kBatch> costs_ = [] {
        std::array<float, kBatch> most;
        most.fill(std::numeric_limits<float>::max());
        return most;
    }();
};

}  // namespace chromeball::detecting
