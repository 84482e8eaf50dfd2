#include "detect/density.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace chromeball::detecting {
namespace {

constexpr double kNoiseCorrelation = 0.2;
constexpr double kFree = 300;  // variance of the brightness itself: far above all others

using Squares = std::array<float, kBatch>;
/// One value of each profile of a batch: GCC's and Clang's vectors, on any processor.
using Lanes [[gnu::vector_size(kBatch * sizeof(float))]] = float;

/// What each row of the whitening makes of the samples, squared. Rows side by side share the
/// samples and do not wait for each other's sums.
template <std::size_t N>
[[gnu::always_inline]] inline void whiten(const BatchOf<N>& batch, const DensityOf<N>& density,
                                          Lanes (&squares)[N]) {
    constexpr std::size_t kRows = 4;
    Lanes samples[N];
    std::memcpy(samples, batch.samples.data(), sizeof samples);
    const float* row = density.whiten.data();
    std::size_t i = 0;
    for (; i + kRows <= N; i += kRows) {
        const float* rows[kRows];
        for (std::size_t r = 0; r < kRows; ++r) rows[r] = row, row += i + r + 1;
        Lanes sums[kRows]{};
        for (std::size_t k = 0; k <= i; ++k)
            for (std::size_t r = 0; r < kRows; ++r) sums[r] += rows[r][k] * samples[k];
        for (std::size_t r = 1; r < kRows; ++r)
            for (std::size_t k = i + 1; k <= i + r; ++k) sums[r] += rows[r][k] * samples[k];
        for (std::size_t r = 0; r < kRows; ++r) squares[i + r] = sums[r] * sums[r];
    }
    for (; i < N; ++i) {
        Lanes sum{};
        for (std::size_t k = 0; k <= i; ++k) sum += row[k] * samples[k];
        row += i + 1;
        squares[i] = sum * sum;
    }
}

/// The squared length of each whitened profile.
struct Whitened {
    template <std::size_t N>
    [[gnu::always_inline]] static Squares of(const BatchOf<N>& batch, const DensityOf<N>& density) {
        Lanes squares[N];
        whiten(batch, density, squares);
        Lanes all{};
        for (std::size_t i = 0; i < N; ++i) all += squares[i];
        Squares result;
        std::memcpy(result.data(), &all, sizeof all);
        return result;
    }
};

/// Four at a time, for so many scales.
constexpr std::size_t kScales = 4;
constexpr float kScaleStep = 0.25f;  // of the variance
constexpr float kFreedom = 3;        // degrees of, in Student's distribution

using Whole [[gnu::vector_size(kBatch * sizeof(float))]] = std::int32_t;

/// Natural logarithms of m 2^e, with m above 0 and normal, to 1e-7.
[[gnu::always_inline]] inline void logarithm(const Lanes& m, const Whole& e, Lanes& log) {
    // m = n 2^f with n from sqrt(1/2) to sqrt(2); log n = 2 atanh s, as its series.
    constexpr std::int32_t kRootOfHalf = 0x3f3504f3;
    Whole bits;
    std::memcpy(&bits, &m, sizeof bits);
    bits -= kRootOfHalf;
    const Lanes exponents = __builtin_convertvector(e + (bits >> 23), Lanes);
    bits = (bits & 0x7fffff) + kRootOfHalf;
    Lanes n;
    std::memcpy(&n, &bits, sizeof n);
    const Lanes s = (n - 1) / (n + 1), q = s * s;
    log = exponents * 0.69314718f +
          2 * s * (1 + q * (1 / 3.f + q * (1 / 5.f + q * (1 / 7.f + q * (1 / 9.f)))));
}

/// -2 log likelihoods but for the density's own determinant.
struct RobustCosts {
    template <std::size_t N>
    [[gnu::always_inline]] static Squares of(const BatchOf<N>& batch, const DensityOf<N>& density) {
        // Of factors whose sum is N / kFreedom / kScaleStep^3 at most, so many stay below 2^100.
        constexpr std::size_t kFactors = 12;
        Lanes squares[N];
        whiten(batch, density, squares);
        Lanes all{};
        for (std::size_t i = 0; i < N; ++i) all += squares[i];
        Lanes variance = all / static_cast<float>(N) + 1e-30f;
        Lanes log_variance;
        logarithm(variance, Whole{}, log_variance);
        Lanes least{};
        for (std::size_t scale = 0; scale < kScales; ++scale) {
            // The logarithm of a product: exponents are summed, mantissas multiplied.
            const Lanes part = 1 / (kFreedom * variance);
            Lanes product = variance * 0 + 1;
            Whole exponents{};
            for (std::size_t i = 0; i < N; ++i) {
                product *= 1 + squares[i] * part;
                if (i % kFactors != kFactors - 1 || i + 1 == N) continue;
                Whole bits;
                std::memcpy(&bits, &product, sizeof bits);
                exponents += (bits >> 23) - 127;
                bits = (bits & 0x7fffff) | 0x3f800000;
                std::memcpy(&product, &bits, sizeof bits);
            }
            Lanes cost;
            logarithm(product, exponents, cost);
            cost = (kFreedom + 1) * cost + static_cast<float>(N) * log_variance;
            least = scale == 0 ? cost : (cost < least ? cost : least);
            variance *= kScaleStep;
            log_variance -= 2 * 0.69314718f;  // -log(kScaleStep)
        }
        Squares result;
        std::memcpy(result.data(), &least, sizeof least);
        return result;
    }
};

#if defined(__x86_64__) && defined(__GNUC__)
template <class Kernel, std::size_t N>
[[gnu::target("avx2")]] Squares by_8(const BatchOf<N>& batch, const DensityOf<N>& density) {
    return Kernel::of(batch, density);
}
template <class Kernel, std::size_t N>
[[gnu::target("avx512f")]] Squares by_16(const BatchOf<N>& batch, const DensityOf<N>& density) {
    return Kernel::of(batch, density);
}
#endif

/// Half of a search's time goes here, so there is a copy of a kernel for each width of
/// registers; the lanes do not meet, and products are not contracted (see CMakeLists.txt), so all
/// give the same bits.
template <class Kernel, std::size_t N>
Squares by_widest(const BatchOf<N>& batch, const DensityOf<N>& density) {
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx512f")) return by_16<Kernel>(batch, density);
    if (__builtin_cpu_supports("avx2")) return by_8<Kernel>(batch, density);
#endif
    return Kernel::of(batch, density);
}

}  // namespace

template <std::size_t N>
DensityOf<N> density_of(SquareOf<N> covariance, double noise) {
    for (std::size_t i = 0; i < N; ++i) {
        covariance[i][i] += noise;
        if (i > 0) covariance[i][i - 1] += kNoiseCorrelation * noise;
        for (std::size_t j = 0; j <= i; ++j) covariance[i][j] += kFree;
    }
    // Cholesky's factor, column by column, and the inverse of it, row by row. All inner loops run
    // along rows, so that processors take several steps at once.
    SquareOf<N> upper{}, inverse{};  // upper: the factor, transposed
    for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j <= i; ++j) upper[j][i] = covariance[i][j];
    for (std::size_t k = 0; k < N; ++k) {
        const double root = std::sqrt(std::max(upper[k][k], 1e-12)), part = 1 / root;
        for (std::size_t i = k; i < N; ++i) upper[k][i] *= part;
        upper[k][k] = root;
        for (std::size_t j = k + 1; j < N; ++j) {
            const double times = upper[k][j];
            for (std::size_t i = j; i < N; ++i) upper[j][i] -= times * upper[k][i];
        }
    }
    for (std::size_t i = 0; i < N; ++i) {
        auto& row = inverse[i];
        for (std::size_t k = 0; k < i; ++k) {
            const double times = upper[k][i];
            for (std::size_t j = 0; j <= k; ++j) row[j] -= times * inverse[k][j];
        }
        row[i] += 1;
        const double part = 1 / upper[i][i];
        for (std::size_t j = 0; j <= i; ++j) row[j] *= part;
    }
    DensityOf<N> density;
    double log_determinant = 0;
    for (std::size_t i = 0; i < N; ++i) {
        log_determinant += 2 * std::log(upper[i][i]);
        for (std::size_t j = 0; j <= i; ++j)
            density.whiten[i * (i + 1) / 2 + j] = static_cast<float>(inverse[i][j]);
    }
    density.gain = static_cast<float>(std::exp(log_determinant / N));
    return density;
}

template <std::size_t N>
bool normalise(ProfileOf<N>& profile) {
    double sum = 0, squares = 0;
    for (const float v : profile) sum += static_cast<double>(v);
    if (!std::isfinite(sum)) return false;
    for (float& v : profile) {
        v -= static_cast<float>(sum / N);
        squares += static_cast<double>(v * v);
    }
    const auto gain = static_cast<float>(1 / std::sqrt(squares + 1e-20));
    for (float& v : profile) v *= gain;
    return true;
}

template <std::size_t N>
void LeastOf<N>::take(const BatchOf<N>& batch, const DensityOf<N>& density) {
    const Squares squares = by_widest<Whitened>(batch, density);
    for (std::size_t r = 0; r < kBatch; ++r)
        squares_[r] = std::min(squares_[r], density.gain * squares[r]);
}

template <std::size_t N>
std::array<float, kBatch> LeastOf<N>::costs() const {
    std::array<float, kBatch> costs{};
    for (std::size_t r = 0; r < kBatch; ++r)
        costs[r] = static_cast<float>(N) * std::log(squares_[r] / N + 1e-30f);
    return costs;
}

template <std::size_t N>
void RobustLeastOf<N>::take(const BatchOf<N>& batch, const DensityOf<N>& density) {
    const Squares costs = by_widest<RobustCosts>(batch, density);
    const float own = static_cast<float>(N) * std::log(density.gain);
    for (std::size_t r = 0; r < kBatch; ++r) costs_[r] = std::min(costs_[r], costs[r] + own);
}

template DensityOf<kSamples> density_of(SquareOf<kSamples>, double);
template DensityOf<kManySamples> density_of(SquareOf<kManySamples>, double);
template bool normalise(ProfileOf<kSamples>&);
template bool normalise(ProfileOf<kManySamples>&);
template class LeastOf<kSamples>;
template class LeastOf<kManySamples>;
template class RobustLeastOf<kSamples>;
template class RobustLeastOf<kManySamples>;

}  // namespace chromeball::detecting
