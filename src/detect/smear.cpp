#include "detect/smear.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

namespace chromeball::detecting {
namespace {

/// Between places tried, samples.
template <std::size_t N>
constexpr double kPlaceStep = N == kManySamples ? 1 : 0.5;

// Of the profiles along the motion lengths are a geometric row.
constexpr double kLongest = 10.5, kRatio = 1.06;
constexpr int kNodes = 48;  // down to 0.7 samples
// Of those beside it, they are these: 1/2, 1, 3/2, 2, 3, ...
constexpr std::array<double, BesideVoice::kLengths> kBesideLengths{0.5, 1, 1.5, 2, 3, 4, 5, 6};

// Variances are relative to that of the light right at the rim and a sample inside, as in edge.cpp.
// The step at the rim itself is the smaller part: a mirror that is seen at a grazing angle shows
// what lies right behind it.
constexpr double kJump = 0.5;
struct Surroundings {
    double background;
    double noise;
    double grain;  ///< noise of the ball alone, in proportion to its part of the light
};
// Grain is what the model's lines do not hold: detail finer than samples, and in rendered pictures
// that each pixel saw but a few instants, so that the ball is noisy as far out as it ever was.
// Which kinds, and which jump, give the true rim's place on profiles the most likelihood was found
// on painted pictures, grainy and not.
constexpr std::array<Surroundings, 7> kSurroundings{{{1e-4, 1e-3, 0},
                                                     {3e-3, 1e-3, 0},
                                                     {3e-3, 0.1, 0},
                                                     {0.1, 1e-2, 0},
                                                     {1e-4, 1e-4, 1e-2},
                                                     {1e-4, 1e-4, 0.1},
                                                     {3e-3, 1e-3, 0.1}}};
constexpr std::array<double, 4> kNoises{1e-4, 1e-3, 3e-2, 0.3};  // where there is no rim

template <std::size_t N>
constexpr double kMiddle = static_cast<double>(N / 2);
/// Sigma of the blur, samples: fine profiles are of pixels that are sharper than their samples.
template <std::size_t N>
constexpr double kBlur = N == kManySamples ? 0.5 : 0.7;

/// Part of the exposure during which each sample lies inside of `at`, softened by the blur.
template <std::size_t N>
std::array<double, N> covered(double at, double half_motion) {
    constexpr std::array<double, 5> kShifts{-2, -1, 0, 1, 2};
    std::array<double, N> part{};
    double all = 0;
    for (const double shift : kShifts) {
        const double weight = std::exp(-0.5 * shift * shift);
        all += weight;
        for (std::size_t k = 0; k < N; ++k) {
            const double inside = at - (static_cast<double>(k) - kMiddle<N>)+shift * kBlur<N>;
            part[k] += weight * std::clamp((inside + half_motion) / (2 * half_motion), 0.0, 1.0);
        }
    }
    for (double& p : part) p /= all;
    return part;
}

/// The ball's part of the covariance: a walk in the square root of the depth.
template <std::size_t N>
SquareOf<N> ball_covariance(double rim, double half_motion) {
    SquareOf<N> c{};
    add_square(c, covered<N>(rim, half_motion), kJump);
    double depth = 0;
    while (rim - depth > -kMiddle<N> - half_motion - 1) {
        const double next = depth + (depth < 1 ? 0.25 : depth < 3 ? 0.5 : 1);
        add_square(c, covered<N>(rim - 0.5 * (depth + next), half_motion),
                   std::sqrt(next) - std::sqrt(depth));
        depth = next;
    }
    return c;
}

/// A ball that fills the profile: an even walk.
template <std::size_t N>
SquareOf<N> moving_covariance(double half_motion) {
    SquareOf<N> c{};
    const double reach = kMiddle<N> + half_motion + 1;
    for (double at = -reach; at < reach + 1; ++at) add_square(c, covered<N>(at, half_motion), 1);
    return c;
}

/// The background's, a walk of variance 1 a sample away from the rim, as far as it shows.
template <std::size_t N>
SquareOf<N> background_covariance(double rim, const std::array<double, N>& ball) {
    SquareOf<N> c{};
    for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            const double a = static_cast<double>(i) - kMiddle<N> - rim;
            const double b = static_cast<double>(j) - kMiddle<N> - rim;
            if ((a < 0) == (b < 0))
                c[i][j] = std::min(std::abs(a), std::abs(b)) * (1 - ball[i]) * (1 - ball[j]);
        }
    return c;
}

/// The densities of one length: place by place, kind by kind.
template <std::size_t N>
std::vector<DensityOf<N>> rims_of(double half_motion, int places) {
    std::vector<DensityOf<N>> rims;
    for (int place = 0; place < places; ++place) {
        const double rim = (place - places / 2) * kPlaceStep<N>;
        const std::array<double, N> part = covered<N>(rim, half_motion);
        const SquareOf<N> ball = ball_covariance<N>(rim, half_motion);
        const SquareOf<N> back = background_covariance<N>(rim, part);
        for (const auto& [background, noise, grain] : kSurroundings) {
            SquareOf<N> all = ball;
            add(all, back, background);
            for (std::size_t k = 0; k < N; ++k) all[k][k] += grain * part[k];
            rims.push_back(density_of<N>(all, noise));
        }
    }
    return rims;
}

double length_at(int k) { return kLongest * std::pow(kRatio, -k); }
double index_of(double length) {
    return std::clamp(std::log(kLongest / std::max(length, 1e-3)) / std::log(kRatio), 0.0,
                      kNodes - 1.0);
}

/// All of one length, along the motion.
struct Node {
    std::vector<DensityOf<kManySamples>> rims, moving;

    explicit Node(double half_motion)
        : rims(rims_of<kManySamples>(half_motion, SmearVoice::kPlaces)) {
        const auto all = moving_covariance<kManySamples>(half_motion);
        for (const double noise : kNoises) moving.push_back(density_of<kManySamples>(all, noise));
    }
};

/// They depend on nothing but the numbers above; made when first asked for, for each takes
/// milliseconds.
const Node& node(int k) {
    static std::array<std::once_flag, kNodes> flags;
    static std::array<std::unique_ptr<const Node>, kNodes> nodes;
    const auto i = static_cast<std::size_t>(k);
    std::call_once(flags[i], [&] { nodes[i] = std::make_unique<const Node>(length_at(k)); });
    return *nodes[i];
}

const std::vector<DensityOf<kManySamples>>& still() {
    static const auto all = [] {
        std::vector<DensityOf<kManySamples>> densities;
        const auto walk = background_covariance<kManySamples>(-kMiddle<kManySamples> - 2, {});
        for (const double noise : kNoises)
            densities.push_back(density_of<kManySamples>(walk, noise));
        return densities;
    }();
    return all;
}

const std::vector<Density>& beside() {
    static const auto all = [] {
        std::vector<Density> densities;
        for (const double length : kBesideLengths)
            for (const Density& d : rims_of<kSamples>(length, BesideVoice::kPlaces))
                densities.push_back(d);
        return densities;
    }();
    return all;
}

template <std::size_t N>
std::vector<BatchOf<N>> batches_of(const std::vector<ProfileOf<N>>& profiles) {
    std::vector<BatchOf<N>> batches((profiles.size() + kBatch - 1) / kBatch);
    for (std::size_t r = 0; r < profiles.size(); ++r)
        batches[r / kBatch].set(r % kBatch, profiles[r]);
    return batches;
}

/// The costs of the likeliest of some densities, profile by profile. A density at a time for all
/// profiles: those stay in the cache.
template <std::size_t N>
std::vector<float> least_costs(const std::vector<BatchOf<N>>& batches,
                               const DensityOf<N>* densities, std::size_t count) {
    std::vector<RobustLeastOf<N>> least(batches.size());
    for (std::size_t d = 0; d < count; ++d)
        for (std::size_t b = 0; b < batches.size(); ++b) least[b].take(batches[b], densities[d]);
    std::vector<float> costs;
    for (const RobustLeastOf<N>& l : least)
        costs.insert(costs.end(), l.costs().begin(), l.costs().end());
    return costs;
}

/// Through b and c, with the slopes of their neighbours; Catmull and Rom.
double cubic(double a, double b, double c, double d, double u) {
    return b + 0.5 * u * (c - a + u * (2 * a - 5 * b + 4 * c - d + u * (3 * (b - c) + d - a)));
}

/// At row l and place p of a table, both clamped to it.
template <int kRows, int kColumns, std::size_t kCount>
double in_between(const std::array<float, kCount>& table, double row, double column) {
    const double l = std::clamp(row, 0.0, kRows - 1.001);
    const double p = std::clamp(column, 0.0, kColumns - 1.001);
    const int i = static_cast<int>(l), j = static_cast<int>(p);
    const auto value = [&](int at, int place) {
        return static_cast<double>(table[static_cast<std::size_t>(
            std::clamp(at, 0, kRows - 1) * kColumns + std::clamp(place, 0, kColumns - 1))]);
    };
    std::array<double, 4> rows{};
    for (int k = 0; k < 4; ++k)
        rows[static_cast<std::size_t>(k)] =
            cubic(value(i - 1 + k, j - 1), value(i - 1 + k, j), value(i - 1 + k, j + 1),
                  value(i - 1 + k, j + 2), p - j);
    return cubic(rows[0], rows[1], rows[2], rows[3], l - i);
}

/// The mean over places of a likelihood to a power, 1 where it is greatest.
template <class Voice>
double mean_likelihood(const Voice& voice, double half_motion, double power, double step) {
    double sum = 0;
    for (int k = 0; k < Voice::kPlaces; ++k)
        sum += std::exp(-0.5 * power * voice.cost(half_motion, (k - Voice::kPlaces / 2) * step));
    return sum / Voice::kPlaces;
}

}  // namespace

double SmearVoice::cost(double half_motion, double place) const {
    return in_between<kLengths, kPlaces>(costs_, index_of(half_motion) - first_,
                                         place / kPlaceStep<kManySamples> + kPlaces / 2);
}

double BesideVoice::cost(double half_motion, double place) const {
    const double row = half_motion < 2 ? 2 * half_motion - 1 : half_motion + 1;
    return in_between<kLengths, kPlaces>(costs_, row, place / kPlaceStep<kSamples> + kPlaces / 2);
}

double SmearVoice::openness(double half_motion, double power) const {
    return mean_likelihood(*this, half_motion, power, kPlaceStep<kManySamples>);
}

double BesideVoice::openness(double half_motion, double power) const {
    return mean_likelihood(*this, half_motion, power, kPlaceStep<kSamples>);
}

std::vector<SmearVoice> smear_voices(const std::vector<ProfileOf<kManySamples>>& profiles,
                                     double half_motion) {
    const auto batches = batches_of(profiles);
    const int middle = static_cast<int>(std::lround(index_of(half_motion)));
    const int first =
        std::clamp(middle - SmearVoice::kLengths / 2, 0, kNodes - SmearVoice::kLengths);
    std::vector<SmearVoice> voices(profiles.size());
    for (int l = 0; l < SmearVoice::kLengths; ++l)
        for (int place = 0; place < SmearVoice::kPlaces; ++place) {
            const auto at = static_cast<std::size_t>(l * SmearVoice::kPlaces + place);
            const auto* densities = node(first + l).rims.data() +
                                    static_cast<std::size_t>(place) * kSurroundings.size();
            const auto costs = least_costs(batches, densities, kSurroundings.size());
            for (std::size_t r = 0; r < voices.size(); ++r) voices[r].costs_[at] = costs[r];
        }
    const Node& likely = node(first + SmearVoice::kLengths / 2);
    const auto moving = least_costs(batches, likely.moving.data(), likely.moving.size());
    const auto standing = least_costs(batches, still().data(), still().size());
    for (std::size_t r = 0; r < voices.size(); ++r) {
        SmearVoice& v = voices[r];
        const float best = *std::min_element(v.costs_.begin(), v.costs_.end());
        for (float& cost : v.costs_) cost -= best;
        v.first_ = first, v.moving_ = moving[r] - best, v.still_ = standing[r] - best;
    }
    return voices;
}

std::vector<BesideVoice> beside_voices(const std::vector<Profile>& profiles) {
    const auto batches = batches_of(profiles);
    std::vector<BesideVoice> voices(profiles.size());
    constexpr std::size_t kinds = kSurroundings.size();
    for (std::size_t at = 0; at < std::tuple_size_v<decltype(BesideVoice::costs_)>; ++at) {
        const auto costs = least_costs(batches, beside().data() + at * kinds, kinds);
        for (std::size_t r = 0; r < voices.size(); ++r) voices[r].costs_[at] = costs[r];
    }
    for (BesideVoice& v : voices) {
        const float best = *std::min_element(v.costs_.begin(), v.costs_.end());
        for (float& cost : v.costs_) cost -= best;
    }
    return voices;
}

}  // namespace chromeball::detecting
