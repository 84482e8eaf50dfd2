#include "light/grey_ball.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "light/ball_beside.h"
#include "light/grey_facets.h"
#include "light/non_negative.h"
#include "light/rays.h"

namespace chromeball {
namespace {

using std::numbers::pi;
using Rgb = std::array<double, 3>;

/// What the mirror ball shows, but for what a ball beside it hides there; that and what the photo
/// does not show are filled.
Rays rays_of(const BallPicture& mirror, const BallBeside* beside) {
    Rays rays;
    BallBeside wide;
    if (beside) {
        // Its rim is blurred, and nobody knows its place exactly.
        wide = *beside;
        wide.radius *= 1.05;
    }
    for_ball(mirror, [&](int x, int y, const ShownByBall& shown) {
        if (beside && wide.hides(shown.normal, shown.direction))
            rays.add_unknown(shown.direction, shown.steradians);
        else
            rays.add(shown.direction, mirror.pixels->pixel(x, y), shown.steradians);
    });
    rays.fill();
    return rays;
}

/// Irradiance of a place on the grey ball by rays before which the mirror ball does not stand.
Rgb direct_light(V3d normal, const BallBeside& mirror, const std::vector<Ray>& rays) {
    Rgb sum{};
    for (const Ray& ray : rays) {
        const double cosine = normal.dot(ray.direction);
        if (cosine <= 0 || mirror.hides(normal, ray.direction)) continue;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += cosine * ray.flux[c];
    }
    return sum;
}

/// What the mirror ball, if it reflects all, throws there. sky: radiance from far away; rays: its
/// directions all around.
Rgb thrown_light(V3d normal, const BallBeside& mirror, const std::vector<Ray>& rays,
                 const Rays& sky) {
    Rgb sum{};
    for (const Ray& ray : rays) {
        const double cosine = normal.dot(ray.direction);
        if (cosine <= 0) continue;
        const auto place = mirror.met(normal, ray.direction);
        if (!place) continue;
        const Rgb radiance = sky.radiance(mirror.reflected(*place, ray.direction));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += cosine * ray.steradians * radiance[c];
    }
    return sum;
}

/// Which unknowns are used.
using Columns = std::vector<std::size_t>;

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// One channel: what the grey ball's facets show is columns times unknowns, plus what is known.
struct Channel {
    std::vector<EquationColumn> columns;
    std::vector<double> known, shown;

    /// What unknowns leave unexplained.
    std::vector<double> off(const std::vector<double>& x) const {
        std::vector<double> left = combined(columns, x, shown.size());
        for (std::size_t i = 0; i < left.size(); ++i) left[i] += known[i] - shown[i];
        return left;
    }

    /// The unknowns of some columns, the others 0. Shadows and stands are outliers.
    std::vector<double> solve(const Columns& used) const {
        std::vector<EquationColumn> part;
        for (const std::size_t i : used) part.push_back(columns[i]);
        std::vector<double> wanted = shown;
        for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] -= known[i];
        const auto found = robust_non_negative(part, wanted, 1e-3 * mean(shown));
        std::vector<double> all(columns.size());
        for (std::size_t i = 0; i < used.size(); ++i) all[used[i]] = found[i];
        return all;
    }
};

/// All three at once.
using Channels = std::array<Channel, 3>;
using Solution = std::array<std::vector<double>, 3>;

Solution solution_of(const Channels& channels, const Columns& used) {
    return {channels[0].solve(used), channels[1].solve(used), channels[2].solve(used)};
}

/// What is left unexplained: mean magnitudes, as parts of the means.
double misfit_of(const Channels& channels, const Solution& x) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> off = channels[c].off(x[c]);
        for (double& v : off) v = std::abs(v);
        sum += mean(off) / mean(channels[c].shown);
    }
    return sum;
}

/// Which part of the grey ball's light a region explains, of the channel of which most.
double part_of(const Channels& channels, const Solution& x, std::size_t region) {
    double most = 0;
    for (std::size_t c = 0; c < 3; ++c)
        most = std::max(most,
                        mean(channels[c].columns[region]) * x[c][region] / mean(channels[c].shown));
    return most;
}

/// The fewest regions that explain the grey ball, the same of all channels: one more as long as
/// that explains clearly more. With all of them free, regions that hardly light the side which the
/// camera sees would take any amount of light to mend what stands, noise and paint do there: of
/// these each explains a thousandth of the ball's light, by thousands of times its own brightness.
Solution fewest_regions(const Channels& channels, std::size_t regions) {
    constexpr double kClearly = 0.95, kLeastPart = 0.01;
    Columns used;
    for (std::size_t i = regions; i < channels[0].columns.size(); ++i) used.push_back(i);
    Solution best = solution_of(channels, used);
    double misfit = misfit_of(channels, best);
    std::vector<bool> taken(regions);
    for (std::size_t round = 0; round < regions; ++round) {
        std::optional<std::size_t> next;
        double least = kClearly * misfit;
        for (std::size_t i = 0; i < regions; ++i) {
            if (taken[i]) continue;
            used.push_back(i);
            const Solution one = solution_of(channels, used);
            used.pop_back();
            const double its = misfit_of(channels, one);
            if (its < least && part_of(channels, one, i) > kLeastPart) {
                least = its;
                next = i;
                best = one;
            }
        }
        if (!next) break;
        misfit = least;
        taken[*next] = true;
        used.push_back(*next);
    }
    return best;
}

/// Irradiance of the grey ball's facets.
struct Lighting {
    std::vector<Rgb> sky;     ///< a facet: by what the mirror ball shows
    std::vector<Rgb> thrown;  ///< a facet: by all that a perfect mirror throws there
    std::vector<std::vector<Rgb>> by_region;  ///< a region, a facet: by radiance 1
};

Lighting lighting_of(const BallPicture& mirror, const BallPicture& grey,
                     const std::vector<GreyFacet>& facets,
                     const std::vector<ClippedRegion>& regions) {
    const BallBeside mirror_beside = ball_beside(grey.ball, mirror.ball);
    const BallBeside grey_beside = ball_beside(mirror.ball, grey.ball);
    const Rays sky = rays_of(mirror, &grey_beside);
    const std::vector<Ray> rays = sky.take();
    Lighting lighting;
    for (const GreyFacet& facet : facets) {
        lighting.sky.push_back(direct_light(facet.normal, mirror_beside, rays));
        lighting.thrown.push_back(thrown_light(facet.normal, mirror_beside, rays, sky));
    }
    for (const ClippedRegion& region : regions) {
        const std::vector<Ray> part = region_rays(mirror, region).take();
        std::vector<Rgb> light;
        for (const GreyFacet& facet : facets)
            light.push_back(direct_light(facet.normal, mirror_beside, part));
        lighting.by_region.push_back(std::move(light));
    }
    return lighting;
}

/// What each channel of the facets says: columns are the regions, then what the mirror ball throws
/// on them (in parts that nobody knows: its reflectance, and what stands between), then, if it is
/// to be found, the ball's reflectance.
Channels equations(const std::vector<GreyFacet>& facets, const Lighting& lighting,
                   const GreyBallOptions& options) {
    Channels channels;
    for (std::size_t c = 0; c < 3; ++c) {
        Channel& channel = channels[c];
        const double unit = options.reflectance[c] / pi;
        const auto column = [&](const std::vector<Rgb>& light) {
            EquationColumn values;
            for (const Rgb& rgb : light) values.push_back(unit * rgb[c]);
            return values;
        };
        for (const GreyFacet& facet : facets) channel.shown.push_back(facet.shown[c]);
        for (const auto& light : lighting.by_region) channel.columns.push_back(column(light));
        channel.columns.push_back(column(lighting.thrown));
        if (options.solve_reflectance) {
            channel.columns.push_back(column(lighting.sky));
            channel.known.assign(facets.size(), 0);
        } else {
            channel.known = column(lighting.sky);
        }
    }
    return channels;
}

double rms(const std::vector<double>& values) {
    double squares = 0;
    for (const double v : values) squares += v * v;
    return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

GreyBallFit solve_missing_light(const BallPicture& mirror, const std::vector<char>& clipped,
                                const BallPicture& grey, const std::vector<char>& usable,
                                const GreyBallOptions& options) {
    assert(clipped.size() == mirror.pixels->size().pixels());
    assert(usable.size() == grey.pixels->size().pixels());
    GreyBallFit fit;
    fit.regions = clipped_regions(mirror, clipped);
    const std::vector<GreyFacet> facets =
        grey_facets(grey, usable, ball_beside(grey.ball, mirror.ball));
    fit.pixels = 0;
    for (const GreyFacet& facet : facets) fit.pixels += static_cast<std::size_t>(facet.pixels);
    fit.reflectance = options.reflectance;
    if (facets.size() < 8) return fit;  // nothing to hold it against

    const Lighting lighting = lighting_of(mirror, grey, facets, fit.regions);
    const Channels channels = equations(facets, lighting, options);
    const std::size_t regions = fit.regions.size();
    const Solution solution = fewest_regions(channels, regions);
    double squares = 0, before = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel& channel = channels[c];
        const std::vector<double>& x = solution[c];
        double share = 1;
        if (options.solve_reflectance) {
            share = std::max(1e-9, x[regions + 1]);
            fit.reflectance[c] *= share;
        }
        std::vector<double> none = x;
        std::fill_n(none.begin(), regions, 0.0);
        squares += std::pow(rms(channel.off(x)) / mean(channel.shown), 2);
        before += std::pow(rms(channel.off(none)) / mean(channel.shown), 2);
        for (std::size_t r = 0; r < regions; ++r) {
            ClippedRegion& region = fit.regions[r];
            region.missing[c] = x[r] / share;
            fit.irradiance[c] += region.missing[c] * region.steradians;
        }
    }
    fit.residual = std::sqrt(squares / 3);
    fit.residual_before = std::sqrt(before / 3);
    return fit;
}

void add_missing_light(Image& pixels, const GreyBallFit& fit) {
    const auto width = static_cast<std::size_t>(pixels.width());
    for (const ClippedRegion& region : fit.regions)
        for (const std::size_t at : region.pixels) {
            float* p = pixels.pixel(static_cast<int>(at % width), static_cast<int>(at / width));
            const float alpha = pixels.channels() > 3 ? p[3] : 1;
            for (std::size_t c = 0; c < 3; ++c)
                p[c] += alpha * static_cast<float>(region.missing[c]);
        }
}

std::array<double, 3> irradiance_from(const BallPicture& mirror, V3d normal) {
    return irradiance_of(rays_of(mirror, nullptr).take(), normal.normalized());
}

}  // namespace chromeball
