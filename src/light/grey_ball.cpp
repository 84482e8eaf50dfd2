#include "light/grey_ball.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/statistics.h"
#include "light/ball_beside.h"
#include "light/rays.h"
#include "light/view.h"

namespace chromeball {
namespace {

using std::numbers::pi;
using Rgb = std::array<double, 3>;

/// What a pixel shows of a ball.
struct Shown {
    V3d view;       ///< from the camera
    V3d normal;     ///< of the ball there
    V3d direction;  ///< that is mirrored there
    double steradians = 0;
};

/// Calls f(x, y, shown) for the pixels that show the ball.
template <class F>
void for_ball(const BallPicture& picture, F f) {
    const Affine back = picture.to_pixels.inverse();
    const double area = std::abs(back.determinant());
    for (int y = 0; y < picture.pixels->height(); ++y)
        for (int x = 0; x < picture.pixels->width(); ++x) {
            const V2d position = back(Vec2<double>(x + 0.5, y + 0.5));
            const auto d = picture.ball.to_direction(position);
            if (!d) continue;
            const V3d direction = V3d(*d).normalized(), view = picture.ball.ray(position);
            // direction = view - 2 (view.n) n
            const Shown shown{view, (direction - view).normalized(), direction,
                              picture.ball.solid_angle(position) * area};
            if (std::isfinite(shown.steradians)) f(x, y, shown);
        }
}

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
    for_ball(mirror, [&](int x, int y, const Shown& shown) {
        if (beside && wide.hides(shown.normal, shown.direction))
            rays.add_unknown(shown.direction, shown.steradians);
        else
            rays.add(shown.direction, mirror.pixels->pixel(x, y), shown.steradians);
    });
    rays.fill();
    return rays;
}

/// Clipped pixels that touch each other, as regions.
std::vector<ClippedRegion> connected(const BallPicture& mirror, std::vector<char> clipped) {
    const int width = mirror.pixels->width(), height = mirror.pixels->height();
    std::vector<double> steradians(clipped.size());
    std::vector<V3d> direction(clipped.size());
    for_ball(mirror, [&](int x, int y, const Shown& shown) {
        const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x);
        steradians[at] = shown.steradians;
        direction[at] = shown.direction;
    });
    std::vector<ClippedRegion> regions;
    for (std::size_t start = 0; start < clipped.size(); ++start) {
        if (!clipped[start] || !(steradians[start] > 0)) continue;
        ClippedRegion region;
        V3d sum(0, 0, 0);
        region.pixels.push_back(start);
        clipped[start] = 0;
        for (std::size_t n = 0; n < region.pixels.size(); ++n) {
            const std::size_t at = region.pixels[n];
            sum += direction[at] * steradians[at];
            region.steradians += steradians[at];
            const int x = static_cast<int>(at % static_cast<std::size_t>(width));
            const int y = static_cast<int>(at / static_cast<std::size_t>(width));
            for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j)
                for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i) {
                    const auto next =
                        static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(i);
                    if (!clipped[next] || !(steradians[next] > 0)) continue;
                    clipped[next] = 0;
                    region.pixels.push_back(next);
                }
        }
        region.direction = sum.normalized();
        regions.push_back(std::move(region));
    }
    return regions;
}

/// Radiance 1 from all of its pixels, not from its middle alone.
Rays rays_of(const BallPicture& mirror, const ClippedRegion& region) {
    const auto width = static_cast<std::size_t>(mirror.pixels->width());
    const Affine back = mirror.to_pixels.inverse();
    const double area = std::abs(back.determinant());
    Rays rays;
    const float one[] = {1, 1, 1};
    for (const std::size_t at : region.pixels) {
        const V2d position = back(Vec2<double>(static_cast<double>(at % width) + 0.5,
                                               static_cast<double>(at / width) + 0.5));
        if (const auto d = mirror.ball.to_direction(position))
            rays.add(V3d(*d).normalized(), one, mirror.ball.solid_angle(position) * area);
    }
    return rays;
}

void absorb(ClippedRegion& into, const ClippedRegion& other) {
    into.direction =
        (into.direction * into.steradians + other.direction * other.steradians).normalized();
    into.steradians += other.steradians;
    into.pixels.insert(into.pixels.end(), other.pixels.begin(), other.pixels.end());
}

/// A diffuse ball blurs what is closer than this; such regions share one unknown.
std::vector<ClippedRegion> told_apart(std::vector<ClippedRegion> regions) {
    constexpr double kCosine = 0.94;  // 20 degrees
    constexpr std::size_t kMost = 6;
    std::ranges::sort(regions, std::greater{}, &ClippedRegion::steradians);
    std::vector<ClippedRegion> kept;
    for (const ClippedRegion& region : regions) {
        const auto nearest = std::ranges::max_element(kept, {}, [&](const ClippedRegion& one) {
            return one.direction.dot(region.direction);
        });
        const bool near =
            nearest != kept.end() && nearest->direction.dot(region.direction) > kCosine;
        if (near || (nearest != kept.end() && kept.size() >= kMost))
            absorb(*nearest, region);
        else
            kept.push_back(region);
    }
    return kept;
}

/// A part of the grey ball: its normal and what it shows.
struct Facet {
    V3d normal;
    Rgb shown{};
    int pixels = 0;
};

/// The part of an even light that the mirror ball hides from a place on the grey one.
double hidden_part(V3d normal, const BallBeside& mirror, const std::vector<V3d>& directions) {
    double hidden = 0, all = 0;
    for (const V3d& d : directions) {
        const double cosine = std::max(0.0, normal.dot(d));
        all += cosine;
        if (cosine > 0 && mirror.hides(normal, d)) hidden += cosine;
    }
    return hidden / all;
}

/// Means over small squares of the grey ball's inside.
std::vector<Facet> facets_of(const BallPicture& grey, const std::vector<char>& usable,
                             const BallBeside& mirror) {
    constexpr int kAcross = 40;  // squares over the ball's width
    const Outline& e = grey.ball.outline();
    const double radius = std::sqrt(e.a * e.b * std::abs(grey.to_pixels.determinant()));
    const int side = std::max(1, static_cast<int>(2 * radius / kAcross));
    const int columns = grey.pixels->width() / side + 1;
    std::vector<Facet> cells(static_cast<std::size_t>(columns) *
                             static_cast<std::size_t>(grey.pixels->height() / side + 1));
    for_ball(grey, [&](int x, int y, const Shown& shown) {
        const auto at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(grey.pixels->width()) +
            static_cast<std::size_t>(x);
        if (!usable[at]) return;
        // Away from the rim, where lens blur mixes in what is behind, and paint is no diffuser.
        constexpr double kGrazing = 0.35;
        if (-shown.normal.dot(shown.view) < kGrazing) return;
        Facet& cell = cells[static_cast<std::size_t>(y / side) * static_cast<std::size_t>(columns) +
                            static_cast<std::size_t>(x / side)];
        cell.normal += shown.normal;
        ++cell.pixels;
        for (std::size_t c = 0; c < 3; ++c)
            cell.shown[c] += static_cast<double>(grey.pixels->pixel(x, y)[c]);
    });
    const auto directions = fibonacci_directions(1000);
    std::vector<Facet> facets;
    for (Facet cell : cells) {
        if (cell.pixels < std::max(1, side * side / 8)) continue;
        cell.normal.normalize();
        // What the mirror ball throws there in place of what it hides (lamps drawn out, itself) is
        // not known well; facing it that would be a third of the light.
        constexpr double kMost = 0.05;
        if (hidden_part(cell.normal, mirror, directions) > kMost) continue;
        for (double& v : cell.shown) v /= cell.pixels;
        facets.push_back(cell);
    }
    return facets;
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

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// Least squares with no unknown below 0: Lawson and Hanson, Solving Least Squares Problems, 1974,
/// chapter 23, on normal equations; unknowns are few.
Vector not_negative(const Matrix& normal, const Vector& right) {
    const Eigen::Index n = right.size();
    Vector x = Vector::Zero(n);
    std::vector<bool> free(static_cast<std::size_t>(n));
    for (Eigen::Index round = 0; round < 3 * n; ++round) {
        const Vector slope = right - normal * x;
        Eigen::Index best = -1;
        for (Eigen::Index i = 0; i < n; ++i)
            if (!free[static_cast<std::size_t>(i)] && slope[i] > 1e-12 * std::abs(right[i]) &&
                (best < 0 || slope[i] > slope[best]))
                best = i;
        if (best < 0) break;
        free[static_cast<std::size_t>(best)] = true;
        for (;;) {
            Matrix held = normal;
            Vector wanted = right;
            for (Eigen::Index i = 0; i < n; ++i) {
                if (free[static_cast<std::size_t>(i)]) continue;
                held.row(i).setZero();
                held.col(i).setZero();
                held(i, i) = 1;
                wanted[i] = 0;
            }
            const Vector z = held.ldlt().solve(wanted);
            double part = 1;
            for (Eigen::Index i = 0; i < n; ++i)
                if (free[static_cast<std::size_t>(i)] && z[i] <= 0 && x[i] > z[i])
                    part = std::min(part, x[i] / (x[i] - z[i]));
            x += part * (z - x);
            if (part == 1) break;
            for (Eigen::Index i = 0; i < n; ++i)
                if (free[static_cast<std::size_t>(i)] && x[i] <= 1e-15)
                    free[static_cast<std::size_t>(i)] = false, x[i] = 0;
        }
    }
    return x;
}

using Columns = std::vector<Eigen::Index>;

/// One channel: the grey ball's facets are columns times unknowns, plus what is known.
struct Channel {
    Matrix columns;
    Vector known, shown;

    Vector explained(const Vector& x) const { return columns * x + known; }

    /// The unknowns of some columns, the others 0. Huber's weights in a few rounds; shadows and
    /// stands are outliers.
    Vector solve(const Columns& used) const {
        Vector all = Vector::Zero(columns.cols());
        if (used.empty()) return all;
        all(used) = solved(columns(Eigen::all, used));
        return all;
    }

private:
    Vector solved(const Matrix& part) const {
        Vector weights = Vector::Ones(shown.size());
        Vector x;
        for (int round = 0; round < 12; ++round) {
            const Matrix weighted = weights.asDiagonal() * part;
            Matrix normal = weighted.transpose() * part;
            // Regions that the ball cannot tell apart share the light rather than fight over it.
            normal.diagonal() *= 1 + 1e-6;
            x = not_negative(normal, weighted.transpose() * (shown - known));
            const Vector off = (part * x + known - shown).cwiseAbs();
            const double middle = median({off.begin(), off.end()});
            const double far = std::max(2.5 * middle, 1e-3 * shown.mean());
            for (Eigen::Index i = 0; i < off.size(); ++i)
                weights[i] = off[i] > far ? far / off[i] : 1;
        }
        return x;
    }
};

/// All three at once.
using Channels = std::array<Channel, 3>;
using Solution = std::array<Vector, 3>;

Solution solution_of(const Channels& channels, const Columns& used) {
    return {channels[0].solve(used), channels[1].solve(used), channels[2].solve(used)};
}

/// What is left unexplained: mean magnitudes, as parts of the means.
double misfit_of(const Channels& channels, const Solution& x) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
        sum += (channels[c].explained(x[c]) - channels[c].shown).cwiseAbs().mean() /
               channels[c].shown.mean();
    return sum;
}

/// Which part of the grey ball's light a region explains, of the channel of which most.
double part_of(const Channels& channels, const Solution& x, Eigen::Index region) {
    double most = 0;
    for (std::size_t c = 0; c < 3; ++c)
        most = std::max(
            most, channels[c].columns.col(region).mean() * x[c][region] / channels[c].shown.mean());
    return most;
}

/// The fewest regions that explain the grey ball, the same of all channels: one more as long as
/// that explains clearly more. With all of them free, regions that hardly light the side which the
/// camera sees would take any amount of light to mend what stands, noise and paint do there: of
/// these each explains a thousandth of the ball's light, by thousands of times its own brightness.
Solution fewest_regions(const Channels& channels, Eigen::Index regions) {
    constexpr double kClearly = 0.95, kLeastPart = 0.01;
    Columns used;
    for (Eigen::Index i = regions; i < channels[0].columns.cols(); ++i) used.push_back(i);
    Solution best = solution_of(channels, used);
    double misfit = misfit_of(channels, best);
    std::vector<bool> taken(static_cast<std::size_t>(regions));
    for (Eigen::Index round = 0; round < regions; ++round) {
        std::optional<Eigen::Index> next;
        double least = kClearly * misfit;
        for (Eigen::Index i = 0; i < regions; ++i) {
            if (taken[static_cast<std::size_t>(i)]) continue;
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
        taken[static_cast<std::size_t>(*next)] = true;
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
                     const std::vector<Facet>& facets, const std::vector<ClippedRegion>& regions) {
    const BallBeside mirror_beside = ball_beside(grey.ball, mirror.ball);
    const BallBeside grey_beside = ball_beside(mirror.ball, grey.ball);
    const Rays sky = rays_of(mirror, &grey_beside);
    const std::vector<Ray> rays = sky.take();
    Lighting lighting;
    for (const Facet& facet : facets) {
        lighting.sky.push_back(direct_light(facet.normal, mirror_beside, rays));
        lighting.thrown.push_back(thrown_light(facet.normal, mirror_beside, rays, sky));
    }
    for (const ClippedRegion& region : regions) {
        const std::vector<Ray> part = rays_of(mirror, region).take();
        std::vector<Rgb> light;
        for (const Facet& facet : facets)
            light.push_back(direct_light(facet.normal, mirror_beside, part));
        lighting.by_region.push_back(std::move(light));
    }
    return lighting;
}

/// What each channel of the facets says: columns are the regions, then what the mirror ball throws
/// on them (in parts that nobody knows: its reflectance, and what stands between), then, if it is
/// to be found, the ball's reflectance.
Channels equations(const std::vector<Facet>& facets, const Lighting& lighting,
                   const GreyBallOptions& options) {
    const auto rows = static_cast<Eigen::Index>(facets.size());
    const auto regions = static_cast<Eigen::Index>(lighting.by_region.size());
    Channels channels;
    for (std::size_t c = 0; c < 3; ++c) {
        Channel& channel = channels[c];
        channel.columns = Matrix(rows, regions + (options.solve_reflectance ? 2 : 1));
        channel.known = Vector::Zero(rows);
        channel.shown = Vector(rows);
        const double unit = options.reflectance[c] / pi;
        for (Eigen::Index i = 0; i < rows; ++i) {
            const auto facet = static_cast<std::size_t>(i);
            channel.shown[i] = facets[facet].shown[c];
            for (Eigen::Index r = 0; r < regions; ++r)
                channel.columns(i, r) =
                    unit * lighting.by_region[static_cast<std::size_t>(r)][facet][c];
            channel.columns(i, regions) = unit * lighting.thrown[facet][c];
            if (options.solve_reflectance)
                channel.columns(i, regions + 1) = unit * lighting.sky[facet][c];
            else
                channel.known[i] = unit * lighting.sky[facet][c];
        }
    }
    return channels;
}

double rms(const Vector& v) { return std::sqrt(v.squaredNorm() / static_cast<double>(v.size())); }

}  // namespace

GreyBallFit solve_missing_light(const BallPicture& mirror, const std::vector<char>& clipped,
                                const BallPicture& grey, const std::vector<char>& usable,
                                const GreyBallOptions& options) {
    assert(clipped.size() == mirror.pixels->size().pixels());
    assert(usable.size() == grey.pixels->size().pixels());
    GreyBallFit fit;
    fit.regions = told_apart(connected(mirror, clipped));
    const std::vector<Facet> facets = facets_of(grey, usable, ball_beside(grey.ball, mirror.ball));
    fit.pixels = 0;
    for (const Facet& facet : facets) fit.pixels += static_cast<std::size_t>(facet.pixels);
    fit.reflectance = options.reflectance;
    if (facets.size() < 8) return fit;  // nothing to hold it against

    const Lighting lighting = lighting_of(mirror, grey, facets, fit.regions);
    const Channels channels = equations(facets, lighting, options);
    const auto regions = static_cast<Eigen::Index>(fit.regions.size());
    const Solution solution = fewest_regions(channels, regions);
    double squares = 0, before = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel& channel = channels[c];
        const Vector& x = solution[c];
        double share = 1;
        if (options.solve_reflectance) {
            share = std::max(1e-9, x[regions + 1]);
            fit.reflectance[c] *= share;
        }
        Vector none = x;
        none.head(regions).setZero();
        const double mean = channel.shown.mean();
        squares += std::pow(rms(channel.explained(x) - channel.shown) / mean, 2);
        before += std::pow(rms(channel.explained(none) - channel.shown) / mean, 2);
        for (Eigen::Index r = 0; r < regions; ++r) {
            ClippedRegion& region = fit.regions[static_cast<std::size_t>(r)];
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
