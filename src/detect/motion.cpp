#include "detect/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/core/optim.hpp>
#include <vector>

#include "detect/density.h"
#include "detect/pairs.h"
#include "detect/smear.h"

// On a line along the motion a moving ball is a matter of that line alone: what it shows there at
// one instant it shows, shifted, at every other. So a profile along such a line is the ball's own,
// averaged over the motion, before a background that stands still and shines through for the part
// of the time in which the ball is not there yet. As in edge.cpp the world's light is taken as a
// random walk, on the ball in the square root of the depth inside the rim; with the average this
// gives profiles a covariance that depends on where the rim is in the middle of the exposure and on
// how far it went (smear.cpp). Both ends of the smear are seen: where the picture begins to change,
// and where the background is gone; and what was seen once inside is not news the second time.
// Where the rim runs along the motion it is nearly sharp, and profiles across it say the same with
// the part of the motion that goes across.
//
// A shutter averages light, not codes: the profiles along the motion are of light. What the others
// show is a rim almost as sharp as a ball's that stood still, for which codes serve as well.

namespace chromeball::detecting {
namespace {

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
    /// The change that leads to `other`, but for the ellipticity.
    Change change_to(const Guess& other) const {
        const V2d d(other.shape.x - shape.x, other.shape.y - shape.y);
        return {d.dot(way),
                d.dot(across()),
                other.shape.radius - shape.radius,
                other.half_motion - half_motion,
                0,
                way.cross(other.way) * shape.radius};
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

constexpr int kDense = 4;  // lines sampled for each that is used

/// Lines side by side, kDense for each one that is used.
std::vector<Line> lines_along(const Guess& guess, int side, double step, int count) {
    constexpr double kSpan = 0.85;  // of the radius: further out the rim runs along the lines
    std::vector<Line> lines;
    for (int i = 0; i < count * kDense; ++i) {
        const double y = kSpan * guess.shape.radius * ((2 * i + 1.0) / (count * kDense) - 1);
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

/// Each sample is the mean over its step, as far as pixels tell, of what `value` makes of codes.
template <std::size_t N, class Value>
ProfileOf<N> profile_of(const Raster<std::uint16_t>& picture, const Line& line,
                        const Value& value) {
    const int taps = std::clamp(static_cast<int>(std::ceil(line.step / 1.2)), 1, 8);
    ProfileOf<N> profile{};
    for (std::size_t k = 0; k < N; ++k)
        for (int tap = 0; tap < taps; ++tap) {
            const double at =
                static_cast<double>(k) - static_cast<double>(N / 2) + (tap + 0.5) / taps - 0.5;
            const V2d p = line.at + line.outwards * (at * line.step);
            profile[k] += sample(picture, p.x, p.y, value);
        }
    return profile;
}

/// Averages neighbours, which show the same rim, as far as `wide` of the lines' distance, and takes
/// one line in kDense. Those that leave the picture are left out.
template <std::size_t N, class Value>
void look_along(const Raster<std::uint16_t>& picture, const Value& value,
                const std::vector<Line>& lines, double wide, std::vector<Line>& used,
                std::vector<ProfileOf<N>>& profiles_used) {
    std::vector<ProfileOf<N>> profiles;
    for (const Line& line : lines) profiles.push_back(profile_of<N>(picture, line, value));
    const int count = static_cast<int>(lines.size()), reach = cvRound(2 * wide * kDense);
    for (int i = kDense / 2; i < count; i += kDense) {
        ProfileOf<N> mean{};
        for (int j = std::max(0, i - reach); j <= std::min(count - 1, i + reach); ++j) {
            const double d = double(j - i) / (wide * kDense);
            const auto weight = static_cast<float>(std::exp(-0.5 * d * d));
            for (std::size_t k = 0; k < N; ++k)
                mean[k] += weight * profiles[static_cast<std::size_t>(j)][k];
        }
        if (!normalise(mean)) continue;
        used.push_back(lines[static_cast<std::size_t>(i)]);
        profiles_used.push_back(mean);
    }
}

// What, with the kinds of profiles in smear.cpp, gives true places the most likelihood on painted
// pictures.
constexpr double kIndependent = 0.3;  // of a profile's samples: they are less so than is assumed
constexpr double kOutlier = 0.05;     // of the profiles: show something else, anywhere
constexpr double kFinest = 0.7;       // pixels: finer samples share their pixels' noise

/// What shows about the rim that a guess expects: profiles along the motion, and across the rim
/// where it runs along.
struct Look {
    Guess guess;
    std::vector<Line> lines;
    std::vector<SmearVoice> voices;  ///< by line
    std::vector<Line> lines_beside;
    std::vector<BesideVoice> beside;
    double known = 0;  ///< part of the lines along the motion that lie in the picture
    /// Likelihoods, by line, of a profile that shows something else.
    std::vector<double> other, other_beside;
};

/// Of one that shows its rim at any place alike.
template <class Voice>
double other_than(const Voice& voice, double half_motion) {
    return kOutlier / (1 - kOutlier) * voice.openness(half_motion, kIndependent);
}

/// With samples no finer than told, pixels.
Look look_at(const Grey& picture, const Guess& guess, double finest, double step_beside) {
    constexpr int kLines = 36;
    constexpr double kWide = 0.5, kWideBeside = 1;  // of the lines' distance
    const double step = std::max(finest, guess.half_motion / kSmearSamples);
    const auto light = [&](std::uint16_t code) { return picture.linear[code]; };
    const auto code = [](std::uint16_t value) { return static_cast<float>(value) * (1 / 65535.f); };
    Look look{guess, {}, {}, {}, {}, 0, {}, {}};
    std::vector<ProfileOf<kManySamples>> along;
    std::vector<Profile> beside;
    for (const int side : {1, -1}) {
        look_along(picture.pixels, light, lines_along(guess, side, step, kLines), kWide, look.lines,
                   along);
        look_along(picture.pixels, code, lines_across(guess, side, step_beside), kWideBeside,
                   look.lines_beside, beside);
    }
    look.voices = smear_voices(along, guess.half_motion / step);
    look.beside = beside_voices(beside);
    look.known = static_cast<double>(look.lines.size()) / (2 * kLines);
    for (const SmearVoice& voice : look.voices)
        look.other.push_back(other_than(voice, guess.half_motion / step));
    for (std::size_t i = 0; i < look.beside.size(); ++i) {
        const Line& line = look.lines_beside[i];
        const double length = guess.half_motion * smear_of(line, guess.shape.radius, {});
        look.other_beside.push_back(other_than(look.beside[i], length / line.step));
    }
    return look;
}

/// How badly a change of a look's guess agrees with what shows there.
class Misfit : public cv::MinProblemSolver::Function {
public:
    /// `first` is what all began with: the outline from afar, the motion as the inside tells it.
    Misfit(const Look& look, const Guess& first, const Lens& lens)
        : look_(look), first_(first), prior_(prior_at(look.guess.shape, lens)) {}

    int getDims() const override { return kUnknowns; }
    double calc(const double* x) const override { return of(change_of(x)); }

    double of(const Change& c) const { return unlikely(c) + seen(c); }

    /// What shows alone.
    double seen(const Change& c) const {
        double sum = 0;
        for (std::size_t i = 0; i < look_.voices.size(); ++i)
            sum -= std::log(std::exp(-0.5 * kIndependent * cost(i, c)) + look_.other[i]);
        const double r = look_.guess.shape.radius;
        for (std::size_t i = 0; i < look_.beside.size(); ++i) {
            const Line& line = look_.lines_beside[i];
            const double length = (look_.guess.half_motion + c.half_motion) * smear_of(line, r, c);
            const double cost =
                look_.beside[i].cost(length / line.step, place_of(line, r, c) / line.step);
            sum -= std::log(std::exp(-0.5 * kIndependent * cost) + look_.other_beside[i]);
        }
        return sum;
    }

    /// What is said for the outline, see MotionFit.
    void tell(const Change& c, MotionFit& fit) const {
        double still = 0, moving = 0, clear = 0, outer = 0;
        for (std::size_t i = 0; i < look_.voices.size(); ++i) {
            const SmearVoice& v = look_.voices[i];
            const double here = cost(i, c);
            still += std::clamp(0.5 * (v.cost_still() - here), -5.0, 20.0);
            moving += std::clamp(0.5 * (v.cost_moving() - here), -5.0, 20.0);
            clear += 0.5 * (v.cost_still() - here) > 2;
            outer += here > 6;
        }
        const auto count = static_cast<double>(look_.voices.size());
        fit.evidence = still / count;
        fit.ends = moving / count;
        fit.clear = clear / count;
        fit.amiss = outer / count;
        fit.known = look_.known;
        fit.certain = certainty(c);
    }

private:
    /// See MotionFit.
    double certainty(const Change& c) const {
        constexpr double kOff = 0.02;  // of the radius
        constexpr std::array<std::array<double, 3>, 9> kWays{{{1, 0, 0},
                                                              {0, 1, 0},
                                                              {0, 0, 1},
                                                              {1, 1, 0},
                                                              {1, -1, 0},
                                                              {1, 0, 1},
                                                              {1, 0, -1},
                                                              {0, 1, 1},
                                                              {0, 1, -1}}};
        double least = 1e30;
        for (const auto& way : kWays)
            for (const double side : {-1.0, 1.0}) {
                const double off =
                    side * kOff * look_.guess.shape.radius / std::hypot(way[0], way[1], way[2]);
                Change other = c;
                other.along += off * way[0];
                other.across += off * way[1];
                other.radius += off * way[2];
                least = std::min(least, seen(other));
            }
        return least - seen(c);
    }

    double unlikely(const Change& c) const {
        constexpr double kOutlineSpread = 0.05;  // of the radius
        constexpr double kLengthSpread = 0.01;   // of the motion's logarithm
        constexpr double kTurnSpread = 0.004;    // radians
        Guess now = look_.guess;
        now.take(c);
        const double part = std::max(now.half_motion / first_.half_motion, 0.01);
        const double spread = kOutlineSpread * first_.shape.radius;
        const double off2 = std::pow(now.shape.x - first_.shape.x, 2) +
                            std::pow(now.shape.y - first_.shape.y, 2) +
                            std::pow(now.shape.radius - first_.shape.radius, 2);
        const double e =
            (now.shape.e1 - prior_.e1) * prior_.cos2 + (now.shape.e2 - prior_.e2) * prior_.sin2;
        return 0.5 * (std::pow(std::log(part) / kLengthSpread, 2) +
                      std::pow(first_.way.cross(now.way) / kTurnSpread, 2) +
                      off2 / (spread * spread) + e * e / (prior_.along * prior_.along));
    }

    double cost(std::size_t i, const Change& c) const {
        const Line& line = look_.lines[i];
        return look_.voices[i].cost((look_.guess.half_motion + c.half_motion) / line.step,
                                    place_of(line, look_.guess.shape.radius, c) / line.step);
    }

    const Look& look_;
    const Guess& first_;
    ShapePrior prior_;
};

/// The best of a coarse grid: likelihoods of textured pictures have many tops.
std::vector<Change> starts_of(const Misfit& misfit, double radius) {
    constexpr std::size_t kStarts = 8;
    std::vector<std::pair<double, Change>> tried;
    for (double along = -0.09; along < 0.1; along += 0.03)
        for (double larger = -0.06; larger < 0.07; larger += 0.03)
            for (double across = -0.06; across < 0.07; across += 0.03) {
                const Change c{along * radius, across * radius, larger * radius, 0, 0, 0};
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

/// One place where the ball may be, on its way.
struct Way {
    Guess first;  ///< that it began with
    Guess guess;
    Look look;  ///< the last one
    MotionFit fit;
};

/// Looks and settles; false if too little lies in the picture.
bool look_and_settle(const Grey& picture, Way& way, const Lens& lens, double finest,
                     double step_beside, bool from_afar) {
    constexpr double kEnough = 0.4;
    way.look = look_at(picture, way.guess, finest, step_beside);
    if (way.look.known < kEnough) return false;
    const auto misfit = cv::makePtr<Misfit>(way.look, way.first, lens);
    const double step = std::max(finest, way.guess.half_motion / kSmearSamples);
    const Change change = settled(
        misfit, from_afar ? starts_of(*misfit, way.guess.shape.radius) : std::vector<Change>{{}},
        step);
    misfit->tell(change, way.fit);
    way.guess.take(change);
    way.fit.outline = outline_of(way.guess.shape);
    way.fit.motion = way.guess.way * (2 * way.guess.half_motion);
    return true;
}

bool nearly_same(const Guess& one, const Guess& other) {
    constexpr double kSame = 0.015;  // of the radius
    return std::max({std::abs(one.shape.x - other.shape.x), std::abs(one.shape.y - other.shape.y),
                     std::abs(one.shape.radius - other.shape.radius)}) < kSame * one.shape.radius;
}

/// The likeliest by all that was looked at: each alone agrees best with what shows around itself.
std::size_t likeliest(const std::vector<Way>& ways, const Lens& lens) {
    std::vector<double> sums(ways.size());
    for (const Way& way : ways) {
        const Misfit misfit(way.look, way.first, lens);
        for (std::size_t i = 0; i < ways.size(); ++i)
            sums[i] += misfit.seen(way.look.guess.change_to(ways[i].guess));
    }
    return static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin());
}

}  // namespace

MotionFit fit_motion(const Grey& picture, const Level& level, const Outline& start,
                     const V2d& motion, const Lens& lens, double least) {
    constexpr double kCoarse = 1.0 / 40, kBeside = 1.0 / 80;  // of the radius
    std::vector<Shape> shapes{shape_of(start)};
    for (int i = 0; i < 2; ++i)  // the second: what is usual inside is measured about the first
        shapes.push_back(paired(level, outline_of(shapes.back()), motion));
    MotionFit fit{start, motion};
    std::vector<Way> ways;
    for (const Shape& shape : shapes) {
        const ShapePrior prior = prior_at(shape, lens);
        const Guess first{
            shape, motion.normalized(), 0.5 * motion.length(), {prior.cos2, prior.sin2}};
        Way way{first, first, {first, {}, {}, {}, {}, 0, {}, {}}, fit};
        const double coarse = std::max(kFinest, kCoarse * shape.radius);
        if (!look_and_settle(picture, way, lens, coarse, coarse, true)) continue;
        if (way.fit.evidence < least) continue;
        if (std::none_of(ways.begin(), ways.end(),
                         [&](const Way& w) { return nearly_same(w.guess, way.guess); }))
            ways.push_back(way);
    }
    const auto closely = [&](Way& way) {
        const double beside = std::max(kFinest, kBeside * way.guess.shape.radius);
        return look_and_settle(picture, way, lens, kFinest, beside, false);
    };
    std::erase_if(ways, [&](Way& way) { return !closely(way); });
    if (ways.empty()) return fit;
    Way& best = ways[likeliest(ways, lens)];
    closely(best);
    return best.fit;
}

}  // namespace chromeball::detecting
