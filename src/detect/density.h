#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace chromeball::detecting {

// Profiles of grey values along short lines across a rim, and Gaussian densities of them: what a
// rim at a certain place looks like is said by a covariance. Brightness and scale of a profile are
// free, so that neither counts.

constexpr int kSamples = 25;  ///< of a profile, half to either side of a first outline
constexpr int kHalf = kSamples / 2;

using Profile = std::array<float, kSamples>;
using Square = std::array<std::array<double, kSamples>, kSamples>;

/// Adds `variance` times the square of `row`; only the lower triangle is kept.
void add_square(Square& covariance, const std::array<double, kSamples>& row, double variance);
/// Adds another one, `times` over.
void add(Square& covariance, const Square& other, double times);

/// The inverse of the covariance's Cholesky factor, row by row, and the determinant's logarithm.
struct Density {
    std::array<float, kSamples * kSamples> whiten{};  ///< lower triangle
    double log_determinant = 0;
};

/// Noise of samples side by side is a little correlated, for they share pixels.
Density density_of(Square covariance, double noise);

/// Takes the mean away and makes the sum of squares 1, so that floats suffice; the likelihood does
/// not mind. False if a sample is not known.
bool normalise(Profile& profile);

/// Profiles side by side, sample by sample, so that one pass serves them all.
constexpr std::size_t kBatch = 16;
struct Batch {
    std::array<std::array<float, kBatch>, kSamples> samples{};

    void set(std::size_t at, const Profile& profile) {
        for (std::size_t k = 0; k < kSamples; ++k) samples[k][at] = profile[k];
    }
};

/// -2 log likelihood of each profile, its scale left free.
std::array<double, kBatch> cost_of(const Batch& batch, const Density& density);

}  // namespace chromeball::detecting
