#include "light/grey_ball.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/statistics.h"

namespace chromeball {
namespace {

using std::numbers::pi;
using Rgb = std::array<double, 3>;

/// Light from a small part of the sphere.
struct Ray {
    V3d direction{0, 0, 0};  ///< unit vector
    Rgb flux{};              ///< radiance times steradians
    double steradians = 0;
};

/// The sphere in pieces of equal height and about equal area, so that a hundred thousand pixels
/// become a few thousand rays.
class Rays {
public:
    void add(V3d d, const float* rgb, double steradians) {
        const auto row =
            static_cast<std::size_t>(std::clamp((d.y + 1) / 2 * kRows, 0.0, kRows - 1.0));
        const double around = std::atan2(d.x, d.z) / (2 * pi) + 0.5;
        const auto column =
            static_cast<std::size_t>(std::clamp(around * kColumns, 0.0, kColumns - 1.0));
        Ray& ray = rays_[row * kColumns + column];
        ray.direction += d * steradians;
        ray.steradians += steradians;
        for (std::size_t c = 0; c < 3; ++c) ray.flux[c] += static_cast<double>(rgb[c]) * steradians;
    }
    /// Those that hold anything.
    std::vector<Ray> take() const {
        std::vector<Ray> all;
        for (Ray ray : rays_) {
            if (!(ray.steradians > 0)) continue;
            ray.direction.normalize();
            all.push_back(ray);
        }
        return all;
    }
    /// The same, and what the photo does not show (behind the ball, beyond the picture's edge) as
    /// bright as what lies around it.
    std::vector<Ray> take_filled() const {
        constexpr double kCell = 4 * pi / (kRows * kColumns);
        const std::vector<Ray> known = take();
        std::vector<Ray> all = known;
        if (known.empty()) return all;
        // Pixels are no finer than cells, so that even where all is seen some cells hold too little
        // and others too much; together they tell what is not seen.
        double seen = 0, lacking = 0;
        for (const Ray& ray : rays_) {
            seen += ray.steradians;
            lacking += std::max(0.0, kCell - ray.steradians);
        }
        const double part = lacking > 0 ? std::clamp((4 * pi - seen) / lacking, 0.0, 1.0) : 0;
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            const double missing = part * (kCell - rays_[i].steradians);
            if (missing < 0.01 * kCell) continue;
            Ray filled{middle(i), {}, missing};
            double total = 0;
            for (const Ray& ray : known) {
                const double apart = 1 - filled.direction.dot(ray.direction);  // half its square
                const double weight = 1 / (1e-4 + apart * apart * apart);
                total += weight * ray.steradians;
                for (std::size_t c = 0; c < 3; ++c) filled.flux[c] += weight * ray.flux[c];
            }
            for (double& flux : filled.flux) flux *= missing / total;
            all.push_back(filled);
        }
        return all;
    }

private:
    static V3d middle(std::size_t cell) {
        const double y = (static_cast<double>(cell / kColumns) + 0.5) / kRows * 2 - 1;
        const double around =
            ((static_cast<double>(cell % kColumns) + 0.5) / kColumns - 0.5) * 2 * pi;
        const double across = std::sqrt(1 - y * y);
        return {across * std::sin(around), y, across * std::cos(around)};
    }
    static constexpr std::size_t kRows = 48, kColumns = 96;
    std::vector<Ray> rays_ = std::vector<Ray>(kRows * kColumns);
};

/// Calls f(x, y, direction, steradians) for the pixels that show the ball.
template <class F>
void for_ball(const BallPicture& picture, F f) {
    const Affine back = picture.to_pixels.inverse();
    const double area = std::abs(back.determinant());
    for (int y = 0; y < picture.pixels->height(); ++y)
        for (int x = 0; x < picture.pixels->width(); ++x) {
            const V2d position = back(Vec2<double>(x + 0.5, y + 0.5));
            const auto d = picture.ball.to_direction(position);
            if (!d) continue;
            const double steradians = picture.ball.solid_angle(position) * area;
            if (std::isfinite(steradians)) f(x, y, V3d(*d).normalized(), steradians);
        }
}

std::vector<Ray> rays_of(const BallPicture& mirror) {
    Rays rays;
    for_ball(mirror, [&](int x, int y, V3d d, double steradians) {
        rays.add(d, mirror.pixels->pixel(x, y), steradians);
    });
    return rays.take_filled();
}

Rgb irradiance_of(const std::vector<Ray>& rays, V3d normal) {
    Rgb sum{};
    for (const Ray& ray : rays) {
        const double cosine = normal.dot(ray.direction);
        if (cosine <= 0) continue;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += cosine * ray.flux[c];
    }
    return sum;
}

/// Clipped pixels that touch each other, as regions.
std::vector<ClippedRegion> connected(const BallPicture& mirror, std::vector<char> clipped) {
    const int width = mirror.pixels->width(), height = mirror.pixels->height();
    std::vector<double> steradians(clipped.size());
    std::vector<V3d> direction(clipped.size());
    for_ball(mirror, [&](int x, int y, V3d d, double omega) {
        const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x);
        steradians[at] = omega;
        direction[at] = d;
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

/// The mirror ball as the grey one has it beside itself, in its own radii from its own middle.
struct Neighbour {
    V3d centre;
    double radius = 0;

    /// The part of what lights a place of the grey ball, by cosine, that the mirror ball hides.
    double share(V3d normal) const {
        const V3d to = centre - normal;
        const double distance = to.length();
        if (distance <= radius) return 1;
        const V3d axis = to / distance;
        const double sine = radius / distance, cosine = std::sqrt(1 - sine * sine);
        if (normal.dot(axis) <= -sine) return 0;
        if (normal.dot(axis) >= sine) return normal.dot(axis) * sine * sine;  // all above horizon
        const V3d side = axis.cross(std::abs(axis.x) < 0.6 ? V3d(1, 0, 0) : V3d(0, 1, 0));
        const V3d e1 = side.normalized(), e2 = axis.cross(e1);
        constexpr int kRings = 6, kAround = 12;
        double sum = 0;
        for (int ring = 0; ring < kRings; ++ring)
            for (int i = 0; i < kAround; ++i) {  // of equal solid angles
                const double c = 1 - (1 - cosine) * (ring + 0.5) / kRings;
                const double s = std::sqrt(1 - c * c), turn = 2 * pi * (i + 0.5) / kAround;
                const V3d d = axis * c + e1 * (s * std::cos(turn)) + e2 * (s * std::sin(turn));
                sum += std::max(0.0, d.dot(normal));
            }
        return sum / (kRings * kAround) * 2 * (1 - cosine);
    }
};

/// Nobody tells how large both balls are; they are taken to stand equally far from the camera, as
/// such balls are put beside each other.
Neighbour neighbour_of(const MirrorBall& mirror, const MirrorBall& grey) {
    if (mirror.orthographic() || grey.orthographic()) {
        const Outline &m = mirror.outline(), &g = grey.outline();
        const double radius = std::sqrt(g.a * g.b);
        return {V3d((m.cx - g.cx) / radius, (g.cy - m.cy) / radius, 0),
                std::sqrt(m.a * m.b) / radius};
    }
    const V3d here = grey.axis() * grey.distance();
    const double radius = here.dot(mirror.axis()) / mirror.distance();
    return {mirror.axis() * (mirror.distance() * radius) - here, radius};
}

/// A part of the grey ball: its normal and what it shows.
struct Facet {
    V3d normal;
    Rgb shown{};
    int pixels = 0;
};

/// Means over small squares of the grey ball's inside.
std::vector<Facet> facets_of(const BallPicture& grey, const std::vector<char>& usable,
                             const Neighbour& neighbour) {
    constexpr int kAcross = 40;  // squares over the ball's width
    const Outline& e = grey.ball.outline();
    const double radius = std::sqrt(e.a * e.b * std::abs(grey.to_pixels.determinant()));
    const int side = std::max(1, static_cast<int>(2 * radius / kAcross));
    const int columns = grey.pixels->width() / side + 1;
    std::vector<Facet> cells(static_cast<std::size_t>(columns) *
                             static_cast<std::size_t>(grey.pixels->height() / side + 1));
    const Affine back = grey.to_pixels.inverse();
    for_ball(grey, [&](int x, int y, V3d d, double) {
        const auto at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(grey.pixels->width()) +
            static_cast<std::size_t>(x);
        if (!usable[at]) return;
        const V3d view = grey.ball.ray(back(Vec2<double>(x + 0.5, y + 0.5)));
        const V3d normal = (d - view).normalized();  // d = view - 2 (view.n) n
        // Away from the rim, where lens blur mixes in what is behind, and paint is no diffuser.
        constexpr double kGrazing = 0.35;
        if (-normal.dot(view) < kGrazing) return;
        Facet& cell = cells[static_cast<std::size_t>(y / side) * static_cast<std::size_t>(columns) +
                            static_cast<std::size_t>(x / side)];
        cell.normal += normal;
        ++cell.pixels;
        for (std::size_t c = 0; c < 3; ++c)
            cell.shown[c] += static_cast<double>(grey.pixels->pixel(x, y)[c]);
    });
    std::vector<Facet> facets;
    for (Facet cell : cells) {
        if (cell.pixels < std::max(1, side * side / 8)) continue;
        cell.normal.normalize();
        // What the mirror ball hides from there and what it throws there in its place is a guess;
        // facing it that would be a third of the light.
        constexpr double kMost = 0.05;
        if (neighbour.share(cell.normal) > kMost) continue;
        for (double& v : cell.shown) v /= cell.pixels;
        facets.push_back(cell);
    }
    return facets;
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

/// The fewest regions that explain the grey ball, the same of all channels: one more as long as
/// that explains clearly more. With all of them free, regions that hardly light the side which the
/// camera sees would take any amount of light to mend what stands, noise and paint do there.
Solution fewest_regions(const Channels& channels, Eigen::Index regions) {
    constexpr double kClearly = 0.95;
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
            if (const double its = misfit_of(channels, one); its < least) {
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

double rms(const Vector& v) { return std::sqrt(v.squaredNorm() / static_cast<double>(v.size())); }

}  // namespace

GreyBallFit solve_missing_light(const BallPicture& mirror, const std::vector<char>& clipped,
                                const BallPicture& grey, const std::vector<char>& usable,
                                const GreyBallOptions& options) {
    assert(clipped.size() == mirror.pixels->size().pixels());
    assert(usable.size() == grey.pixels->size().pixels());
    GreyBallFit fit;
    fit.regions = told_apart(connected(mirror, clipped));
    const std::vector<Facet> facets = facets_of(grey, usable, neighbour_of(mirror.ball, grey.ball));
    fit.pixels = 0;
    for (const Facet& facet : facets) fit.pixels += static_cast<std::size_t>(facet.pixels);
    fit.reflectance = options.reflectance;
    if (facets.size() < 8) return fit;  // nothing to hold it against

    const std::vector<Ray> rays = rays_of(mirror);
    std::vector<Rgb> lit;
    for (const Facet& facet : facets) lit.push_back(irradiance_of(rays, facet.normal));
    // Irradiance of a facet by a region of radiance 1: its pixels, not its middle alone.
    const int width = mirror.pixels->width();
    const Affine back = mirror.to_pixels.inverse();
    const double area = std::abs(back.determinant());
    std::vector<std::vector<Ray>> parts;
    for (const ClippedRegion& region : fit.regions) {
        Rays some;
        const float one[] = {1, 1, 1};
        for (const std::size_t at : region.pixels) {
            const V2d position =
                back(Vec2<double>(static_cast<double>(at % static_cast<std::size_t>(width)) + 0.5,
                                  static_cast<double>(at / static_cast<std::size_t>(width)) + 0.5));
            if (const auto d = mirror.ball.to_direction(position))
                some.add(V3d(*d).normalized(), one, mirror.ball.solid_angle(position) * area);
        }
        parts.push_back(some.take());
    }

    const auto rows = static_cast<Eigen::Index>(facets.size());
    const auto regions = static_cast<Eigen::Index>(fit.regions.size());
    const Eigen::Index unknowns = regions + (options.solve_reflectance ? 1 : 0);
    Channels channels;
    for (std::size_t c = 0; c < 3; ++c) {
        Channel& channel = channels[c];
        channel.columns = Matrix(rows, unknowns);
        channel.known = Vector::Zero(rows);
        channel.shown = Vector(rows);
        const double unit = options.reflectance[c] / pi;
        for (Eigen::Index i = 0; i < rows; ++i) {
            const Facet& facet = facets[static_cast<std::size_t>(i)];
            const double base = unit * lit[static_cast<std::size_t>(i)][c];
            channel.shown[i] = facet.shown[c];
            if (options.solve_reflectance)
                channel.columns(i, regions) = base;
            else
                channel.known[i] = base;
            for (Eigen::Index r = 0; r < regions; ++r)
                channel.columns(i, r) =
                    unit * irradiance_of(parts[static_cast<std::size_t>(r)], facet.normal)[c];
        }
    }
    const Solution solution = fewest_regions(channels, regions);
    double squares = 0, before = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel& channel = channels[c];
        const Vector& x = solution[c];
        Vector bare = channel.known;
        double share = 1;
        if (options.solve_reflectance) {
            share = std::max(1e-9, x[regions]);
            bare = channel.columns.col(regions) * share;
            fit.reflectance[c] *= share;
        }
        const double mean = channel.shown.mean();
        squares += std::pow(rms(channel.explained(x) - channel.shown) / mean, 2);
        before += std::pow(rms(bare - channel.shown) / mean, 2);
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
    return irradiance_of(rays_of(mirror), normal.normalized());
}

}  // namespace chromeball
