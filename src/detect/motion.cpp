#include "detect/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/core/optim.hpp>
#include <vector>

#include "detect/density.h"
#include "detect/pairs.h"

// On a line along the motion a moving ball is a matter of that line alone: what it shows there at
// one instant it shows, shifted, at every other. So a profile along such a line is the ball's own,
// averaged over the motion, before a background that stands still and shines through for the part
// of the time in which the ball is not there yet. As in edge.cpp the world's light is taken as a
// random walk, on the ball in the square root of the depth inside the rim; with the average this
// makes profiles Gaussian with a covariance that depends on where the rim is in the middle of the
// exposure and on how far it went. Both ends of the smear are seen: where the picture begins to
// change, and where the background is gone. Where the rim runs along the motion it is nearly sharp,
// and profiles across it say the same with the part of the motion that goes across.

namespace chromeball::detecting {
namespace {

/// Half of the motion along a profile, in samples, and the places tried for the rim.
constexpr std::array<double, 8> kLengths{0.5, 1, 1.5, 2, 3, 4, 5, 6};
constexpr double kPlaceStep = 0.5;
constexpr int kPlaces = 25;
constexpr int kHalfPlaces = kPlaces / 2;

// Variances are relative to that of the first sample inside, as in edge.cpp.
constexpr double kJump = 1;
constexpr double kBlur = 0.7;  // sigma, samples
struct Surroundings {
    double background;
    double noise;
};
constexpr std::array<Surroundings, 9> kSurroundings{{{1e-3, 1e-3},
                                                     {1e-3, 1e-2},
                                                     {1e-3, 0.1},
                                                     {1e-2, 1e-3},
                                                     {1e-2, 1e-2},
                                                     {1e-2, 0.1},
                                                     {0.1, 1e-3},
                                                     {0.1, 1e-2},
                                                     {0.1, 0.1}}};

using Row = std::array<double, kSamples>;

/// Part of the exposure during which each sample lies inside of `at`, softened by the blur.
Row covered(double at, double half_motion) {
    constexpr std::array<double, 9> kShifts{-2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2};
    Row part{};
    double all = 0;
    for (const double shift : kShifts) {
        const double weight = std::exp(-0.5 * shift * shift);
        all += weight;
        for (int k = 0; k < kSamples; ++k) {
            const double inside = at - (k - kHalf) + shift * kBlur;
            part[static_cast<std::size_t>(k)] +=
                weight * std::clamp((inside + half_motion) / (2 * half_motion), 0.0, 1.0);
        }
    }
    for (double& p : part) p /= all;
    return part;
}

/// The ball's part of the covariance.
Square ball_covariance(double rim, double half_motion) {
    Square c{};
    add_square(c, covered(rim, half_motion), kJump);
    double depth = 0;
    while (rim - depth > -kHalf - half_motion - 1) {
        const double next = depth + (depth < 1 ? 0.25 : depth < 3 ? 0.5 : 1);
        add_square(c, covered(rim - 0.5 * (depth + next), half_motion),
                   std::sqrt(next) - std::sqrt(depth));
        depth = next;
    }
    return c;
}

/// The background's, a walk of variance 1 a sample away from the rim, as far as it shows.
Square background_covariance(double rim, const Row& ball) {
    Square c{};
    for (std::size_t i = 0; i < kSamples; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            const double a = static_cast<double>(i) - kHalf - rim;
            const double b = static_cast<double>(j) - kHalf - rim;
            if ((a < 0) == (b < 0))
                c[i][j] = std::min(std::abs(a), std::abs(b)) * (1 - ball[i]) * (1 - ball[j]);
        }
    return c;
}

/// All densities there are: they depend on nothing but the numbers above.
struct Bank {
    std::vector<Density> rims;  ///< length by length, place by place, kind by kind
    std::vector<Density> none;  ///< profiles without a rim, kind by kind

    Bank() {
        for (const double half_motion : kLengths)
            for (int place = 0; place < kPlaces; ++place) {
                const double rim = (place - kHalfPlaces) * kPlaceStep;
                const Square ball = ball_covariance(rim, half_motion);
                const Square back = background_covariance(rim, covered(rim, half_motion));
                for (const auto& [background, noise] : kSurroundings) {
                    Square all = ball;
                    add(all, back, background);
                    rims.push_back(density_of(all, noise));
                }
            }
        const Square walk = background_covariance(-kHalf - 2, Row{});
        for (const auto& [background, noise] : kSurroundings) {
            Square all{};
            add(all, walk, background);
            none.push_back(density_of(all, noise));
        }
    }
};

const Bank& bank() {
    static const Bank all;
    return all;
}

/// With the surroundings that fit each best.
std::array<float, kBatch> least_cost(const Batch& batch, const Density* densities) {
    Least least;
    for (std::size_t kind = 0; kind < kSurroundings.size(); ++kind)
        least.take(batch, densities[kind]);
    return least.costs();
}

/// What is sought, relative to the guess; pixels.
struct Change {
    double along = 0, across = 0;  ///< of the middle, along and across the motion
    double radius = 0;
    double half_motion = 0;
    double stretch = 0;  ///< of the radius towards the principal point, less that across
    double turn = 0;     ///< of the motion, times the radius
};
constexpr int kUnknowns = 6;
using Unknowns = std::array<double, kUnknowns>;

Change change_of(const double* x) { return {x[0], x[1], x[2], x[3], x[4], x[5]}; }
Unknowns unknowns_of(const Change& c) {
    return {c.along, c.across, c.radius, c.half_motion, c.stretch, c.turn};
}

/// A ball moving along +-`way`.
struct Guess {
    Shape shape;
    V2d way;             ///< unit vector
    double half_motion;  ///< pixels
    V2d towards;         ///< the principal point, as a double angle

    V2d across() const { return {-way.y, way.x}; }
    /// First order in the ellipticity, as everywhere with Shapes.
    double radius_towards(const V2d& d) const {
        return shape.radius * (1 + shape.e1 * (d.x * d.x - d.y * d.y) + shape.e2 * 2 * d.x * d.y);
    }
    /// How far the rim is from the line through the middle across the motion, on a line `y` beside
    /// the middle; `side` is 1 or -1.
    double chord(double y, int side) const {
        double r = shape.radius;
        for (int round = 0; round < 3; ++round) {
            const double sine = std::clamp(y / r, -0.99, 0.99);
            r = radius_towards(way * (side * std::sqrt(1 - sine * sine)) + across() * sine);
        }
        return std::sqrt(std::max(r * r - y * y, 1e-6));
    }
    double stretch_of(const V2d& d) const {
        return (towards.x * (d.x * d.x - d.y * d.y) + towards.y * 2 * d.x * d.y) / d.length2();
    }
    void take(const Change& c) {
        const V2d shift = way * c.along + across() * c.across;
        way = (way + across() * (c.turn / shape.radius)).normalized();
        shape.x += shift.x, shape.y += shift.y;
        shape.radius += c.radius;
        half_motion += c.half_motion;
        shape.e1 += c.stretch / shape.radius * towards.x;
        shape.e2 += c.stretch / shape.radius * towards.y;
    }
};

/// A line along which the rim is looked at.
struct Line {
    V2d at, outwards;
    double step;
    // How the rim's place on it, pixels outwards, follows from the change, and what the motion is
    // on it.
    double y;        ///< beside the middle; only on lines along the motion
    int side;        ///< -1 or 1 on lines along the motion, 0 across the rim
    V2d normal;      ///< on lines across the rim, along and across the motion
    double stretch;  ///< cosine of the double angle to the principal point
    double chord;    ///< from the middle to the rim on lines along the motion
};

double place_of(const Line& line, double radius, const Change& c) {
    const double grown = c.radius + c.stretch * line.stretch;
    if (line.side == 0) return grown + c.along * line.normal.x + c.across * line.normal.y;
    const auto half_chord = [](double r, double y) {
        return std::sqrt(std::max(r * r - y * y, 1e-3));
    };
    const double now = half_chord(radius + grown, line.y - c.across) / half_chord(radius, line.y);
    return line.chord * (now - 1) + line.side * c.along;
}

/// Part of the motion that goes along the line.
double smear_of(const Line& line, double radius, const Change& c) {
    if (line.side != 0) return 1;
    return std::abs(line.normal.x + line.normal.y * c.turn / radius);
}

/// What a profile says: -2 log likelihood less that of the best.
struct Voice {
    Line line;
    std::array<float, kLengths.size() * kPlaces> excess;
    float without;

    /// Bilinear; lengths and places in samples.
    double at(double length, double place) const {
        const double l =
            std::clamp(length < 2 ? 2 * length - 1 : length + 1, 0.0, kLengths.size() - 1.001);
        const double p = std::clamp(place / kPlaceStep + kHalfPlaces, 0.0, kPlaces - 1.001);
        const auto i = static_cast<std::size_t>(l), j = static_cast<std::size_t>(p);
        const double u = l - static_cast<double>(i), v = p - static_cast<double>(j);
        const float* e = excess.data() + i * kPlaces + j;
        return (1 - u) * ((1 - v) * static_cast<double>(e[0]) + v * static_cast<double>(e[1])) +
               u * ((1 - v) * static_cast<double>(e[kPlaces]) +
                    v * static_cast<double>(e[kPlaces + 1]));
    }
};

std::vector<Voice> voices_of(const std::vector<Line>& lines, const std::vector<Profile>& profiles) {
    std::vector<Voice> voices;
    for (std::size_t first = 0; first < lines.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, lines.size() - first);
        Batch batch;
        for (std::size_t r = 0; r < count; ++r) batch.set(r, profiles[first + r]);
        for (std::size_t r = 0; r < count; ++r) voices.push_back({lines[first + r], {}, 0});
        Voice* here = voices.data() + first;
        for (std::size_t i = 0; i < here->excess.size(); ++i) {
            const auto cost = least_cost(batch, bank().rims.data() + i * kSurroundings.size());
            for (std::size_t r = 0; r < count; ++r) here[r].excess[i] = cost[r];
        }
        const auto without = least_cost(batch, bank().none.data());
        for (std::size_t r = 0; r < count; ++r) {
            auto& excess = here[r].excess;
            const float best = *std::min_element(excess.begin(), excess.end());
            for (float& e : excess) e -= best;
            here[r].without = without[r] - best;
        }
    }
    return voices;
}

constexpr int kDense = 4;  // lines sampled for each that is used

/// Lines side by side, kDense for each one that is used.
std::vector<Line> lines_along(const Guess& guess, int side, double step) {
    constexpr int kLines = 24;
    constexpr double kSpan = 0.85;  // of the radius: further out the rim runs along the lines
    std::vector<Line> lines;
    for (int i = 0; i < kLines * kDense; ++i) {
        const double y = kSpan * guess.shape.radius * ((2 * i + 1.0) / (kLines * kDense) - 1);
        const V2d at = guess.way * (side * guess.chord(y, side)) + guess.across() * y;
        lines.push_back({V2d(guess.shape.x, guess.shape.y) + at, guess.way * side, step, y, side,
                         V2d(0, 0), guess.stretch_of(at), guess.chord(y, side)});
    }
    return lines;
}

std::vector<Line> lines_across(const Guess& guess, int side, double step) {
    constexpr int kLines = 12;
    constexpr double kMostAlong = 0.4;  // of the normal
    const double widest = std::asin(kMostAlong);
    std::vector<Line> lines;
    for (int i = 0; i < kLines * kDense; ++i) {
        const double turn = widest * ((2 * i + 1.0) / (kLines * kDense) - 1);
        const V2d normal(std::sin(turn), side * std::cos(turn));
        const V2d n = guess.way * normal.x + guess.across() * normal.y;
        lines.push_back({V2d(guess.shape.x, guess.shape.y) + n * guess.radius_towards(n), n, step,
                         0, 0, normal, guess.stretch_of(n), 0});
    }
    return lines;
}

Profile profile_of(const Raster<std::uint16_t>& picture, const Line& line) {
    Profile profile{};
    for (int k = 0; k < kSamples; ++k) {
        const V2d p = line.at + line.outwards * ((k - kHalf) * line.step);
        profile[static_cast<std::size_t>(k)] = sample(picture, p.x, p.y, [](std::uint16_t code) {
            return static_cast<float>(code) * (1 / 65535.f);
        });
    }
    return profile;
}

/// Averages neighbours, which show the same rim, and takes one line in kDense. Those that
/// leave the picture are left out.
void look_along(const Raster<std::uint16_t>& picture, const std::vector<Line>& lines,
                std::vector<Line>& used, std::vector<Profile>& profiles_used) {
    std::vector<Profile> profiles;
    for (const Line& line : lines) profiles.push_back(profile_of(picture, line));
    const int count = static_cast<int>(lines.size());
    for (int i = kDense / 2; i < count; i += kDense) {
        Profile mean{};
        for (int j = std::max(0, i - 2 * kDense); j <= std::min(count - 1, i + 2 * kDense); ++j) {
            const double d = double(j - i) / kDense;
            const auto weight = static_cast<float>(std::exp(-0.5 * d * d));
            for (std::size_t k = 0; k < kSamples; ++k)
                mean[k] += weight * profiles[static_cast<std::size_t>(j)][k];
        }
        if (!normalise(mean)) continue;
        used.push_back(lines[static_cast<std::size_t>(i)]);
        profiles_used.push_back(mean);
    }
}

constexpr double kIndependent = 0.5;     // of the profiles: neighbours err alike
constexpr double kAcrossWeight = 0.5;    // of profiles across the rim, which are closer together
constexpr double kOutlier = 0.1;         // likelihood of a profile that shows something else
constexpr double kOutlineSpread = 0.03;  // of the radius: of the guess that all begins with
constexpr double kTurnSpread = 0.12;     // radians
constexpr double kLengthSpread = 0.06;   // of the logarithm of the motion

/// How badly a change of `guess`, which began as `first`, agrees with what the profiles say.
class Misfit : public cv::MinProblemSolver::Function {
public:
    Misfit(const std::vector<Voice>& voices, const Guess& guess, const Guess& first,
           const Lens& lens)
        : voices_(voices), guess_(guess), first_(first), prior_(prior_at(first.shape, lens)) {}

    int getDims() const override { return kUnknowns; }
    double calc(const double* x) const override { return of(change_of(x)); }

    double of(const Change& c) const {
        Guess now = guess_;
        now.take(c);
        const double part = std::max(now.half_motion / first_.half_motion, 0.01);
        double sum = 0.5 * std::pow(std::log(part) / kLengthSpread, 2);
        const double spread = kOutlineSpread * first_.shape.radius;
        const double off2 = std::pow(now.shape.x - first_.shape.x, 2) +
                            std::pow(now.shape.y - first_.shape.y, 2) +
                            std::pow(now.shape.radius - first_.shape.radius, 2);
        sum += 0.5 * off2 / (spread * spread);
        sum += 0.5 * std::pow(first_.way.cross(now.way) / kTurnSpread, 2);
        const double e =
            (now.shape.e1 - prior_.e1) * prior_.cos2 + (now.shape.e2 - prior_.e2) * prior_.sin2;
        sum += 0.5 * e * e / (prior_.along * prior_.along);
        for (const Voice& v : voices_) {
            const double weight = v.line.side == 0 ? kAcrossWeight : 1;
            sum -= weight * std::log(std::exp(-0.5 * kIndependent * excess(v, c)) + kOutlier);
        }
        return sum;
    }

    double excess(const Voice& v, const Change& c) const {
        const double r = guess_.shape.radius;
        const double length = (guess_.half_motion + c.half_motion) * smear_of(v.line, r, c);
        return v.at(length / v.line.step, place_of(v.line, r, c) / v.line.step);
    }

    void tell(const Change& c, MotionFit& fit) const {
        double evidence = 0, clear = 0;
        for (const Voice& v : voices_) {
            const double gain = 0.5 * (static_cast<double>(v.without) - excess(v, c));
            evidence += std::clamp(gain, -5.0, 20.0);
            clear += gain > 2;
        }
        fit.evidence = evidence / static_cast<double>(voices_.size());
        fit.clear = clear / static_cast<double>(voices_.size());
    }

private:
    const std::vector<Voice>& voices_;
    const Guess &guess_, &first_;
    ShapePrior prior_;
};

/// The best of a coarse grid: likelihoods of textured pictures have many tops.
std::vector<Change> starts_of(const Misfit& misfit, const Guess& guess) {
    constexpr std::size_t kStarts = 4;
    const double r = guess.shape.radius;
    std::vector<std::pair<double, Change>> tried;
    for (double along = -0.09; along < 0.1; along += 0.03)
        for (double radius = -0.06; radius < 0.07; radius += 0.03)
            for (double across = -0.03; across < 0.04; across += 0.03) {
                const Change c{along * r, across * r, radius * r, 0, 0, 0};
                tried.emplace_back(misfit.of(c), c);
            }
    std::partial_sort(tried.begin(), tried.begin() + kStarts, tried.end(),
                      [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Change> best;
    for (std::size_t i = 0; i < kStarts; ++i) best.push_back(tried[i].second);
    return best;
}

Change settled(const cv::Ptr<Misfit>& misfit, const std::vector<Change>& starts, double step) {
    const cv::Ptr<cv::DownhillSolver> solver = cv::DownhillSolver::create(
        misfit, cv::Mat(cv::Mat_<double>(1, kUnknowns, 0.8 * step)),
        cv::TermCriteria(cv::TermCriteria::MAX_ITER | cv::TermCriteria::EPS, 300, 0.005));
    Change best;
    double least = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        const Unknowns from = unknowns_of(starts[i]);
        cv::Mat_<double> x(1, kUnknowns);
        std::copy(from.begin(), from.end(), x.begin());
        const double value = solver->minimize(x);
        if (i == 0 || value < least) least = value, best = change_of(x[0]);
    }
    return best;
}

/// The outline that has the moved edges inside.
Shape paired(const Level& level, const Outline& start, const V2d& motion) {
    constexpr double kFarthest = 0.15, kFirstStep = 0.03, kLastStep = 0.004;  // of the radius
    const double scale = level.scale();
    const Pairs pairs(
        level, {start.cx / scale, start.cy / scale, start.a / scale, start.b / scale, start.angle},
        motion / scale);
    const Shape shape = shape_of(start);
    const auto moved = [&](double x, double y, double radius) {
        const double r = shape.radius;
        return Shape{shape.x + x * r, shape.y + y * r, r * (1 + radius), shape.e1, shape.e2};
    };
    std::array<double, 3> best{};
    double most = -1e30;
    const auto look_around = [&](const std::array<double, 3>& middle, double reach, double step) {
        for (double x = -reach; x < reach + 0.5 * step; x += step)
            for (double y = -reach; y < reach + 0.5 * step; y += step)
                for (double r = -reach; r < reach + 0.5 * step; r += step) {
                    const std::array<double, 3> at{middle[0] + x, middle[1] + y, middle[2] + r};
                    Shape here = moved(at[0], at[1], at[2]);
                    here.x /= scale, here.y /= scale, here.radius /= scale;
                    const double value = pairs.evidence(here);
                    if (value > most) most = value, best = at;
                }
    };
    look_around({0, 0, 0}, kFarthest, kFirstStep);
    for (double step = 0.5 * kFirstStep; step > kLastStep; step *= 0.5)
        look_around(std::array<double, 3>(best), step, step);
    return moved(best[0], best[1], best[2]);
}

}  // namespace

MotionFit fit_motion(const Grey& picture, const Level& level, const Outline& start,
                     const V2d& motion, const Lens& lens, double least) {
    constexpr double kSamplesOfMotion = 4.5;
    constexpr double kFirstStep = 1.0 / 40;  // of the radius
    constexpr double kFinestStep = 0.7;
    constexpr int kRounds = 3;
    constexpr std::size_t kEnough = 24;
    // Once more from there: what is usual inside was measured about the first outline.
    const Shape shape = paired(level, outline_of(paired(level, start, motion)), motion);
    const ShapePrior prior = prior_at(shape, lens);
    const Guess first{shape, motion.normalized(), 0.5 * motion.length(), {prior.cos2, prior.sin2}};
    Guess guess = first;
    MotionFit fit{start, motion, 0, 0, 0};
    for (int round = 0; round < kRounds; ++round) {
        const double r = guess.shape.radius;
        // The first outline may be wrong by more than the motion is long.
        const double coarse = std::max(kFinestStep, kFirstStep * r);
        const double along =
            std::max(round == 0 ? coarse : kFinestStep, guess.half_motion / kSamplesOfMotion);
        const double across = round == 0 ? coarse : std::max(kFinestStep, r / 60);
        std::vector<Line> used;
        std::vector<Profile> profiles;
        std::size_t asked = 0;
        for (const int side : {1, -1})
            for (const auto& lines :
                 {lines_along(guess, side, along), lines_across(guess, side, across)}) {
                look_along(picture.pixels, lines, used, profiles);
                asked += lines.size() / kDense;
            }
        fit.known = static_cast<double>(used.size()) / static_cast<double>(asked);
        fit.evidence = fit.clear = 0;
        if (used.size() < kEnough) return fit;
        const std::vector<Voice> voices = voices_of(used, profiles);
        const auto misfit = cv::makePtr<Misfit>(voices, guess, first, lens);
        const auto starts = round == 0 ? starts_of(*misfit, guess) : std::vector<Change>{{}};
        const Change change = settled(misfit, starts, along);
        misfit->tell(change, fit);
        guess.take(change);
        fit.outline = outline_of(guess.shape);
        fit.motion = guess.way * (2 * guess.half_motion);
        if (fit.evidence < least) break;
    }
    return fit;
}

}  // namespace chromeball::detecting
