#include "light/rotation_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/parallel.h"
#include "core/statistics.h"
#include "map/cube.h"

namespace chromeball {
namespace {

using std::numbers::pi;
constexpr double kStep = 5 * pi / 180;
/// Two guesses nearer to each other than that lead to the same rotation.
constexpr double kApart = 8 * pi / 180;

using Samples = std::vector<ViewPyramid::Sample>;

/// What is far from a view's usual light is drawn to it, so that a few parts of the sphere (lamps,
/// the photographer) do not outweigh all others.
void bound(Samples& samples) {
    constexpr double kMost = 2;  // standard deviations, were they Gaussian
    for (int c = 0; c < 3; ++c) {
        std::vector<double> values;
        for (const auto& sample : samples)
            if (sample.weight > 0) values.push_back(static_cast<double>(sample.value[c]));
        const double middle = median(values);
        for (double& value : values) value = std::abs(value - middle);
        const double far = kMost * 1.4826 * median(std::move(values));
        const auto low = static_cast<float>(middle - far), high = static_cast<float>(middle + far);
        for (auto& sample : samples) sample.value[c] = std::clamp(sample.value[c], low, high);
    }
}

/// A view looked up by direction without trigonometry.
class Table {
public:
    explicit Table(const ViewPyramid& view) {
        std::vector<V3d> directions;
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x)
                    directions.push_back(cube_.direction_on(face, 2 * (x + 0.5) / kSize - 1,
                                                            2 * (y + 0.5) / kSize - 1));
        samples_.resize(directions.size());
        view.sample(directions, {}, kStep, samples_);
        bound(samples_);
    }
    const ViewPyramid::Sample& at(V3d d) const {
        const int face = face_of(d);
        const V2d ab = cube_.coordinates_on(face, d);
        const auto cell = [](double a) {
            return std::clamp(static_cast<int>(0.5 * kSize * (a + 1)), 0, kSize - 1);
        };
        return samples_[static_cast<std::size_t>((face * kSize + cell(ab.y)) * kSize + cell(ab.x))];
    }

private:
    static constexpr int kSize = 32;  // 2.8 degrees
    Cube cube_;
    Samples samples_;
};

/// Sums for a correlation of weighted pairs of values.
struct Correlation {
    double w = 0, a[3] = {}, b[3] = {}, aa = 0, bb = 0, ab = 0;

    void add(const ViewPyramid::Sample& p, const ViewPyramid::Sample& q) {
        const double weight = static_cast<double>(p.weight) * static_cast<double>(q.weight);
        if (!(weight > 0)) return;
        w += weight;
        for (int c = 0; c < 3; ++c) {
            const auto x = static_cast<double>(p.value[c]), y = static_cast<double>(q.value[c]);
            a[c] += weight * x;
            b[c] += weight * y;
            aa += weight * x * x;
            bb += weight * y * y;
            ab += weight * x * y;
        }
    }
    double value() const {
        if (!(w > 0)) return -1;
        double vaa = aa, vbb = bb, vab = ab;
        for (int c = 0; c < 3; ++c) {
            vaa -= a[c] * a[c] / w;
            vbb -= b[c] * b[c] / w;
            vab -= a[c] * b[c] / w;
        }
        const double scale = std::sqrt(std::max(vaa, 0.0) * std::max(vbb, 0.0));
        return scale > 1e-12 * w ? vab / scale : -1;
    }
};

/// Takes +Z to an axis and turns about it.
Rotation about_axis(V3d axis, double turn) {
    const double lon = std::atan2(axis.x, axis.z) * 180 / pi;
    const double lat = std::asin(std::clamp(axis.y, -1.0, 1.0)) * 180 / pi;
    return Rotation::about_y(lon) * Rotation::about_x(-lat) * Rotation::about_z(turn * 180 / pi);
}

}  // namespace

double angle_between(const Rotation& a, const Rotation& b) {
    const Rotation d = a * b.inverse();
    return std::acos(std::clamp(0.5 * (d.at(0, 0) + d.at(1, 1) + d.at(2, 2) - 1), -1.0, 1.0));
}

double likeness(std::span<const ViewPyramid::Sample> a, std::span<const ViewPyramid::Sample> b) {
    std::vector<std::size_t> shared;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i].weight > 0 && b[i].weight > 0) shared.push_back(i);
    constexpr std::size_t kLeast = 40;
    if (shared.size() < kLeast) return -1;
    /// All pairs' differences, less their channel's median, and weights.
    struct Differences {
        std::vector<double> size, weight;

        double usual() const { return median(size); }
        /// Their mean, none larger than that.
        double mean(double most) const {
            double sum = 0, total = 0;
            for (std::size_t i = 0; i < size.size(); ++i) {
                sum += weight[i] * std::min(size[i], most);
                total += weight[i];
            }
            return sum / total;
        }
    };
    const auto paired = [&](std::size_t ahead) {
        Differences all;
        std::vector<double> one(shared.size());
        for (int c = 0; c < 3; ++c) {
            for (std::size_t k = 0; k < shared.size(); ++k)
                one[k] = static_cast<double>(a[shared[k]].value[c] -
                                             b[shared[(k + ahead) % shared.size()]].value[c]);
            const double middle = median(one);
            for (std::size_t k = 0; k < shared.size(); ++k) {
                all.size.push_back(std::abs(one[k] - middle));
                all.weight.push_back(
                    std::sqrt(static_cast<double>(a[shared[k]].weight) *
                              static_cast<double>(b[shared[(k + ahead) % shared.size()]].weight)));
            }
        }
        return all;
    };
    const Differences here = paired(0);
    // Any other pairing does; those far along the list are far apart on the sphere.
    const Differences elsewhere = paired(shared.size() * 2 / 5);
    constexpr double kNoise = 0.05;  // stops
    const double most = std::max(elsewhere.usual(), kNoise);
    const double usual = elsewhere.mean(most);
    return usual > 0 ? 1 - here.mean(most) / usual : -1;
}

std::vector<Rotation> likely_rotations(const ViewPyramid& fixed, const ViewPyramid& free, int most,
                                       const Watch& watch) {
    const Table table(fixed);
    const auto directions = fibonacci_directions(600);
    Samples samples(directions.size());
    free.sample(directions, {}, kStep, samples);
    bound(samples);

    const auto axes = fibonacci_directions(static_cast<int>(4 * pi / (kStep * kStep)));
    const int turns = static_cast<int>(2 * pi / kStep);
    const auto rotation = [&](std::size_t index) {
        return about_axis(axes[index / static_cast<std::size_t>(turns)],
                          static_cast<double>(index % static_cast<std::size_t>(turns)) * kStep);
    };
    std::vector<float> scores(axes.size() * static_cast<std::size_t>(turns));
    std::vector<std::size_t> order(scores.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    // A few directions tell which rotations are worth a closer look.
    struct Round {
        std::size_t stride, keep;
    };
    for (const auto& [stride, keep] : {Round{4, scores.size() / 8}, Round{1, 1500}}) {
        for_each_band(
            static_cast<int>(order.size()), 512,
            [&](int first, int last) {
                for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last);
                     ++i) {
                    const Rotation r = rotation(order[i]);
                    Correlation sum;
                    for (std::size_t k = 0; k < directions.size(); k += stride)
                        if (samples[k].weight > 0) sum.add(samples[k], table.at(r * directions[k]));
                    scores[order[i]] = static_cast<float>(sum.value());
                }
            },
            watch);
        const std::size_t kept = std::min(order.size(), keep);
        std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept),
                          order.end(), [&](std::size_t a, std::size_t b) {
                              return scores[a] != scores[b] ? scores[a] > scores[b] : a < b;
                          });
        order.resize(kept);
    }
    // What only one of them shows must not decide which are the best.
    for_each_band(
        static_cast<int>(order.size()), 64,
        [&](int first, int last) {
            Samples turned(directions.size());
            for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last);
                 ++i) {
                const Rotation r = rotation(order[i]);
                for (std::size_t k = 0; k < directions.size(); ++k)
                    turned[k] = table.at(r * directions[k]);
                scores[order[i]] = static_cast<float>(likeness(samples, turned));
            }
        },
        watch);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return scores[a] != scores[b] ? scores[a] > scores[b] : a < b;
    });
    std::vector<Rotation> likely;
    for (std::size_t i = 0; i < order.size() && static_cast<int>(likely.size()) < most; ++i) {
        const Rotation r = rotation(order[i]);
        if (std::all_of(likely.begin(), likely.end(),
                        [&](const Rotation& other) { return angle_between(r, other) > kApart; }))
            likely.push_back(r);
    }
    return likely;
}

}  // namespace chromeball
