#include "light/align.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/luminance.h"
#include "core/parallel.h"
#include "core/statistics.h"

namespace chromeball {
namespace {

/// What is compared: the light's logarithm, and how much it is worth (one over its variance; 0
/// where it is clipped, black or outside).
struct Raster {
    Size size;
    std::vector<float> value, weight;

    explicit Raster(Size s = {}) : size(s), value(s.pixels()), weight(s.pixels()) {}
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
               static_cast<std::size_t>(x);
    }
};

/// Finer than this is not worth the time: shifts are found to hundredths of a raster's pixel.
constexpr int kLongest = 1600;
constexpr int kCoarsest = 40;
// Parts of white between which light counts.
constexpr float kHighest = 0.9f;

/// What of the colour is compared: a channel, or the luminance, for which no channel may clip.
constexpr int kLuminance = 3;

bool usable(const ExposedPhoto& photo, const float* stored, int channel) {
    const auto most = kHighest * static_cast<float>(photo.white);
    if (channel != kLuminance) return stored[channel] < most;
    return stored[0] < most && stored[1] < most && stored[2] < most;
}

double light_of(const Response& response, const float* stored, int channel) {
    if (channel != kLuminance) return static_cast<double>(response.light(stored[channel]));
    const float linear[] = {response.light(stored[0]), response.light(stored[1]),
                            response.light(stored[2])};
    return luminance(linear);
}

/// The luminance; but a channel, such as the blue of leaves, where it shows much more of the pair
/// of neighbours that share least.
int channel_to_compare(std::span<const ExposedPhoto> photos, std::span<const int> order) {
    constexpr int kRows = 64, kStep = 8;
    const Size size = photos.front().size;
    Image row({size.width, 1}, 3);
    std::array<double, 4> least{1, 1, 1, 1};
    std::vector<std::array<char, 4>> before, now;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const ExposedPhoto& photo = photos[static_cast<std::size_t>(order[i])];
        now.clear();
        for (int j = 0; j < kRows; ++j) {
            const int y = j * size.height / kRows;
            photo.read(y, y + 1, row.view());
            for (int x = 0; x < size.width; x += kStep) {
                const float* stored = row.pixel(x, 0);
                std::array<char, 4> shows{};
                for (int c = 0; c < 4; ++c)
                    shows[static_cast<std::size_t>(c)] =
                        usable(photo, stored, c) &&
                        stored[c == kLuminance ? 1 : c] > 8 * static_cast<float>(photo.step);
                now.push_back(shows);
            }
        }
        for (std::size_t c = 0; c < 4 && i > 0; ++c) {
            double both = 0;
            for (std::size_t n = 0; n < now.size(); ++n) both += before[n][c] && now[n][c];
            least[c] = std::min(least[c], both / static_cast<double>(now.size()));
        }
        std::swap(before, now);
    }
    constexpr double kEnough = 0.3;
    if (least[kLuminance] > kEnough) return kLuminance;
    const auto best = std::max_element(least.begin(), least.begin() + 3);
    return *best > 1.5 * least[kLuminance] ? static_cast<int>(best - least.begin()) : kLuminance;
}

/// A part of the photo, means of factor x factor pixels.
Raster raster_of(const ExposedPhoto& photo, const Response& response, const Window& region,
                 int factor, int channel) {
    Raster raster({region.size.width / factor, region.size.height / factor});
    for_each_band(raster.size.height, 16, [&](int first, int last) {
        Image rows({photo.size.width, factor}, 3);
        for (int y = first; y < last; ++y) {
            const int top = region.y + y * factor;
            if (top < 0 || top + factor > photo.size.height) continue;
            photo.read(top, top + factor, rows.view());
            for (int x = 0; x < raster.size.width; ++x) {
                const int left = region.x + x * factor;
                if (left < 0 || left + factor > photo.size.width) continue;
                double light = 0;
                bool clipped = false;
                for (int j = 0; j < factor; ++j)
                    for (int i = 0; i < factor; ++i) {
                        const float* stored = rows.pixel(left + i, j);
                        clipped = clipped || !usable(photo, stored, channel);
                        light += light_of(response, stored, channel);
                    }
                light /= factor * factor;
                if (clipped || !(light > 0)) continue;
                // A curve's slope is about its light's ratio here; good enough for a weight.
                const double slope = response.is_linear() ? 1 : std::max(0.08, 2.2 * light);
                const double variance = noise_variance(photo, light, slope) / (light * light);
                constexpr double kFlat = 1e-3;  // never surer than 3 %
                raster.value[raster.at(x, y)] = static_cast<float>(std::log(light));
                raster.weight[raster.at(x, y)] = static_cast<float>(1 / (variance + kFlat));
            }
        }
    });
    return raster;
}

Raster half(const Raster& fine) {
    Raster coarse({fine.size.width / 2, fine.size.height / 2});
    for (int y = 0; y < coarse.size.height; ++y)
        for (int x = 0; x < coarse.size.width; ++x) {
            float sum = 0, weight = 0;
            int used = 0;
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    const std::size_t at = fine.at(2 * x + i, 2 * y + j);
                    if (!(fine.weight[at] > 0)) continue;
                    sum += fine.weight[at] * fine.value[at];
                    weight += fine.weight[at];
                    ++used;
                }
            if (used < 3) continue;
            coarse.value[coarse.at(x, y)] = sum / weight;
            coarse.weight[coarse.at(x, y)] = weight / static_cast<float>(used);
        }
    return coarse;
}

/// Binomial means along one axis, of what counts.
Raster smoothed(const Raster& raster, int dx, int dy) {
    constexpr float kWeights[] = {1, 4, 6, 4, 1};
    Raster out(raster.size);
    for (int y = 0; y < raster.size.height; ++y)
        for (int x = 0; x < raster.size.width; ++x) {
            const std::size_t at = raster.at(x, y);
            if (!(raster.weight[at] > 0)) continue;
            float sum = 0, total = 0, count = 0;
            for (int i = -2; i <= 2; ++i) {
                const int u = x + i * dx, v = y + i * dy;
                if (u < 0 || v < 0 || u >= raster.size.width || v >= raster.size.height) continue;
                const std::size_t there = raster.at(u, v);
                const float w = kWeights[i + 2] * raster.weight[there];
                if (!(w > 0)) continue;
                sum += w * raster.value[there];
                total += w;
                count += kWeights[i + 2];
            }
            // Lopsided beside what is clipped: means of different places.
            if (count < 16) continue;
            out.value[at] = sum / total;
            out.weight[at] = total / count;
        }
    return out;
}

/// Sums over boxes of 2 r + 1 along one axis, cut at the edges.
void box_sums(const std::vector<float>& in, Size size, int r, bool along_x,
              std::vector<float>& out) {
    const int lines = along_x ? size.height : size.width;
    const int length = along_x ? size.width : size.height;
    const auto step = static_cast<std::size_t>(along_x ? 1 : size.width);
    for (int line = 0; line < lines; ++line) {
        const std::size_t first =
            static_cast<std::size_t>(line) * static_cast<std::size_t>(along_x ? size.width : 1);
        const auto at = [&](int i) { return first + static_cast<std::size_t>(i) * step; };
        double sum = 0;
        for (int i = 0; i < std::min(r, length); ++i) sum += static_cast<double>(in[at(i)]);
        for (int i = 0; i < length; ++i) {
            if (i + r < length) sum += static_cast<double>(in[at(i + r)]);
            if (i - r - 1 >= 0) sum -= static_cast<double>(in[at(i - r - 1)]);
            out[at(i)] = static_cast<float>(sum);
        }
    }
}

/// Less the mean around each pixel: over gentle slopes an error of the curve or of the exposure
/// would look like a shift. Where much around is missing the mean is of another place, so nothing
/// stays.
Raster without_mean(const Raster& raster) {
    const int r = std::clamp(std::max(raster.size.width, raster.size.height) / 12, 2, 8);
    Raster out(raster.size);
    std::vector<float> values(raster.value.size()), there(raster.value.size());
    std::vector<float> sums(raster.value.size()), counts(raster.value.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        there[i] = raster.weight[i] > 0 ? 1 : 0;
        values[i] = there[i] * raster.value[i];
    }
    box_sums(values, raster.size, r, true, sums);
    box_sums(sums, raster.size, r, false, values);
    box_sums(there, raster.size, r, true, sums);
    box_sums(sums, raster.size, r, false, counts);
    const float enough = 0.98f * static_cast<float>((2 * r + 1) * (2 * r + 1));
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!(raster.weight[i] > 0 && counts[i] > enough)) continue;
        out.value[i] = raster.value[i] - values[i] / counts[i];
        out.weight[i] = raster.weight[i];
    }
    return out;
}

/// A photo at all sizes, the finest first.
struct Pyramid {
    std::vector<Raster> levels;  ///< less their local means
    Raster coarsest;             ///< whole
};

/// Smooth, since between noisy pixels a mean of two is less noisy, which draws shifts to halves.
Pyramid pyramid(Raster finest) {
    Pyramid made;
    std::vector<Raster>& levels = made.levels;
    levels.push_back(std::move(finest));
    while (std::max(levels.back().size.width, levels.back().size.height) >= 2 * kCoarsest)
        levels.push_back(half(levels.back()));
    made.coarsest = levels.back();
    for (Raster& level : levels) level = without_mean(smoothed(smoothed(level, 1, 0), 0, 1));
    return made;
}

/// What a raster says at a place between pixels.
struct Sample {
    double value, weight;
};

/// Bilinear, weight 0 where a neighbour is missing.
Sample sample(const Raster& r, double x, double y) {
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    if (x0 < 0 || y0 < 0 || x0 + 1 >= r.size.width || y0 + 1 >= r.size.height) return {0, 0};
    const std::size_t at = r.at(x0, y0), below = r.at(x0, y0 + 1);
    const float least =
        std::min({r.weight[at], r.weight[at + 1], r.weight[below], r.weight[below + 1]});
    if (!(least > 0)) return {0, 0};
    const auto u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
    const float top = (1 - u) * r.value[at] + u * r.value[at + 1];
    const float bottom = (1 - u) * r.value[below] + u * r.value[below + 1];
    return {static_cast<double>((1 - v) * top + v * bottom), static_cast<double>(least)};
}

/// Central differences, which do not go with the pixel's own noise; nothing at an edge.
std::optional<V2d> slope(const Raster& r, int x, int y) {
    if (x < 1 || y < 1 || x + 1 >= r.size.width || y + 1 >= r.size.height) return std::nullopt;
    const std::size_t left = r.at(x - 1, y), right = r.at(x + 1, y);
    const std::size_t above = r.at(x, y - 1), below = r.at(x, y + 1);
    if (!(std::min({r.weight[left], r.weight[right], r.weight[above], r.weight[below]}) > 0))
        return std::nullopt;
    return V2d(static_cast<double>(r.value[right] - r.value[left]) / 2,
               static_cast<double>(r.value[below] - r.value[above]) / 2);
}

/// Of one photo on another, in the raster's pixels.
struct Fit {
    V2d shift{0, 0};
    double deviation = 1e9;  ///< of the shift, pixels
    double spread = 0.3;     ///< of what does not fit, natural logarithm; bounded below
    double misfit = 0;       ///< the same before the last step, not bounded
    std::size_t pixels = 0;
    double likeness = 0;  ///< of what both show there, -1 to 1
};

/// One step of Gauss and Newton, with the reference's slopes; false where the rasters share too
/// little.
bool improve(const Raster& reference, const Raster& other, Fit& fit) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double squares = 0, total = 0;
    std::size_t pixels = 0;
    for (int y = 0; y < reference.size.height; ++y)
        for (int x = 0; x < reference.size.width; ++x) {
            const std::size_t at = reference.at(x, y);
            if (!(reference.weight[at] > 0)) continue;
            const auto rise = slope(reference, x, y);
            if (!rise) continue;
            const Sample s = sample(other, x + fit.shift.x, y + fit.shift.y);
            if (!(s.weight > 0)) continue;
            const double off = s.value - static_cast<double>(reference.value[at]);
            const double far = off / (2 * fit.spread);
            const double weight = 1 /
                                  (1 / s.weight + 1 / static_cast<double>(reference.weight[at])) /
                                  (1 + far * far) / (1 + far * far);
            const Eigen::Vector2d row(rise->x, rise->y);
            normal += weight * row * row.transpose();
            right -= weight * off * row;
            squares += weight * off * off;
            total += weight;
            ++pixels;
        }
    fit.pixels = pixels;
    constexpr std::size_t kFewest = 200;
    if (pixels < kFewest || !(normal(0, 0) > 0 && normal(1, 1) > 0)) return false;
    normal += 1e-9 * normal.trace() * Eigen::Matrix2d::Identity();
    const auto factors = normal.ldlt();
    const Eigen::Vector2d change = factors.solve(right);
    if (!change.allFinite()) return false;
    // No further than the slopes reach.
    const double length = std::hypot(change[0], change[1]);
    const double part = length > 2 ? 2 / length : 1;
    fit.shift += V2d(change[0], change[1]) * part;
    fit.misfit = std::sqrt(squares / total);
    fit.spread = std::max(0.01, fit.misfit);
    const Eigen::Matrix2d inverse = factors.solve(Eigen::Matrix2d::Identity());
    // Residuals of neighbouring pixels go together, as edges do.
    constexpr double kTogether = 16;
    fit.deviation = std::sqrt(kTogether * (inverse(0, 0) + inverse(1, 1)) * squares /
                              static_cast<double>(pixels));
    return true;
}

/// How badly two rasters fit at a whole-pixel shift: spread of the difference, robustly.
double misfit(const Raster& reference, const Raster& other, int dx, int dy,
              std::vector<double>& differences) {
    differences.clear();
    std::size_t shown = 0;
    for (int y = 0; y < reference.size.height; ++y)
        for (int x = 0; x < reference.size.width; ++x) {
            const std::size_t at = reference.at(x, y);
            if (!(reference.weight[at] > 0)) continue;
            ++shown;
            const int i = x + dx, j = y + dy;
            if (i < 0 || j < 0 || i >= other.size.width || j >= other.size.height) continue;
            const std::size_t there = other.at(i, j);
            if (!(other.weight[there] > 0)) continue;
            differences.push_back(static_cast<double>(other.value[there] - reference.value[at]));
        }
    if (differences.size() < 60 || differences.size() < shown / 4)
        return std::numeric_limits<double>::infinity();
    const double middle = median(differences);
    double sum = 0;
    for (const double d : differences) sum += std::min(0.5, std::abs(d - middle));
    return sum / static_cast<double>(differences.size());
}

/// The best whole-pixel shift at the coarsest level.
V2d coarse_shift(const Raster& reference, const Raster& other) {
    const int reach = std::max(reference.size.width, reference.size.height) / 6;
    std::vector<double> differences;
    V2d best(0, 0);
    double least = misfit(reference, other, 0, 0, differences);
    for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
            const double one = misfit(reference, other, dx, dy, differences);
            if (one < least) least = one, best = V2d(dx, dy);
        }
    return best;
}

/// On a tripod photos lie still. A fraction of a pixel that hardly fits better than none is an
/// error: JPEG's errors go together over blocks, and where two photos share little they draw the
/// shift along.
void settle(const Raster& reference, const Raster& other, Fit& fit) {
    constexpr double kFraction = 0.5, kHardlyBetter = 1.05;
    if (fit.shift.length() > kFraction) return;
    Fit still = fit, here = fit;
    still.shift = V2d(0, 0);
    if (improve(reference, other, still) && improve(reference, other, here) &&
        still.misfit < kHardlyBetter * here.misfit)
        fit.shift = V2d(0, 0);
}

/// Other on reference from a first guess in the finest level's pixels, starting at a level; nothing
/// where they share too little.
std::optional<Fit> fit_from(const Pyramid& reference, const Pyramid& other, V2d guess, int level) {
    Fit now;
    now.shift = guess / std::exp2(level);
    bool good = false;
    for (; level >= 0; --level) {
        const auto& a = reference.levels[static_cast<std::size_t>(level)];
        const auto& b = other.levels[static_cast<std::size_t>(level)];
        Fit here = now;
        here.spread = 0.3;
        good = true;
        for (int i = 0; i < 12 && good; ++i) {
            const V2d before = here.shift;
            good = improve(a, b, here);
            if (good && (here.shift - before).length() < 1e-3 && i > 3) break;
        }
        if (good) now = here;
        if (level > 0) now.shift *= 2;
    }
    if (!good) return std::nullopt;
    settle(reference.levels.front(), other.levels.front(), now);
    return now;
}

/// How alike two rasters are at a shift, -1 to 1.
double likeness(const Raster& reference, const Raster& other, V2d shift) {
    double both = 0, mine = 1e-12, its = 1e-12;
    for (int y = 0; y < reference.size.height; ++y)
        for (int x = 0; x < reference.size.width; ++x) {
            const std::size_t at = reference.at(x, y);
            if (!(reference.weight[at] > 0)) continue;
            const Sample s = sample(other, x + shift.x, y + shift.y);
            if (!(s.weight > 0)) continue;
            const auto a = static_cast<double>(reference.value[at]);
            const double w = 1 / (1 / s.weight + 1 / static_cast<double>(reference.weight[at]));
            both += w * a * s.value, mine += w * a * a, its += w * s.value * s.value;
        }
    return both / std::sqrt(mine * its);
}

/// As `fit`, without how alike they are there.
std::optional<Fit> shifted(const Pyramid& reference, const Pyramid& other,
                           const std::optional<V2d>& hint) {
    const int coarsest = static_cast<int>(reference.levels.size()) - 1;
    // A few pixels are a fraction of one four levels up.
    if (hint) return fit_from(reference, other, *hint, std::min(coarsest, 4));
    const V2d coarse = coarse_shift(reference.coarsest, other.coarsest);
    auto found = fit_from(reference, other, coarse * std::exp2(coarsest), coarsest);
    if (coarse == V2d(0, 0)) return found;
    // Photos mostly lie nearly still; what is far off has to fit better.
    const auto still = fit_from(reference, other, V2d(0, 0), coarsest);
    if (!still || !found) return still ? still : found;
    const Raster &a = reference.levels.front(), &b = other.levels.front();
    return likeness(a, b, still->shift) >= likeness(a, b, found->shift) ? still : found;
}

/// Other on reference, in the photos' pixels, of which the finest level's are so many; nothing
/// where they share too little.
std::optional<Fit> fit(const Pyramid& reference, const Pyramid& other, std::optional<V2d> hint,
                       int factor) {
    if (hint) *hint /= factor;
    auto found = shifted(reference, other, hint);
    if (!found) return found;
    found->likeness = likeness(reference.levels.front(), other.levels.front(), found->shift);
    found->shift *= factor;
    found->deviation *= factor;
    return found;
}

/// Photos of one thing are 0.8 and more alike, whatever their exposures; of different ones, such as
/// a ball and somebody before it, 0.1 and less.
constexpr double kSurelyAlike = 0.7, kAlike = 0.4;

int factor_of(const Window& window) {
    return 1 + (std::max(window.size.width, window.size.height) - 1) / kLongest;
}

std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

std::vector<Alignment> align(std::span<const ExposedPhoto> photos, std::span<const int> order,
                             int reference, const Response& response, const AlignOptions& options,
                             const Watch& watch) {
    assert(order.size() == photos.size());
    assert(options.hints.empty() || options.hints.size() == photos.size());
    assert(options.whole.empty() || options.whole.size() == photos.size());
    const Window all{0, 0, photos.front().size};
    const Window region = options.region.value_or(all);
    const auto whole = [&](int photo) {
        return !options.region || (!options.whole.empty() && options.whole[index(photo)]);
    };
    const int channel = channel_to_compare(photos, order);
    const int all_factor = factor_of(all), region_factor = factor_of(region);
    std::vector<Pyramid> levels(photos.size()), all_levels(photos.size());
    for (int i = 0; i < static_cast<int>(order.size()); ++i) {
        const int photo = order[index(i)];
        const auto beside = [&](int j) {
            return j >= 0 && j < static_cast<int>(order.size()) && whole(order[index(j)]);
        };
        const bool needs_all = whole(photo) || beside(i - 1) || beside(i + 1);
        if (needs_all)
            all_levels[index(photo)] =
                pyramid(raster_of(photos[index(photo)], response, all, all_factor, channel));
        if (!whole(photo))
            levels[index(photo)] =
                pyramid(raster_of(photos[index(photo)], response, region, region_factor, channel));
        watch.check();
    }
    const auto hint = [&](int photo) -> std::optional<V2d> {
        if (options.hints.empty()) return std::nullopt;
        return options.hints[static_cast<std::size_t>(photo)];
    };
    // Each photo on its neighbour on the reference's side.
    const auto middle = std::ranges::find(order, reference) - order.begin();
    std::vector<std::optional<Fit>> fits(photos.size());
    const auto count = static_cast<int>(order.size());
    for_each_band(
        count, 1,
        [&](int i, int) {
            if (i == middle) return;
            const int photo = order[index(i)];
            const int neighbour = order[index(i < middle ? i + 1 : i - 1)];
            const bool wide = whole(photo) || whole(neighbour);
            const auto here = hint(photo), there = hint(neighbour);
            std::optional<V2d> between;
            if (here && there) between = *here - *there;
            fits[index(i)] =
                wide ? fit(all_levels[index(neighbour)], all_levels[index(photo)], between,
                           all_factor)
                     : fit(levels[index(neighbour)], levels[index(photo)], between, region_factor);
        },
        watch);
    const auto by_whole_picture = [&](int photo, int neighbour) {
        for (const int i : {photo, neighbour})
            if (Pyramid& made = all_levels[index(i)]; made.levels.empty())
                made = pyramid(raster_of(photos[index(i)], response, all, all_factor, channel));
        watch.check();
        return fit(all_levels[index(neighbour)], all_levels[index(photo)], std::nullopt,
                   all_factor);
    };
    // Something hides the region in one of them, or its outline was seen where it is not: what lies
    // around can tell.
    for (int i = 0; i < count; ++i) {
        auto& best = fits[index(i)];
        if (i == middle || (best && best->likeness >= kSurelyAlike)) continue;
        const auto around =
            by_whole_picture(order[index(i)], order[index(i < middle ? i + 1 : i - 1)]);
        if (around && (!best || around->likeness > best->likeness)) best = around;
    }
    std::vector<Alignment> found(photos.size());
    found[static_cast<std::size_t>(reference)].measured = true;
    const auto follow = [&](std::ptrdiff_t i, std::ptrdiff_t from) {
        const int photo = order[static_cast<std::size_t>(i)];
        auto one = fits[static_cast<std::size_t>(i)];
        // What shows something else cannot tell where the next one lies.
        std::ptrdiff_t trusted = from;
        while (found[index(order[static_cast<std::size_t>(trusted)])].unlike) trusted += from - i;
        if (trusted != from)
            one = by_whole_picture(photo, order[static_cast<std::size_t>(trusted)]);
        const Alignment& neighbour = found[index(order[static_cast<std::size_t>(trusted)])];
        constexpr double kUnsure = 0.5;
        const bool compared = one && one->deviation < kUnsure;
        if (compared && one->likeness > kAlike) {
            found[index(photo)] = {neighbour.shift + one->shift,
                                   std::hypot(neighbour.deviation, one->deviation), true};
        } else if (compared) {
            found[index(photo)] = {neighbour.shift, 0, false, true};
        } else {
            const auto known = hint(photo);
            found[index(photo)] = {known.value_or(neighbour.shift), 0, known.has_value()};
        }
    };
    for (std::ptrdiff_t i = middle - 1; i >= 0; --i) follow(i, i + 1);
    for (std::ptrdiff_t i = middle + 1; i < count; ++i) follow(i, i - 1);
    return found;
}

}  // namespace chromeball
