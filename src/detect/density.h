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

using Profile = std::array<float, kSamples>;
using Square = std::array<std::array<double, kSamples>, kSamples>;

/// Adds `variance` times the square of `row`; only the lower triangle is kept.
void add_square(Square& covariance, const std::array<double, kSamples>& row, double variance);
/// Adds another one, `times` over.
void add(Square& covariance, const Square& other, double times);

/// The inverse of the covariance's Cholesky factor, row by row, and the determinant.
struct Density {
    std::array<float, kSamples * kSamples> whiten{};  ///< lower triangle
    float gain = 1;  ///< what the squared length of a whitened profile counts times, see Least
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

/// The least -2 log likelihood of each profile of a batch by several densities, its scale left
/// free.
///
/// That is n log(squares / n) + log(determinant), with n samples, so the least has the least
/// squares * determinant^(1 / n): one logarithm serves all densities.
class Least {
public:
    void take(const Batch& batch, const Density& density);
    std::array<float, kBatch> costs() const;

private:
    std::array<float, kBatch> squares_ = [] {
        std::array<float, kBatch> most;
        most.fill(std::numeric_limits<float>::max());
        return most;
    }();
};

}  // namespace chromeball::detecting
