#include "detect/edge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <vector>

#include "detect/density.h"

// Where exactly is the rim of a mirror? A step is not what it looks like. Outside lies the
// background; right inside the mirror shows, at grazing incidence, the same background, and from
// there on the world ever less compressed: at the depth d inside the rim of radius R the reflection
// has turned by 2 sqrt(2 d / R). One pixel inside a rim of 200 pixels that is 11 degrees already,
// as much as hundreds of pixels of background. So the rim is the place where a picture that hardly
// changes begins to change with the square root of the depth, and a detector of steps finds it too
// far inside.
//
// The likelihood of that is computed as it stands. Along a profile across the rim the world's light
// is taken as a random walk (natural pictures have about its spectrum) of the viewing direction:
// variance grows with the angle. That makes profiles Gaussian with a covariance that depends on
// where the rim is, on the blur and on the noise, but neither on the ball's size nor on the
// contrast, once depths are counted in samples and the profile's own scale is left free.

namespace chromeball::detecting {
namespace {

constexpr int kOffsets = 41;         // places tried for the rim,
constexpr double kOffsetStep = .25;  // samples apart
constexpr int kHalfOffsets = kOffsets / 2;

// Variances below are relative to that of the first sample inside, and were chosen on rendered
// plates so that the rim is found without bias there; the result does not depend on them much.

/// Of the mirror's own colour, dust, a near thing behind: a jump right at the rim.
constexpr double kJump = 1;
/// Sigma of the blur, samples. Where the lens is known, as dense as the rim's place asks for: of a
/// sharp picture a blur taken for 0.07 pixels wider than it is moves the rim by 0.15. Else the
/// first few: with two unknowns more in its shape, a part of a rim cannot tell its blur so finely
/// as well.
constexpr double kBlurs[] = {0.8, 1.2, 1.8, 2.6, 0.5, 0.6, 0.7, 1.0, 1.5, 2.2};
constexpr std::size_t kCoarseBlurs = 4;
/// Of the background's walk a sample, with the noise. The first is what geometry says of a distant
/// background, sqrt(R / 8) / focal length; the others are for textures and for noisy pictures.
struct Surroundings {
    double background;
    double noise;
};
constexpr Surroundings kSurroundings[] = {
    {1e-4, 1e-5}, {2e-3, 3e-4}, {1e-2, 1e-2}, {0.1, 0.2}, {0.5, 4}};

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

void add_step(Square& covariance, double at, double blur, double variance) {
    std::array<double, kSamples> step{};
    for (int k = 0; k < kSamples; ++k)
        step[static_cast<std::size_t>(k)] = normal_cdf((k - kHalf - at) / blur);
    add_square(covariance, step, variance);
}

/// Covariance of profiles whose rim lies at `rim`, in samples outwards: the part of the ball.
Square ball_covariance(double rim, double blur) {
    Square c{};
    const double reach = kHalf + 3 * blur + 1;
    add_step(c, rim, blur, kJump);
    // Increments of sqrt(depth), in finer steps where much happens.
    double depth = 0;
    while (rim - depth > -reach) {
        const double next = depth + (depth < 1 ? 0.125 : depth < 3 ? 0.25 : 0.5);
        add_step(c, rim - 0.5 * (depth + next), blur, std::sqrt(next) - std::sqrt(depth));
        depth = next;
    }
    return c;
}

/// The part of the background, for a walk of variance 1 a sample.
Square background_covariance(double rim, double blur) {
    Square c{};
    for (double at = rim + 0.25; at < kHalf + 3 * blur + 1; at += 0.5) add_step(c, at, blur, 0.5);
    return c;
}

/// All densities there are: they depend on nothing but the numbers above.
struct Bank {
    static constexpr std::size_t blurs = std::size(kBlurs), kinds = std::size(kSurroundings);
    std::vector<Density> rims;  ///< blur by blur, offset by offset, kind by kind
    std::vector<Density> none;  ///< profiles without a rim, kind by kind

    Bank() {
        for (const double blur : kBlurs)
            for (int o = 0; o < kOffsets; ++o) {
                const double rim = (o - kHalfOffsets) * kOffsetStep;
                const Square ball = ball_covariance(rim, blur);
                const Square back = background_covariance(rim, blur);
                for (const auto& [background, noise] : kSurroundings) {
                    Square all = ball;
                    add(all, back, background);
                    rims.push_back(density_of(all, noise));
                }
            }
        const Square all = background_covariance(-kHalf - 2, 1);
        for (const auto& [background, noise] : kSurroundings)
            none.push_back(density_of(all, noise));
    }
    const Density& rim(std::size_t blur, std::size_t kind, int offset) const {
        return rims[(blur * kOffsets + static_cast<std::size_t>(offset)) * kinds + kind];
    }
};

const Bank& bank() {
    static const Bank all;
    return all;
}

/// What each known ray says.
struct Voice {
    Ray ray;
    std::size_t index;
    std::array<float, kOffsets> cost;  ///< -2 log likelihood of a rim there
    float best;
    float without;  ///< of no rim at all
};

struct Profiles {
    std::vector<Ray> rays;
    std::vector<std::size_t> index;
    std::vector<Batch> batches;
};

template <class T, class Value>
Profiles profiles_of(const Raster<T>& picture, const Outline& outline, const EdgeSearch& search,
                     const Value& value) {
    // Sampled densely along the rim and averaged: the rim goes on there, noise does not.
    const double spacing = 2 * std::numbers::pi * std::sqrt(outline.a * outline.b) / search.rays;
    const int dense =
        std::max(1, static_cast<int>(std::lround(spacing / std::max(1.0, search.step))));
    const auto rays = rays_of(outline, search.rays * dense);
    const std::size_t count = rays.size();
    std::vector<Profile> all(count);
    for (std::size_t r = 0; r < count; ++r)
        for (int k = 0; k < kSamples; ++k) {
            const double d = (k - kHalf) * search.step;
            all[r][static_cast<std::size_t>(k)] =
                sample(picture, rays[r].x + d * rays[r].nx, rays[r].y + d * rays[r].ny, value);
        }
    std::vector<float> kernel;
    for (int i = -2 * dense; i <= 2 * dense; ++i)
        kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (double(dense) * dense))));
    const auto reach = static_cast<std::size_t>(2 * dense);
    float weight = 0;
    for (const float w : kernel) weight += w;
    Profiles profiles;
    for (std::size_t r = static_cast<std::size_t>(dense / 2); r < count;
         r += static_cast<std::size_t>(dense)) {
        Profile profile{};
        for (std::size_t i = 0; i < kernel.size(); ++i) {
            const auto& one = all[(r + count + i - reach) % count];
            for (std::size_t k = 0; k < kSamples; ++k) profile[k] += kernel[i] / weight * one[k];
        }
        if (!normalise(profile)) continue;
        const std::size_t at = profiles.rays.size() % kBatch;
        if (at == 0) profiles.batches.emplace_back();
        profiles.batches.back().set(at, profile);
        profiles.rays.push_back(rays[r]);
        profiles.index.push_back(r / static_cast<std::size_t>(dense));
    }
    return profiles;
}

constexpr float kFlat = 6;

/// Over all offsets, with the surroundings that fit each best.
std::vector<Voice> voices_of(const Profiles& profiles, std::size_t blur, std::size_t stride) {
    std::vector<Voice> voices;
    for (std::size_t b = 0; b < profiles.batches.size(); b += stride) {
        const std::size_t first = b * kBatch;
        const std::size_t count = std::min(kBatch, profiles.rays.size() - first);
        std::array<Voice, kBatch> here;
        const auto least = [&](const auto& density_of_kind) {
            Least all;
            for (std::size_t kind = 0; kind < Bank::kinds; ++kind)
                all.take(profiles.batches[b], density_of_kind(kind));
            return all.costs();
        };
        for (int o = 0; o < kOffsets; ++o) {
            const auto costs = least(
                [&](std::size_t kind) -> const Density& { return bank().rim(blur, kind, o); });
            for (std::size_t r = 0; r < count; ++r)
                here[r].cost[static_cast<std::size_t>(o)] = costs[r];
        }
        const auto none =
            least([&](std::size_t kind) -> const Density& { return bank().none[kind]; });
        for (std::size_t r = 0; r < count; ++r) here[r].without = none[r];
        for (std::size_t r = 0; r < count; ++r) {
            here[r].ray = profiles.rays[first + r];
            here[r].index = profiles.index[first + r];
            const auto best = std::min_element(here[r].cost.begin(), here[r].cost.end());
            here[r].best = *best;
            // Further out than the best there is nothing but a mirror that shows little for a
            // while: flat parts of the world are more common than a Gaussian walk has them.
            for (auto c = best; c != here[r].cost.end(); ++c)
                *c = *best + kFlat * std::log1p((*c - *best) / kFlat);
            voices.push_back(here[r]);
        }
    }
    return voices;
}

using Vector5 = cv::Matx<double, 5, 1>;
using Matrix5 = cv::Matx<double, 5, 5>;

Vector5 row_of(const Ray& ray, double radius) {
    return {ray.nx, ray.ny, 1, radius * ray.cos2, radius * ray.sin2};
}

/// Likelihood of an arc that shows something else (a stand, a hand), against its own best.
constexpr double kOutlier = 3e-4;

/// What one ray wants when the rim is expected at `where`, give or take `spread` (samples).
struct Wish {
    double pull;       ///< derivative of the log likelihood
    double stiffness;  ///< minus the second derivative, never negative
    double belonging;  ///< probability that the ray shows the rim
};

Wish wish_of(const Voice& voice, double where, double spread) {
    double sum = 0, first = 0, second = 0;
    for (int o = 0; o < kOffsets; ++o) {
        const double d = (o - kHalfOffsets) * kOffsetStep - where;
        const double z = d / spread;
        if (z * z > 16) continue;
        const double excess =
            static_cast<double>(voice.cost[static_cast<std::size_t>(o)] - voice.best);
        const double w = std::exp(-0.5 * (excess + z * z));
        sum += w, first += w * d, second += w * d * d;
    }
    const double norm = kOffsetStep / (spread * std::sqrt(2 * std::numbers::pi));
    const double belonging = sum * norm / (sum * norm + kOutlier);
    if (!(sum > 0)) return {0, 0, 0};
    const double mean = first / sum, variance = std::max(0.0, second / sum - mean * mean);
    const double precision = 1 / (spread * spread);
    return {belonging * mean * precision,
            belonging * precision * std::clamp(1 - variance * precision, 0.02, 1.0), belonging};
}

constexpr std::size_t kArcs = 36;
constexpr float kIndependent = 0.5f;  // of the rays of an arc: neighbours err alike

/// Rays side by side summed up: one alone drowns in noise, and what stands before the rim stands
/// before several.
struct Arc {
    Vector5 row;
    Voice voice;
};

std::vector<Arc> arcs_of(const std::vector<Voice>& voices, double radius, double step,
                         std::size_t rays) {
    std::vector<Arc> arcs;
    std::size_t last = kArcs;
    std::vector<std::size_t> counts;
    for (const Voice& v : voices) {
        const std::size_t at = v.index * kArcs / rays;
        if (at != last) {
            arcs.push_back({Vector5::zeros(), Voice{}});
            counts.push_back(0);
            last = at;
        }
        Arc& arc = arcs.back();
        arc.row += row_of(v.ray, radius) * (1 / step);
        for (std::size_t o = 0; o < kOffsets; ++o)
            arc.voice.cost[o] += kIndependent * (v.cost[o] - v.best);
        arc.voice.without += kIndependent * (v.without - v.best);
        ++counts.back();
    }
    for (std::size_t i = 0; i < arcs.size(); ++i) {
        arcs[i].row *= 1.0 / static_cast<double>(counts[i]);
        auto& c = arcs[i].voice.cost;
        arcs[i].voice.best = *std::min_element(c.begin(), c.end());
    }
    return arcs;
}

struct Settled {
    Vector5 change;
    Matrix5 covariance;
};

Settled settled(const std::vector<Arc>& arcs, const Shape& base, double step, const Lens& lens) {
    Settled now{Vector5::zeros(), Matrix5::zeros()};
    constexpr int kRounds = 14;
    for (int round = 0; round < kRounds; ++round) {
        const double spread = 1.5 * std::pow(0.1, std::min(1.0, round / (kRounds - 5.0)));
        Matrix5 h = Matrix5::eye() * 1e-9, discord = Matrix5::zeros();
        Vector5 g;
        for (const auto& [row, voice] : arcs) {
            const Wish wish = wish_of(voice, row.dot(now.change), spread);
            g += row * wish.pull;
            h += row * row.t() * wish.stiffness;
            discord += row * row.t() * (wish.pull * wish.pull);
        }
        const Vector5 c = now.change;
        const ShapePrior prior = prior_at(
            {base.x + c(0), base.y + c(1), base.radius + c(2), base.e1 + c(3), base.e2 + c(4)},
            lens);
        const double m1 = prior.e1 - base.e1 - c(3), m2 = prior.e2 - base.e2 - c(4);
        const Vector5 along{0, 0, 0, prior.cos2, prior.sin2};
        const Vector5 across{0, 0, 0, -prior.sin2, prior.cos2};
        const double p1 = 1 / (prior.along * prior.along), p2 = 1 / (prior.across * prior.across);
        g += along * (p1 * (prior.cos2 * m1 + prior.sin2 * m2));
        g += across * (p2 * (prior.cos2 * m2 - prior.sin2 * m1));
        h += along * along.t() * p1 + across * across.t() * p2;
        bool solved = false;
        const Matrix5 inverse = h.inv(cv::DECOMP_CHOLESKY, &solved);
        if (!solved) break;
        Vector5 move = inverse * g;
        // No further than a sample or two at a time: likelihoods are not parabolas.
        const double length = std::max({std::abs(move(0)), std::abs(move(1)), std::abs(move(2)),
                                        base.radius * std::hypot(move(3), move(4))});
        if (length > 1.5 * step) move *= 1.5 * step / length;
        now.change += move;
        // What the likelihood itself leaves open, and how much the arcs disagree about it.
        now.covariance = inverse + inverse * discord * inverse;
    }
    return now;
}

Shape moved(const Shape& base, const Vector5& c) {
    return {base.x + c(0), base.y + c(1), base.radius + c(2), base.e1 + c(3), base.e2 + c(4)};
}

ShapeCovariance array_of(const Matrix5& covariance) {
    ShapeCovariance array{};
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = 0; j < 5; ++j)
            array[i][j] = covariance(static_cast<int>(i), static_cast<int>(j));
    return array;
}

/// The blur that is known, or that a part of the rays finds most likely.
std::size_t likely_blur(const Profiles& profiles, const EdgeSearch& search, const Lens& lens) {
    std::size_t likely = 0;
    double least = 0;
    const std::size_t stride = std::max<std::size_t>(1, profiles.batches.size() / 5);
    const std::size_t count = lens.known ? Bank::blurs : kCoarseBlurs;
    for (std::size_t i = 0; i < count; ++i) {
        double cost = 0;
        if (search.blur > 0) {
            cost = std::abs(std::log(kBlurs[i] * search.step / search.blur));
        } else {
            for (const Voice& v : voices_of(profiles, i, stride))
                cost += static_cast<double>(std::min(0.f, v.best - v.without));
        }
        if (i == 0 || cost < least) least = cost, likely = i;
    }
    return likely;
}

template <class T, class Value>
EdgeFit fitted(const Raster<T>& picture, const Outline& start, const EdgeSearch& search,
               const Lens& lens, const Value& value) {
    EdgeFit fit;
    fit.outline = start;
    const Profiles profiles = profiles_of(picture, start, search, value);
    fit.known = double(profiles.rays.size()) / search.rays;
    if (profiles.rays.size() < 12) return fit;
    const Shape base = shape_of(start);
    const std::size_t blur = likely_blur(profiles, search, lens);
    fit.blur = kBlurs[blur] * search.step;
    const auto voices = voices_of(profiles, blur, 1);
    const auto arcs =
        arcs_of(voices, base.radius, search.step, static_cast<std::size_t>(search.rays));
    const Settled at = settled(arcs, base, search.step, lens);
    const Vector5 c = at.change;
    fit.outline = outline_of(moved(base, c));
    fit.covariance = array_of(at.covariance);
    if (!lens.known && lens.slack == 0) {
        const Settled free = settled(arcs, base, search.step, lens.forgotten());
        fit.free = FreeShape{moved(base, free.change), array_of(free.covariance)};
    }
    double clear = 0, evidence = 0;
    for (const Voice& voice : voices) {
        const Vector5 row = row_of(voice.ray, base.radius) * (1 / search.step);
        const double where = row.dot(c) / kOffsetStep + kHalfOffsets;
        const auto o =
            static_cast<std::size_t>(std::lround(std::clamp<double>(where, 0, kOffsets - 1)));
        const double gain = 0.5 * static_cast<double>(voice.without - voice.cost[o]);
        clear += gain > 2;
        evidence += std::clamp(gain, -5.0, 20.0);
    }
    fit.clear = clear / double(voices.size());
    fit.evidence = evidence / double(voices.size());
    return fit;
}

}  // namespace

EdgeFit fit_edge(const Raster<float>& picture, const Outline& start, const EdgeSearch& search,
                 const Lens& lens) {
    return fitted(picture, start, search, lens, [](float v) { return v; });
}

EdgeFit fit_edge(const Grey& picture, const Outline& start, const EdgeSearch& search,
                 const Lens& lens) {
    return fitted(picture.pixels, start, search, lens,
                  [](std::uint16_t code) { return static_cast<float>(code) * (1 / 65535.f); });
}

}  // namespace chromeball::detecting
