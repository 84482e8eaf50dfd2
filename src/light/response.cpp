#include "light/response.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace chromeball {
namespace {

// A patch is as large as the blocks that JPEG works in.
constexpr int kPatch = 8;
// What lies beyond is too near to clipping or to black, as parts of white.
constexpr float kHighest = 0.92f;
constexpr float kLowestSteps = 4;  // stored numbers so near to 0 are rounding more than light

float srgb_light(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// Mean of a patch in one photo, NaN where it is not well shown.
std::array<float, 3> patch_mean(ImageView<const float> rows, int x, const ExposedPhoto& photo) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float white = std::isfinite(photo.white) ? static_cast<float>(photo.white)
                                                   : std::numeric_limits<float>::max();
    std::array<float, 3> mean{nan, nan, nan};
    for (int c = 0; c < 3; ++c) {
        float sum = 0, square = 0, most = 0;
        for (int y = 0; y < kPatch; ++y)
            for (int i = 0; i < kPatch; ++i) {
                const float v = rows.pixel(x + i, y)[c];
                sum += v, square += v * v, most = std::max(most, v);
            }
        constexpr float kCount = kPatch * kPatch;
        const float m = sum / kCount, variance = square / kCount - m * m;
        // Even: so little spread that the curve is straight across it.
        const float spread = 0.012f + 0.06f * m;
        const bool clipped = most > kHighest * white && most > 0;
        const bool black = !(m > kLowestSteps * static_cast<float>(photo.step) && m > 1e-6f);
        if (clipped || black || !(variance < spread * spread)) continue;
        mean[static_cast<std::size_t>(c)] = m;
    }
    return mean;
}

/// The patches of one row of them, in all photos.
std::vector<Patch> patches_of_row(std::span<const ExposedPhoto> photos, std::span<const V2d> shifts,
                                  int y) {
    const Size size = photos.front().size;
    const int count = size.width / kPatch;
    std::vector<Patch> patches(static_cast<std::size_t>(count));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (Patch& patch : patches) patch.stored.assign(photos.size(), {nan, nan, nan});
    Image rows({size.width, kPatch}, 3);
    for (std::size_t k = 0; k < photos.size(); ++k) {
        const int dx = static_cast<int>(std::lround(shifts[k].x));
        const int first = y + static_cast<int>(std::lround(shifts[k].y));
        if (first < 0 || first + kPatch > size.height) continue;
        photos[k].read(first, first + kPatch, rows.view());
        for (int i = 0; i < count; ++i) {
            const int x = i * kPatch + dx;
            if (x < 0 || x + kPatch > size.width) continue;
            patches[static_cast<std::size_t>(i)].stored[k] = patch_mean(rows.view(), x, photos[k]);
        }
    }
    std::erase_if(patches, [](const Patch& patch) {
        return std::ranges::count_if(patch.stored,
                                     [](const auto& s) { return std::isfinite(s[1]); }) < 2;
    });
    return patches;
}

/// How bright a patch is, whatever the photos' exposures: photos that clip it count as white.
double brightness(const Patch& patch) {
    double sum = 0, count = 0;
    for (const auto& stored : patch.stored)
        if (std::isfinite(stored[1])) sum += stored[1], count += 1;
    return sum / count;
}

/// Cubic B-splines on equal pieces of 0 to 1: which are not 0 there, and their values.
struct Splines {
    static constexpr int kPieces = 16;
    static constexpr int kCount = kPieces + 3;
    int first;
    std::array<double, 4> value;

    explicit Splines(double x) {
        const double at = std::clamp(x, 0.0, 1.0) * kPieces;
        first = std::min(static_cast<int>(at), kPieces - 1);
        const double t = at - first, s = 1 - t;
        value = {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                 (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
    }
};

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// A patch's channel in one photo.
struct Sight {
    int photo;
    double log_light;  ///< natural logarithm, by the assumed curve
    double sigma;      ///< its standard deviation
    double stored;
};
using Sights = std::vector<Sight>;  // of one patch and channel

using Told = std::vector<std::optional<double>>;  // log2 of exposures

std::vector<Sights> sights_of(std::span<const Patch> patches, std::span<const ExposedPhoto> photos,
                              const Response& assumed) {
    std::vector<Sights> all;
    for (const Patch& patch : patches)
        for (std::size_t c = 0; c < 3; ++c) {
            Sights sights;
            for (std::size_t k = 0; k < photos.size(); ++k) {
                const float z = patch.stored[k][c];
                if (!std::isfinite(z)) continue;
                const auto light = static_cast<double>(assumed.light(z));
                if (!(light > 0)) continue;
                // A patch has 64 pixels; JPEG makes their errors anything but independent.
                const auto slope = static_cast<double>(assumed.slope(z));
                const double relative =
                    std::sqrt(noise_variance(photos[k], light, slope)) / light / 4;
                sights.push_back({static_cast<int>(k), std::log(light), std::hypot(0.01, relative),
                                  static_cast<double>(z)});
            }
            if (sights.size() >= 2) all.push_back(std::move(sights));
        }
    return all;
}

/// One least-squares fit.
class Fit {
public:
    /// told: exposures that are held to
    Fit(std::span<const Sights> sights, std::span<const ExposedPhoto> photos, const Told& told,
        const Response& assumed, bool solve_curve)
        : sights_(sights), photos_(photos), told_(told), assumed_(assumed) {
        join();
        splines_ = solve_curve ? Splines::kCount : 0;
        count_ = splines_ + static_cast<int>(photos.size());
        unknown_ = Vector::Zero(count_);
        for (std::size_t k = 0; k < photos.size(); ++k)
            unknown_[splines_ + static_cast<int>(k)] = told[k].value_or(0) * kLn2;
    }

    BracketFit solve() {
        // Robustly: what is far off counts little, from the second time on.
        for (int i = 0; i < 12; ++i) step(i == 0);
        BracketFit fit;
        fit.patches = sights_.size();
        fit.rms_stops = rms();
        fit.response = response(fit.curve_stops);
        for (std::size_t k = 0; k < photos_.size(); ++k)
            fit.stops.push_back(told_[k] || joined_[k]
                                    ? std::optional(log_exposure(static_cast<int>(k)) / kLn2)
                                    : std::nullopt);
        return fit;
    }

private:
    static constexpr double kLn2 = 0.6931471805599453;
    static constexpr double kFarOff = 0.05;  ///< natural logarithm

    /// Which photos hang together: share enough patches, directly or through others, with one whose
    /// exposure is told, or where none is with the first.
    void join() {
        constexpr int kEnough = 12;
        const std::size_t n = photos_.size();
        std::vector<int> shared(n * n);
        for (const Sights& sights : sights_)
            for (const Sight& a : sights)
                for (const Sight& b : sights)
                    ++shared[static_cast<std::size_t>(a.photo) * n +
                             static_cast<std::size_t>(b.photo)];
        joined_.assign(n, false);
        const bool any = std::ranges::any_of(told_, [](const auto& t) { return t.has_value(); });
        // The photo that shares most, where none is told.
        std::size_t root = 0;
        int most = -1;
        for (std::size_t k = 0; k < n; ++k) {
            const auto row = shared.begin() + static_cast<std::ptrdiff_t>(k * n);
            const int sum = std::accumulate(row, row + static_cast<std::ptrdiff_t>(n), 0);
            if (sum > most) most = sum, root = k;
        }
        fixed_ = any ? -1 : static_cast<int>(root);
        for (std::size_t k = 0; k < n; ++k) joined_[k] = any ? told_[k].has_value() : k == root;
        for (bool changed = true; changed;) {
            changed = false;
            for (std::size_t a = 0; a < n; ++a)
                for (std::size_t b = 0; b < n; ++b)
                    if (joined_[a] && !joined_[b] && shared[a * n + b] >= kEnough)
                        joined_[b] = changed = true;
        }
    }

    double log_exposure(int photo) const { return unknown_[splines_ + photo]; }

    double correction(double stored) const {
        if (splines_ == 0) return 0;
        const Splines s(stored);
        double sum = 0;
        for (int i = 0; i < 4; ++i)
            sum += s.value[static_cast<std::size_t>(i)] * unknown_[s.first + i];
        return sum;
    }

    double log_radiance(const Sight& s) const {
        return s.log_light + correction(s.stored) - log_exposure(s.photo);
    }

    /// The weighted mean of what the photos say of a patch, and the weights as of now.
    double mean_of(const Sights& sights, std::vector<double>& weights, bool first) const {
        weights.clear();
        double sum = 0, total = 0;
        for (const Sight& s : sights) {
            weights.push_back(1 / (s.sigma * s.sigma));
            sum += weights.back() * log_radiance(s);
            total += weights.back();
        }
        if (first) return sum / total;
        const double middle = sum / total;
        sum = total = 0;
        for (std::size_t i = 0; i < sights.size(); ++i) {
            const double scale = std::hypot(kFarOff, 2 * sights[i].sigma);
            const double off = (log_radiance(sights[i]) - middle) / scale;
            weights[i] /= 1 + off * off;
            sum += weights[i] * log_radiance(sights[i]);
            total += weights[i];
        }
        return sum / total;
    }

    /// Least squares with each patch's own radiance eliminated, as of the weights now.
    void step(bool first) {
        Matrix normal = Matrix::Zero(count_, count_);
        Vector right = Vector::Zero(count_);
        std::vector<double> weights;
        Vector mean_row(count_), row(count_);
        for (const Sights& sights : sights_) {
            mean_of(sights, weights, first);
            // Sum of w a a^T less (sum w a)(sum w a)^T / sum w; the same of the right side.
            mean_row.setZero();
            double total = 0, mean = 0;
            for (std::size_t i = 0; i < sights.size(); ++i) {
                const Sight& s = sights[i];
                const double w = weights[i];
                std::array<int, 5> at;
                std::array<double, 5> value;
                const int used = row_of(s, at, value);
                for (int a = 0; a < used; ++a) {
                    mean_row[at[idx(a)]] += w * value[idx(a)];
                    right[at[idx(a)]] -= w * value[idx(a)] * s.log_light;
                    for (int b = 0; b < used; ++b)
                        normal(at[idx(a)], at[idx(b)]) += w * value[idx(a)] * value[idx(b)];
                }
                total += w;
                mean += w * s.log_light;
            }
            subtract(normal, right, mean_row, total, mean);
        }
        add_priors(normal, right);
        unknown_ = normal.ldlt().solve(right);
    }

    static std::size_t idx(int i) { return static_cast<std::size_t>(i); }

    /// Only the few that are not 0 matter.
    void subtract(Matrix& normal, Vector& right, const Vector& row, double total, double mean) {
        active_.clear();
        for (int a = 0; a < count_; ++a)
            if (row[a] != 0) active_.push_back(a);
        for (const int a : active_) {
            right[a] += row[a] * mean / total;
            for (const int b : active_) normal(a, b) -= row[a] * row[b] / total;
        }
    }

    int row_of(const Sight& s, std::array<int, 5>& at, std::array<double, 5>& value) const {
        int used = 0;
        if (splines_ > 0) {
            const Splines b(s.stored);
            for (int i = 0; i < 4; ++i, ++used) {
                at[idx(used)] = b.first + i;
                value[idx(used)] = b.value[idx(i)];
            }
        }
        at[idx(used)] = splines_ + s.photo;
        value[idx(used)] = -1;
        return used + 1;
    }

    void add_priors(Matrix& normal, Vector& right) const {
        for (std::size_t k = 0; k < photos_.size(); ++k) {
            const int at = splines_ + static_cast<int>(k);
            const bool held = told_[k] || static_cast<int>(k) == fixed_;
            const double weight = held ? 1e9 : 1e-6;
            const double wanted = told_[k].value_or(0) * kLn2;
            normal(at, at) += weight;
            right[at] += weight * wanted;
        }
        if (splines_ == 0) return;
        // Smooth: differences of differences are about that large, in natural logarithms.
        constexpr double kBend = 0.03;
        for (int i = 1; i + 1 < splines_; ++i) {
            const int at[] = {i - 1, i, i + 1};
            const double value[] = {1, -2, 1};
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b)
                    normal(at[a], at[b]) += value[a] * value[b] / (kBend * kBend);
        }
        // Nothing at the middle of the scale: a factor of all light is no part of a curve.
        const Splines middle(0.5);
        for (int a = 0; a < 4; ++a)
            for (int b = 0; b < 4; ++b)
                normal(middle.first + a, middle.first + b) +=
                    1e6 * middle.value[idx(a)] * middle.value[idx(b)];
        for (int i = 0; i < splines_; ++i) normal(i, i) += 1e-3;
    }

    /// Of what is not far off.
    double rms() const {
        std::vector<double> weights;
        double sum = 0, total = 0;
        for (const Sights& sights : sights_) {
            const double mean = mean_of(sights, weights, false);
            for (std::size_t i = 0; i < sights.size(); ++i) {
                const double off = log_radiance(sights[i]) - mean;
                sum += weights[i] * off * off;
                total += weights[i];
            }
        }
        return total > 0 ? std::sqrt(sum / total) / kLn2 : 0;
    }

    Response response(double& curve_stops) const {
        curve_stops = 0;
        if (splines_ == 0) return assumed_;
        constexpr int kNodes = 4 * 255 + 1;  // every 8-bit number is a node
        double lowest = 1, highest = 0;
        for (const Sights& sights : sights_)
            for (const Sight& s : sights) {
                lowest = std::min(lowest, s.stored);
                highest = std::max(highest, s.stored);
            }
        std::vector<float> nodes(kNodes);
        for (int i = 0; i < kNodes; ++i) {
            const double z = static_cast<double>(i) / (kNodes - 1);
            const double c = correction(std::clamp(z, lowest, highest));
            if (z >= lowest && z <= highest)
                curve_stops = std::max(curve_stops, std::abs(c) / kLn2);
            nodes[idx(i)] = static_cast<float>(
                static_cast<double>(assumed_.light(static_cast<float>(z))) * std::exp(c));
            if (i > 0) nodes[idx(i)] = std::max(nodes[idx(i)], nodes[idx(i - 1)]);
        }
        return Response(std::move(nodes));
    }

    std::span<const Sights> sights_;
    std::span<const ExposedPhoto> photos_;
    const Told& told_;
    const Response& assumed_;
    std::vector<bool> joined_;
    std::vector<int> active_;
    int fixed_ = -1;
    int splines_ = 0, count_ = 0;
    Vector unknown_;  ///< coefficients of the curve, then logarithms of exposures
};

/// A curve with the exposures that are told; without one told after the other, if that makes all
/// fit much better, since one wrong tag among several bends the curve.
BracketFit curve_fit(std::span<const Sights> sights, std::span<const ExposedPhoto> photos,
                     const Told& given, const Response& assumed) {
    constexpr double kMuchBetter = 0.6, kOff = 0.2;
    Told told = given;
    BracketFit fit = Fit(sights, photos, told, assumed, true).solve();
    for (auto left = std::ranges::count_if(told, [](const auto& t) { return !!t; }); left > 3;
         --left) {
        std::optional<std::size_t> wrong;
        BracketFit best = fit;
        for (std::size_t k = 0; k < told.size(); ++k) {
            if (!told[k]) continue;
            Told without = told;
            without[k].reset();
            const BracketFit one = Fit(sights, photos, without, assumed, true).solve();
            if (one.rms_stops < best.rms_stops && one.stops[k] &&
                std::abs(*one.stops[k] - *told[k]) > kOff)
                best = one, wrong = k;
        }
        if (!wrong || best.rms_stops > kMuchBetter * fit.rms_stops) break;
        told[*wrong].reset();
        fit = best;
    }
    return fit;
}

/// Adds what brings most exposures to what was told.
void on_told_scale(BracketFit& fit, const Told& told) {
    std::vector<double> off;
    for (std::size_t k = 0; k < told.size(); ++k)
        if (told[k] && fit.stops[k]) off.push_back(*told[k] - *fit.stops[k]);
    if (off.empty()) return;
    std::ranges::sort(off);
    const double median = 0.5 * (off[(off.size() - 1) / 2] + off[off.size() / 2]);
    for (std::size_t k = 0; k < told.size(); ++k) {
        if (fit.stops[k])
            *fit.stops[k] += median;
        else
            fit.stops[k] = told[k];  // nothing contradicts it
    }
}

}  // namespace

Response::Response(std::vector<float> nodes)
    : light_(std::move(nodes)), last_(static_cast<float>(light_.size() - 1)) {
    assert(light_.size() >= 2 && light_.back() > 0);
    const float top = light_.back();
    for (float& light : light_) light /= top;
}

Response Response::srgb() {
    constexpr int kNodes = 16 * 255 + 1;
    std::vector<float> nodes(kNodes);
    for (std::size_t i = 0; i < kNodes; ++i)
        nodes[i] = srgb_light(static_cast<float>(i) / (kNodes - 1));
    return Response(std::move(nodes));
}

std::vector<Patch> even_patches(std::span<const ExposedPhoto> photos, std::span<const V2d> shifts,
                                const Watch& watch) {
    assert(!photos.empty() && photos.size() == shifts.size());
    const int rows = photos.front().size.height / kPatch;
    std::vector<std::vector<Patch>> found(static_cast<std::size_t>(std::max(rows, 0)));
    for_each_band(
        rows, 8,
        [&](int first, int last) {
            for (int row = first; row < last; ++row)
                found[static_cast<std::size_t>(row)] = patches_of_row(photos, shifts, row * kPatch);
        },
        watch);
    // As many of each brightness as there are, up to a share: bright parts are rare and needed.
    constexpr int kBrightnesses = 48;
    constexpr std::size_t kShare = 64;
    std::vector<std::vector<Patch>> by_brightness(kBrightnesses);
    for (auto& row : found)
        for (Patch& patch : row) {
            const auto at =
                static_cast<std::size_t>(std::clamp(brightness(patch), 0.0, 0.999) * kBrightnesses);
            by_brightness[at].push_back(std::move(patch));
        }
    std::vector<Patch> chosen;
    for (auto& some : by_brightness) {
        const std::size_t count = std::min(kShare, some.size());
        for (std::size_t i = 0; i < count; ++i)  // from all over the picture
            chosen.push_back(std::move(some[i * some.size() / count]));
    }
    return chosen;
}

BracketFit fit_bracket(std::span<const Patch> patches, std::span<const ExposedPhoto> photos,
                       std::span<const std::optional<double>> told,
                       const BracketFitOptions& options) {
    assert(photos.size() == told.size());
    const Told as_told(told.begin(), told.end());
    const auto sights = sights_of(patches, photos, options.assumed);
    BracketFit fit;
    fit.response = options.assumed;
    if (options.solve_curve) fit = curve_fit(sights, photos, as_told, options.assumed);
    // With the curve as it is now nothing has to be held.
    const double curve_stops = fit.curve_stops;
    const auto seen = sights_of(patches, photos, fit.response);
    fit = Fit(seen, photos, Told(told.size()), fit.response, false).solve();
    fit.curve_stops = curve_stops;
    on_told_scale(fit, as_told);
    return fit;
}

}  // namespace chromeball
