#include "detect/density.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace chromeball::detecting {
namespace {

constexpr double kNoiseCorrelation = 0.2;
constexpr double kFree = 300;  // variance of the brightness itself: far above all others

using Squares = std::array<float, kBatch>;
/// One value of each profile of a batch: GCC's and Clang's vectors, on any processor.
using Lanes [[gnu::vector_size(kBatch * sizeof(float))]] = float;

/// The squared length of each whitened profile. A third of the search's time goes here, so there
/// is a copy for each width of registers; the lanes do not meet, and products are not contracted
/// (see CMakeLists.txt), so all give the same bits.
[[gnu::always_inline]] inline Squares whitened(const Batch& batch, const Density& density) {
    Lanes samples[kSamples];
    std::memcpy(samples, batch.samples.data(), sizeof samples);
    Lanes squares{};
    for (std::size_t i = 0; i < kSamples; ++i) {
        Lanes sum{};
        const float* row = density.whiten.data() + i * kSamples;
        for (std::size_t k = 0; k <= i; ++k) sum += row[k] * samples[k];
        squares += sum * sum;
    }
    Squares result;
    std::memcpy(result.data(), &squares, sizeof squares);
    return result;
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2")]] Squares whitened_by_8(const Batch& batch, const Density& density) {
    return whitened(batch, density);
}
[[gnu::target("avx512f")]] Squares whitened_by_16(const Batch& batch, const Density& density) {
    return whitened(batch, density);
}
Squares squares_of(const Batch& batch, const Density& density) {
    if (__builtin_cpu_supports("avx512f")) return whitened_by_16(batch, density);
    if (__builtin_cpu_supports("avx2")) return whitened_by_8(batch, density);
    return whitened(batch, density);
}
#else
Squares squares_of(const Batch& batch, const Density& density) { return whitened(batch, density); }
#endif

}  // namespace

void add_square(Square& covariance, const std::array<double, kSamples>& row, double variance) {
    for (std::size_t i = 0; i < kSamples; ++i)
        for (std::size_t j = 0; j <= i; ++j) covariance[i][j] += variance * row[i] * row[j];
}

void add(Square& covariance, const Square& other, double times) {
    for (std::size_t i = 0; i < kSamples; ++i)
        for (std::size_t j = 0; j <= i; ++j) covariance[i][j] += times * other[i][j];
}

Density density_of(Square covariance, double noise) {
    Square factor{}, inverse{};
    for (std::size_t i = 0; i < kSamples; ++i) {
        covariance[i][i] += noise;
        if (i > 0) covariance[i][i - 1] += kNoiseCorrelation * noise;
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = covariance[i][j] + kFree;
            for (std::size_t k = 0; k < j; ++k) sum -= factor[i][k] * factor[j][k];
            factor[i][j] = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / factor[j][j];
        }
    }
    for (std::size_t column = 0; column < kSamples; ++column)
        for (std::size_t i = column; i < kSamples; ++i) {
            double sum = i == column ? 1 : 0;
            for (std::size_t k = column; k < i; ++k) sum -= factor[i][k] * inverse[k][column];
            inverse[i][column] = sum / factor[i][i];
        }
    Density density;
    double log_determinant = 0;
    for (std::size_t i = 0; i < kSamples; ++i) {
        log_determinant += 2 * std::log(factor[i][i]);
        for (std::size_t j = 0; j <= i; ++j)
            density.whiten[i * kSamples + j] = static_cast<float>(inverse[i][j]);
    }
    density.gain = static_cast<float>(std::exp(log_determinant / kSamples));
    return density;
}

bool normalise(Profile& profile) {
    double sum = 0, squares = 0;
    for (const float v : profile) sum += static_cast<double>(v);
    if (std::isnan(sum)) return false;
    for (float& v : profile) {
        v -= static_cast<float>(sum / kSamples);
        squares += static_cast<double>(v * v);
    }
    const auto gain = static_cast<float>(1 / std::sqrt(squares + 1e-20));
    for (float& v : profile) v *= gain;
    return true;
}

void Least::take(const Batch& batch, const Density& density) {
    const Squares squares = squares_of(batch, density);
    for (std::size_t r = 0; r < kBatch; ++r)
        squares_[r] = std::min(squares_[r], density.gain * squares[r]);
}

std::array<float, kBatch> Least::costs() const {
    std::array<float, kBatch> costs{};
    for (std::size_t r = 0; r < kBatch; ++r)
        costs[r] = kSamples * std::log(squares_[r] / kSamples + 1e-30f);
    return costs;
}

}  // namespace chromeball::detecting
