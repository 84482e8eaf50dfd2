#include "detect/rim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>

namespace chromeball::detecting {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The surroundings of an outline unrolled: a row a ray, from inside to outside.
struct Strip {
    std::vector<Ray> rays;
    int half = 0;  ///< samples to either side of the outline
    double step = 1;
    std::vector<float> slope;  ///< smoothed derivative outwards; NaN where not known

    int length() const { return 2 * half + 1; }
    const float* row(std::size_t ray) const {
        return slope.data() + ray * static_cast<std::size_t>(length());
    }
};

/// Derivative of a Gaussian, sampled; applied to a ramp of slope 1 a sample it gives 1.
std::vector<float> derivative_kernel(double sigma) {
    const int half = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
    std::vector<float> kernel;
    double ramp = 0;
    for (int i = -half; i <= half; ++i) {
        const double weight = i * std::exp(-0.5 * i * i / (sigma * sigma));
        kernel.push_back(static_cast<float>(weight));
        ramp += weight * i;
    }
    for (float& k : kernel) k = static_cast<float>(k / ramp);
    return kernel;
}

template <class T, class Value>
Strip unrolled(const Raster<T>& picture, const Outline& outline, const RimSearch& search,
               const Value& value) {
    Strip strip;
    strip.rays = rays_of(outline, search.rays);
    strip.step = search.step;
    strip.half = std::max(2, static_cast<int>(std::ceil(search.reach / search.step)));
    const auto kernel = derivative_kernel(std::max(0.5, search.smooth / search.step));
    const int pad = static_cast<int>(kernel.size()) / 2, padded = strip.half + pad;
    const auto width = static_cast<std::size_t>(2 * padded + 1), count = strip.rays.size();
    std::vector<float> profiles;
    profiles.reserve(count * width);
    for (const Ray& ray : strip.rays)
        for (int k = -padded; k <= padded; ++k) {
            const double d = k * search.step;
            profiles.push_back(sample(picture, ray.x + d * ray.nx, ray.y + d * ray.ny, value));
        }
    // Along the rim neighbours are averaged (1 2 1): the rim goes on there, noise and the texture
    // of other things do not. At the picture's border a ray stays as it is.
    std::vector<float> profile(width);
    strip.slope.reserve(count * static_cast<std::size_t>(strip.length()));
    for (std::size_t r = 0; r < count; ++r) {
        const float* here = profiles.data() + r * width;
        const float* before = profiles.data() + (r + count - 1) % count * width;
        const float* after = profiles.data() + (r + 1) % count * width;
        for (std::size_t k = 0; k < width; ++k) {
            const float around = 0.25f * (before[k] + 2 * here[k] + after[k]);
            profile[k] = std::isnan(around) ? here[k] : around;
        }
        for (std::size_t k = 0; k < static_cast<std::size_t>(strip.length()); ++k) {
            float sum = 0;
            for (std::size_t i = 0; i < kernel.size(); ++i) sum += kernel[i] * profile[k + i];
            strip.slope.push_back(sum);
        }
    }
    return strip;
}

/// An edge on a ray.
struct Peak {
    double offset;    ///< pixels outwards of the strip's outline
    double strength;  ///< 0 to 1: how much it stands out on its ray
};

struct Peaks {
    std::vector<std::vector<Peak>> of_ray;
    std::vector<bool> seen;       ///< rays whose middle lies in the picture
    double per_pixel = 0;         ///< density of peaks
    double strong_per_pixel = 0;  ///< of those that stand out
};

constexpr double kStrong = 0.6;

/// Mean absolute slope of samples [first, last) of a ray, what is known of them; negative where
/// nothing is.
double mean_slope(const float* slope, int first, int last) {
    double sum = 0;
    int known = 0;
    for (int k = first; k < last; ++k)
        if (!std::isnan(slope[k])) sum += std::abs(slope[k]), ++known;
    return known ? sum / known : -1;
}

/// How much an edge stands out against what lies outside of it.
///
/// Right inside its rim a mirror ball shows what is right behind it, and from there on the world
/// ever less compressed: the rim is often a weak edge with stronger ones parallel to it inside.
/// What tells it from those is that nothing lies outside of it but the plain background.
double strength_of(const float* slope, int at, int length, const RimSearch& search, double least) {
    const int skip = static_cast<int>(std::ceil(1.5 * search.smooth / search.step));
    const int width = std::max(4, static_cast<int>(0.5 * search.reach / search.step));
    const int first = std::min(at + skip, length), last = std::min(first + width, length);
    const double outside = last - first >= 2 ? mean_slope(slope, first, last) : -1;
    const double usual = outside >= 0 ? outside : mean_slope(slope, 0, length);
    const double here = std::abs(slope[at]);
    return here / (here + 2 * usual + least);
}

/// Close to the rim of a mirror ball the outermost edge is the rim, however much stronger the edges
/// of the reflections behind it are.
void weaken_shaded(std::vector<Peak>& peaks, double distance) {
    for (std::size_t i = 0; i < peaks.size(); ++i)
        for (std::size_t j = i + 1; j < peaks.size(); ++j)
            if (peaks[j].offset - peaks[i].offset < distance && peaks[j].strength > kStrong) {
                peaks[i].strength *= 0.3;
                break;
            }
}

Peaks peaks_of(const Strip& strip, const RimSearch& search, double least) {
    Peaks peaks;
    const int n = strip.length();
    double count = 0, strong = 0, known = 0;
    for (std::size_t r = 0; r < strip.rays.size(); ++r) {
        const float* slope = strip.row(r);
        std::vector<Peak> found;
        for (int k = 1; k + 1 < n; ++k) {
            if (!std::isnan(slope[k])) known += 1;
            const float a = std::abs(slope[k - 1]), b = std::abs(slope[k]),
                        c = std::abs(slope[k + 1]);
            // Comparisons with NaN are false, so peaks need known neighbours.
            if (!(b > a && b >= c && b > least)) continue;
            const double bend = a - 2 * b + c;
            const double shift = bend < 0 ? 0.5 * (a - c) / bend : 0;
            const double strength = strength_of(slope, k, n, search, least);
            found.push_back({(k + shift - strip.half) * strip.step, strength});
            count += 1;
            if (strength > kStrong) strong += 1;
        }
        weaken_shaded(found, search.shade);
        peaks.seen.push_back(!std::isnan(slope[strip.half]));
        peaks.of_ray.push_back(std::move(found));
    }
    const double length = known * strip.step;
    if (length > 0) peaks.per_pixel = count / length, peaks.strong_per_pixel = strong / length;
    return peaks;
}

using Vector5 = cv::Matx<double, 5, 1>;
using Matrix5 = cv::Matx<double, 5, 5>;

Vector5 row_of(const Ray& ray, double radius) {
    return {ray.nx, ray.ny, 1, radius * ray.cos2, radius * ray.sin2};
}

double dot(const Vector5& a, const Vector5& b) {
    double sum = 0;
    for (int i = 0; i < 5; ++i) sum += a(i) * b(i);
    return sum;
}

void add_equation(const Vector5& row, double target, double weight, Matrix5& h, Vector5& g) {
    for (int i = 0; i < 5; ++i) {
        g(i) += weight * row(i) * target;
        for (int j = 0; j < 5; ++j) h(i, j) += weight * row(i) * row(j);
    }
}

/// The peak that agrees best with an edge expected at `where`.
const Peak* nearest_peak(const std::vector<Peak>& peaks, double where, double scale) {
    const Peak* best = nullptr;
    double most = 0;
    for (const Peak& peak : peaks) {
        if (peak.strength <= most) continue;  // no need to know how near
        const double d = (peak.offset - where) / scale;
        if (d * d > 9) continue;
        const double value = peak.strength * std::exp(-0.5 * d * d);
        if (value > most) most = value, best = &peak;
    }
    return best;
}

/// The change of shape (x, y, radius, e1, e2) that brings the outline onto the edges: least squares
/// on the best peak of each ray, again and again while the scale of what counts as near shrinks.
Vector5 settled(const Strip& strip, const Peaks& peaks, const Shape& base, const RimSearch& search,
                const Lens& lens) {
    Vector5 change;
    constexpr int kRounds = 10;
    for (int round = 0; round < kRounds; ++round) {
        const double part = std::min(1.0, round / (kRounds - 3.0));
        const double scale = search.loose * std::pow(search.tight / search.loose, part);
        // Neighbouring edges err alike: a third of the rays count as independent against the lens.
        const double precision = 1 / (3 * scale * scale);
        Matrix5 h = Matrix5::eye() * 1e-9;
        Vector5 g;
        for (std::size_t r = 0; r < strip.rays.size(); ++r) {
            const Vector5 row = row_of(strip.rays[r], base.radius);
            const double where = dot(row, change);
            const Peak* peak = nearest_peak(peaks.of_ray[r], where, scale);
            if (!peak) continue;
            const double d = (peak->offset - where) / scale;
            add_equation(row, peak->offset, precision * peak->strength * std::exp(-0.5 * d * d), h,
                         g);
        }
        const Shape now{base.x + change(0), base.y + change(1), base.radius + change(2),
                        base.e1 + change(3), base.e2 + change(4)};
        const ShapePrior prior = prior_at(now, lens);
        const double t1 = prior.e1 - base.e1, t2 = prior.e2 - base.e2;
        const Vector5 along{0, 0, 0, prior.cos2, prior.sin2};
        const Vector5 across{0, 0, 0, -prior.sin2, prior.cos2};
        add_equation(along, prior.cos2 * t1 + prior.sin2 * t2, 1 / (prior.along * prior.along), h,
                     g);
        add_equation(across, -prior.sin2 * t1 + prior.cos2 * t2, 1 / (prior.across * prior.across),
                     h, g);
        bool solved = false;
        const Matrix5 inverse = h.inv(cv::DECOMP_CHOLESKY, &solved);
        if (!solved) break;
        change = inverse * g;
    }
    return change;
}

/// The width of the rim: profiles' slopes, laid over each other with their edges aligned and their
/// signs made equal, have the width of the blur and of the derivative's own kernel.
double blur_of(const Strip& strip, const std::vector<double>& edge_at, double smooth) {
    std::vector<double> stack(static_cast<std::size_t>(strip.length()));
    for (std::size_t r = 0; r < strip.rays.size(); ++r) {
        if (std::isnan(edge_at[r])) continue;
        const float* slope = strip.row(r);
        const int shift = static_cast<int>(std::lround(edge_at[r] / strip.step));
        const int middle = strip.half + shift;
        if (middle < 0 || middle >= strip.length()) continue;
        const double sign = slope[middle] < 0 ? -1 : 1;
        for (int k = 0; k < strip.length(); ++k)
            if (const int from = k + shift;
                from >= 0 && from < strip.length() && !std::isnan(slope[from]))
                stack[static_cast<std::size_t>(k)] += sign * slope[from];
    }
    const auto middle = static_cast<std::size_t>(strip.half);
    const double top = stack[middle];
    if (!(top > 0)) return 0;
    // Half width at half height, by linear interpolation, on both sides.
    const auto half_width = [&](int direction) {
        double last = top;
        for (int k = 1; k <= strip.half; ++k) {
            const double now = stack[static_cast<std::size_t>(strip.half + direction * k)];
            if (now <= 0.5 * top) return k - (0.5 * top - now) / std::max(last - now, 1e-12);
            last = now;
        }
        return double(strip.half);
    };
    const double sigma = strip.step * 0.5 * (half_width(1) + half_width(-1)) / 1.1774;
    return std::sqrt(std::max(0.0, sigma * sigma - smooth * smooth));
}

/// The longest run of `false` around the rim among the rays that are seen, as a part of all rays.
double longest_gap(const std::vector<bool>& edge, const std::vector<bool>& seen) {
    const std::size_t n = edge.size();
    std::size_t longest = 0, run = 0;
    for (std::size_t i = 0; i < 2 * n; ++i) {
        run = seen[i % n] && !edge[i % n] ? run + 1 : 0;
        longest = std::max(longest, std::min(run, n));
    }
    return static_cast<double>(longest) / static_cast<double>(n);
}

/// The part of the rays with `true` on them or right beside them.
double part_around(const std::vector<bool>& rays) {
    const std::size_t n = rays.size();
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i)
        count += rays[i] || rays[(i + 1) % n] || rays[(i + n - 1) % n];
    return static_cast<double>(count) / static_cast<double>(n);
}

/// n times the relative entropy of the found part against chance: the exponent in Hoeffding's bound
/// on the probability of as many hits among n independent rays.
double significance_of(double found, double chance, double independent) {
    if (found <= chance) return 0;
    const double miss = found < 1 ? (1 - found) * std::log((1 - found) / (1 - chance)) : 0;
    return independent * (found * std::log(found / chance) + miss);
}

template <class T, class Value>
Rim fitted(const Raster<T>& picture, const Outline& start, const RimSearch& search,
           const Lens& lens, double least, const Value& value) {
    const Strip strip = unrolled(picture, start, search, value);
    const Peaks peaks = peaks_of(strip, search, least);
    const Shape base = shape_of(start);
    const Vector5 change = settled(strip, peaks, base, search, lens);

    Rim rim;
    rim.outline = outline_of(Shape{base.x + change(0), base.y + change(1), base.radius + change(2),
                                   base.e1 + change(3), base.e2 + change(4)});
    const double near = 2 * search.tight;
    std::vector<bool> edge(strip.rays.size()), clear(strip.rays.size());
    std::vector<double> edge_at(strip.rays.size(), kUnknown);
    double squares = 0, strength = 0;
    int seen = 0, hits = 0, strong = 0;
    for (std::size_t r = 0; r < strip.rays.size(); ++r) {
        if (!peaks.seen[r]) continue;
        ++seen;
        const double where = dot(row_of(strip.rays[r], base.radius), change);
        const Peak* peak = nearest_peak(peaks.of_ray[r], where, search.tight);
        if (!peak || std::abs(peak->offset - where) > near) continue;
        edge[r] = true;
        edge_at[r] = peak->offset;
        ++hits;
        clear[r] = peak->strength > kStrong;
        strong += clear[r];
        strength += peak->strength;
        squares += (peak->offset - where) * (peak->offset - where);
    }
    if (seen == 0) return rim;
    // Among dense texture a random line would have as many edges near it.
    const auto chance = [&](double density) {
        return std::clamp(1 - std::exp(-2 * near * density), 0.02, 0.98);
    };
    const double found = double(hits) / seen, by_chance = chance(peaks.per_pixel);
    rim.inside_picture = double(seen) / search.rays;
    rim.visible = part_around(clear);
    rim.coverage = std::max(0.0, (found - by_chance) / (1 - by_chance));
    rim.support = strength / seen;
    // Averaged neighbours, and rays closer than 2 pixels, see the same edge; the fit uses up five.
    const double independent =
        rim.inside_picture * std::min<double>(0.67 * search.rays, std::numbers::pi * rim.outline.b);
    rim.significance = significance_of(double(strong) / seen, chance(peaks.strong_per_pixel),
                                       std::max(0.0, independent - 5));
    rim.longest_gap = longest_gap(edge, peaks.seen);
    rim.scatter = hits ? std::sqrt(squares / hits) : 0;
    rim.blur = blur_of(strip, edge_at, search.smooth);
    return rim;
}

}  // namespace

Rim fit_rim(const Raster<float>& picture, const Outline& start, const RimSearch& search,
            const Lens& lens) {
    return fitted(picture, start, search, lens, 0.5 / 255, [](float v) { return v; });
}

Rim fit_rim(const Grey& picture, Tone tone, const Outline& start, const RimSearch& search,
            const Lens& lens) {
    if (tone == Tone::compressed)
        return fitted(picture.pixels, start, search, lens, 0.5 / 255,
                      [](std::uint16_t code) { return static_cast<float>(code) * (1 / 65535.f); });
    // Linear light has no natural scale; a slope of nothing is the only one that is no edge.
    return fitted(picture.pixels, start, search, lens, 1e-7,
                  [&](std::uint16_t code) { return picture.linear[code]; });
}

}  // namespace chromeball::detecting
