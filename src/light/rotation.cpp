#include "light/rotation.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/statistics.h"
#include "light/rotation_search.h"

namespace chromeball {
namespace {

using std::numbers::pi;
using Samples = std::vector<ViewPyramid::Sample>;
constexpr double kDegree = pi / 180;

Samples sampled(const ViewPyramid& view, const std::vector<V3d>& world, const Rotation& to_world,
                double angle) {
    Samples samples(world.size());
    view.sample(world, to_world, angle, samples);
    return samples;
}

/// What two views differ by: their median difference, and how the rest spreads.
struct Spread {
    std::array<double, 3> offset{};
    double scale = 0;  ///< 1.4826 times the median magnitude: a Gaussian's standard deviation
};
Spread spread_of(const Samples& a, const Samples& b) {
    Spread spread;
    std::array<std::vector<double>, 3> differences;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i].weight > 0 && b[i].weight > 0)
            for (std::size_t c = 0; c < 3; ++c)
                differences[c].push_back(static_cast<double>(a[i].value[c]) -
                                         static_cast<double>(b[i].value[c]));
    std::vector<double> sizes;
    for (std::size_t c = 0; c < 3; ++c) {
        spread.offset[c] = median(differences[c]);
        for (const double d : differences[c]) sizes.push_back(std::abs(d - spread.offset[c]));
    }
    spread.scale = 1.4826 * median(sizes);
    return spread;
}

/// The views while they are being turned.
struct State {
    std::vector<Unturned>& views;
    ViewAlignment& pose;

    /// Changes a view's ball; false where there is none like that.
    bool change(std::size_t i, const BallChange& change) {
        if (change == pose.change[i]) return true;
        const auto moved = ball_of(*views[i].ball, change);
        if (!moved) return false;
        views[i].pyramid.set_ball(*moved);
        pose.change[i] = change;
        return true;
    }
};

/// What may be unknown of a view: its turn about an axis of the world; its ball. All are counted
/// in radians, or in what moves directions by about as much.
enum class Kind { about_x, about_y, about_z, right, down, growth, inverse_distance };
struct Unknown {
    std::size_t view;
    Kind kind;
    double deviation;  ///< that is expected of it; 0: it may be anything

    bool turns() const { return kind <= Kind::about_z; }
};

Rotation turned(Kind kind, double radians) {
    const double degrees = radians / kDegree;
    return kind == Kind::about_x   ? Rotation::about_x(degrees)
           : kind == Kind::about_y ? Rotation::about_y(degrees)
                                   : Rotation::about_z(degrees);
}

BallChange changed(BallChange change, const BallModel& ball, Kind kind, double by) {
    // In its middle a pixel turns directions by 2 / radius.
    const double pixels = 0.5 * ball.outline.b * by;
    if (kind == Kind::right) change.right += pixels;
    if (kind == Kind::down) change.down += pixels;
    if (kind == Kind::growth) change.growth += by;
    // Nobody stands nearer than 2.5 radii.
    if (kind == Kind::inverse_distance)
        change.inverse_distance = std::clamp(change.inverse_distance + by, 0.0, 0.4);
    return change;
}

double amount(const BallChange& change, const BallModel& ball, Kind kind) {
    if (kind == Kind::right) return change.right / (0.5 * ball.outline.b);
    if (kind == Kind::down) return change.down / (0.5 * ball.outline.b);
    return kind == Kind::growth ? change.growth : change.inverse_distance;
}

std::vector<Unknown> unknowns_of(const std::vector<Unturned>& views,
                                 const std::vector<std::size_t>& placed, bool balls) {
    std::vector<Unknown> unknowns;
    for (const std::size_t i : placed) {
        // Somebody must stand still.
        if (!views[i].to_world && i != placed.front())
            for (const Kind kind : {Kind::about_x, Kind::about_y, Kind::about_z})
                unknowns.push_back({i, kind, 0});
        if (!balls || !views[i].ball) continue;
        const BallModel& ball = *views[i].ball;
        if (ball.deviation > 0) {
            const double deviation = ball.deviation / ball.outline.b;
            unknowns.push_back({i, Kind::right, 2 * deviation});
            unknowns.push_back({i, Kind::down, 2 * deviation});
            unknowns.push_back({i, Kind::growth, deviation});
        }
        if (!ball.camera_known) unknowns.push_back({i, Kind::inverse_distance, 0.1});
    }
    return unknowns;
}

/// So many samples tell as much as one would without errors in common.
constexpr double kCorrelated = 10;
/// Differences of more standard deviations are something else. Of Gaussian ones 95 % is kept.
constexpr double kTukey = 4.685;

/// The views' samples at a moment, and how they change. All changes are seen as turns of a view
/// about the world's axes, which may differ from sample to sample.
struct Moment {
    /// By turns about x, y, z, per radian, for red, green, blue.
    using Gradient = std::array<V3d, 3>;
    std::vector<Samples> samples;                  ///< a view
    std::vector<std::vector<Gradient>> gradients;  ///< a view; NaN where a turn leads out of it
    std::vector<std::vector<V3d>> changes;         ///< an unknown that is no turn: as turns
};

Moment moment_of(State& state, const std::vector<std::size_t>& placed,
                 const std::vector<Unknown>& unknowns, const std::vector<V3d>& world,
                 double angle) {
    // Places change smoothly: any step that is long against rounding and short against the ball.
    constexpr double kStep = 1e-3;
    Moment moment;
    const std::size_t count = state.views.size();
    moment.samples.resize(count);
    moment.gradients.resize(count);
    std::vector<V2d> ahead(world.size()), back(world.size());
    std::vector<ViewPyramid::Slope> slopes(world.size());
    // A view: where its samples' places go by turns.
    std::vector<std::array<std::vector<V2d>, 3>> moves(count);
    for (const std::size_t i : placed) {
        const ViewPyramid& view = state.views[i].pyramid;
        const Rotation& pose = state.pose.to_world[i];
        moment.samples[i].resize(world.size());
        view.sample(world, pose, angle, moment.samples[i], slopes);
        for (const Kind kind : {Kind::about_x, Kind::about_y, Kind::about_z}) {
            view.places(world, turned(kind, kStep) * pose, ahead);
            view.places(world, turned(kind, -kStep) * pose, back);
            auto& by = moves[i][static_cast<std::size_t>(kind)];
            by.resize(world.size());
            for (std::size_t s = 0; s < world.size(); ++s)
                by[s] = view.way(back[s], ahead[s]) / (2 * kStep);
        }
        moment.gradients[i].resize(world.size());
        for (std::size_t s = 0; s < world.size(); ++s)
            for (std::size_t c = 0; c < 3; ++c) {
                const V2d slope(static_cast<double>(slopes[s].right[c]),
                                static_cast<double>(slopes[s].down[c]));
                moment.gradients[i][s][c] =
                    V3d(slope.dot(moves[i][0][s]), slope.dot(moves[i][1][s]),
                        slope.dot(moves[i][2][s]));
            }
    }
    for (const Unknown& u : unknowns) {
        if (u.turns()) continue;
        const Unturned& view = state.views[u.view];
        const BallChange now = state.pose.change[u.view];
        const auto places = [&](double by, std::vector<V2d>& to) {
            state.change(u.view, changed(now, *view.ball, u.kind, by));
            view.pyramid.places(world, state.pose.to_world[u.view], to);
            const double reached = amount(state.pose.change[u.view], *view.ball, u.kind);
            state.change(u.view, now);
            return reached;
        };
        const double most = places(kStep, ahead), least = places(-kStep, back);
        std::vector<V3d> turns(world.size());
        const auto& by = moves[u.view];
        for (std::size_t s = 0; s < world.size(); ++s) {
            // The shortest turn that moves the place as much: with P the moves by turns, a 2 x 3
            // matrix, P^T (P P^T)^-1 move.
            const V2d move = view.pyramid.way(back[s], ahead[s]) / (most - least);
            double xx = 0, xy = 0, yy = 0;
            for (const auto& one : by) {
                xx += one[s].x * one[s].x;
                xy += one[s].x * one[s].y;
                yy += one[s].y * one[s].y;
            }
            const double det = xx * yy - xy * xy;
            const V2d solved((yy * move.x - xy * move.y) / det, (xx * move.y - xy * move.x) / det);
            turns[s] = V3d(by[0][s].dot(solved), by[1][s].dot(solved), by[2][s].dot(solved));
        }
        moment.changes.push_back(std::move(turns));
    }
    return moment;
}

/// One step of Gauss and Newton; returns its largest angle.
double step(State& state, const std::vector<std::size_t>& placed,
            const std::vector<Unknown>& unknowns, const std::vector<V3d>& world, double angle) {
    const Moment moment = moment_of(state, placed, unknowns, world, angle);
    std::vector<const std::vector<V3d>*> changes;
    for (std::size_t k = 0, change = 0; k < unknowns.size(); ++k)
        changes.push_back(unknowns[k].turns() ? nullptr : &moment.changes[change++]);
    const auto& at = moment.samples;
    const auto size = static_cast<Eigen::Index>(unknowns.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (std::size_t m = 0; m < placed.size(); ++m)
        for (std::size_t n = m + 1; n < placed.size(); ++n) {
            const std::size_t i = placed[m], j = placed[n];
            const Spread spread = spread_of(at[i], at[j]);
            const double noise = std::max(spread.scale, 0.02);
            const auto difference = [&](std::size_t t, std::size_t c) {
                return static_cast<double>(at[i][t].value[c]) -
                       static_cast<double>(at[j][t].value[c]) - spread.offset[c];
            };
            // Both views' mean, so that what turns both alike cancels: one may be blurred more.
            const auto gradient = [&](std::size_t t, std::size_t c) {
                return (moment.gradients[i][t][c] + moment.gradients[j][t][c]) * 0.5;
            };
            // How far off samples are where it shows. What is steep differs by that much without
            // being something else: it must neither be left out nor outweigh all else.
            std::vector<double> shifts;
            for (std::size_t s = 0; s < world.size(); ++s)
                for (std::size_t c = 0; c < 3; ++c)
                    if (at[i][s].weight > 0 && at[j][s].weight > 0)
                        if (const double steep = gradient(s, c).length(); steep * angle > 4 * noise)
                            shifts.push_back(std::abs(difference(s, c)) / steep);
            const double shift = std::clamp(1.4826 * median(shifts), 0.01 * kDegree, 0.5 * angle);
            std::vector<std::pair<std::size_t, double>> involved;  // unknown, sign
            for (std::size_t k = 0; k < unknowns.size(); ++k)
                if (unknowns[k].view == i || unknowns[k].view == j)
                    involved.emplace_back(k, unknowns[k].view == i ? 1.0 : -1.0);
            Eigen::VectorXd row(static_cast<Eigen::Index>(involved.size()));
            for (std::size_t s = 0; s < world.size(); ++s) {
                const double weight = std::sqrt(static_cast<double>(at[i][s].weight) *
                                                static_cast<double>(at[j][s].weight));
                if (!(weight > 0)) continue;
                for (std::size_t c = 0; c < 3; ++c) {
                    const V3d slope = gradient(s, c);
                    const double steep = slope.length();
                    const double r = difference(s, c);
                    const double variance = noise * noise + steep * steep * shift * shift;
                    const double part = r * r / (kTukey * kTukey * variance);
                    if (part >= 1) continue;
                    // Neighbouring samples err together.
                    const double w = weight * (1 - part) * (1 - part) / (kCorrelated * variance);
                    bool known = true;
                    for (std::size_t k = 0; k < involved.size(); ++k) {
                        const auto& [u, sign] = involved[k];
                        const double by = unknowns[u].turns()
                                              ? slope[static_cast<int>(unknowns[u].kind)]
                                              : slope.dot((*changes[u])[s]);
                        known = known && std::isfinite(by);
                        row[static_cast<Eigen::Index>(k)] = sign * by;
                    }
                    if (!known || !std::isfinite(variance)) continue;
                    for (std::size_t k = 0; k < involved.size(); ++k) {
                        const auto a = static_cast<Eigen::Index>(involved[k].first);
                        const double wk = w * row[static_cast<Eigen::Index>(k)];
                        right[a] -= wk * r;
                        for (std::size_t l = 0; l < involved.size(); ++l)
                            normal(a, static_cast<Eigen::Index>(involved[l].first)) +=
                                wk * row[static_cast<Eigen::Index>(l)];
                    }
                }
            }
        }
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
        const Unknown& u = unknowns[k];
        if (!(u.deviation > 0)) continue;
        const double information = 1 / (u.deviation * u.deviation);
        const auto a = static_cast<Eigen::Index>(k);
        const double now = amount(state.pose.change[u.view], *state.views[u.view].ball, u.kind);
        normal(a, a) += information;
        right[a] -= information * now;
    }
    // What nothing tells stays where it is.
    normal.diagonal().array() += 1e-6 * normal.diagonal().maxCoeff() + 1e-12;
    Eigen::VectorXd by = normal.ldlt().solve(right);
    const double longest = by.cwiseAbs().maxCoeff();
    if (!(longest < 1e9)) return 0;
    if (longest > 2 * angle) by *= 2 * angle / longest;
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
        const Unknown& u = unknowns[k];
        const double change = by[static_cast<Eigen::Index>(k)];
        Rotation& pose = state.pose.to_world[u.view];
        if (u.turns())
            pose = turned(u.kind, change) * pose;
        else
            state.change(u.view, changed(state.pose.change[u.view], *state.views[u.view].ball,
                                         u.kind, change));
    }
    for (const std::size_t i : placed)  // products drift
        if (const auto tidy = Rotation::nearest(state.pose.to_world[i].rows()))
            if (!state.views[i].to_world) state.pose.to_world[i] = *tidy;
    return by.cwiseAbs().maxCoeff();
}

/// Samples over the sphere whose spacing goes with the angle that each is averaged over.
std::vector<V3d> directions_for(double angle) {
    const double wanted = 4 * pi / (angle * angle);
    return fibonacci_directions(static_cast<int>(std::clamp(wanted, 1000.0, 24000.0)));
}

void refine(State& state, const std::vector<std::size_t>& placed, double angle, int steps,
            bool balls) {
    const auto unknowns = unknowns_of(state.views, placed, balls);
    if (unknowns.empty()) return;
    const auto world = directions_for(angle);
    constexpr double kStill = 3e-3;  // of the angle
    for (int k = 0; k < steps; ++k)
        if (step(state, placed, unknowns, world, angle) < kStill * angle) break;
}

/// How much two views differ, turned as they are, over how much they do turned at random; each in
/// detail as well as in the large.
double disagreement(const Unturned& a, const Unturned& b, const Rotation& a_pose,
                    const Rotation& b_pose) {
    constexpr double kAngle = 2 * kDegree;
    const auto world = fibonacci_directions(3000);
    const Samples fixed = sampled(a.pyramid, world, a_pose, kAngle);
    const double now = spread_of(fixed, sampled(b.pyramid, world, b_pose, kAngle)).scale;
    std::vector<double> others;
    for (int k = 0; k < 24; ++k) {
        const Rotation turn = Rotation::yaw_pitch_roll(15.0 * k, 47.0 * k, 71.0 * k + 60);
        others.push_back(spread_of(fixed, sampled(b.pyramid, world, turn * b_pose, kAngle)).scale);
    }
    const double usual = median(others);
    return usual > 0 ? std::min(1.0, now / usual) : 1;
}

/// A guess for where a view belongs, refined against the one it was compared with.
struct Guess {
    Rotation to_world;
    double agreement = -1;
};

/// The first ones, of those that have come to the same place the best.
std::vector<Guess> apart(std::vector<Guess> guesses, double angle, std::size_t most) {
    std::vector<Guess> kept;
    for (const Guess& guess : guesses)
        if (kept.size() < most && std::all_of(kept.begin(), kept.end(), [&](const Guess& other) {
                return angle_between(guess.to_world, other.to_world) > angle;
            }))
            kept.push_back(guess);
    return kept;
}

/// The best rotation of a view against one that is placed.
Guess best_guess(State& state, std::size_t placed, std::size_t view, const Watch& watch) {
    const Unturned& fixed = state.views[placed];
    const Unturned& free = state.views[view];
    const Rotation& fixed_pose = state.pose.to_world[placed];
    std::vector<Guess> guesses;
    for (const Rotation& turn : likely_rotations(fixed.pyramid, free.pyramid, 48, watch))
        guesses.push_back({fixed_pose * turn, 0});
    struct Round {
        double degrees;
        std::size_t keep;
    };
    for (const auto& [degrees, keep] : {Round{4, 12}, Round{2, 4}, Round{1, 1}}) {
        for (Guess& guess : guesses) {
            state.pose.to_world[view] = guess.to_world;
            refine(state, {placed, view}, degrees * kDegree, 6, false);
            guess.to_world = state.pose.to_world[view];
            const auto world = fibonacci_directions(2000);
            guess.agreement =
                likeness(sampled(fixed.pyramid, world, fixed_pose, degrees * kDegree),
                         sampled(free.pyramid, world, guess.to_world, degrees * kDegree));
        }
        watch.check();
        std::stable_sort(guesses.begin(), guesses.end(),
                         [](const Guess& a, const Guess& b) { return a.agreement > b.agreement; });
        guesses = apart(std::move(guesses), 0.5 * degrees * kDegree, keep);
    }
    return guesses.front();
}

/// A likeness that is no chance.
constexpr double kSurely = 0.5;

/// Places all views, one after the other, the one that fits best first.
std::vector<std::size_t> placed_in_turn(State& state, const Watch& watch) {
    std::vector<std::size_t> placed, waiting;
    for (std::size_t i = 0; i < state.views.size(); ++i)
        (state.views[i].to_world ? placed : waiting).push_back(i);
    if (placed.empty()) {
        placed.push_back(0);
        waiting.erase(waiting.begin());
    }
    std::vector<std::vector<Guess>> guesses(state.views.size());
    while (!waiting.empty()) {
        std::size_t best = 0;
        Guess guess;
        for (std::size_t k = 0; k < waiting.size(); ++k) {
            auto& known = guesses[waiting[k]];
            for (std::size_t n = known.size(); n < placed.size(); ++n) {
                // One that fits needs no other view to fit to.
                if (n > 0 && known.front().agreement > kSurely) break;
                known.push_back(best_guess(state, placed[n], waiting[k], watch));
            }
            for (const Guess& one : known)
                if (one.agreement > guess.agreement) {
                    guess = one;
                    best = k;
                }
        }
        state.pose.to_world[waiting[best]] = guess.to_world;
        placed.push_back(waiting[best]);
        waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return placed;
}

/// A view's samples all around, and how they change when it is turned.
struct Turnable {
    Samples samples;
    std::vector<double> slope;  ///< per radian, in the direction of most, summed over channels
};

Turnable turnable(const ViewPyramid& view, const std::vector<V3d>& world, const Rotation& pose,
                  double angle) {
    Turnable result{sampled(view, world, pose, angle), std::vector<double>(world.size())};
    const std::array turns{Rotation::about_x(0.5 * angle / kDegree),
                           Rotation::about_y(0.5 * angle / kDegree),
                           Rotation::about_z(0.5 * angle / kDegree)};
    std::array<Samples, 3> after, before;
    for (std::size_t k = 0; k < 3; ++k) {
        after[k] = sampled(view, world, turns[k] * pose, angle);
        before[k] = sampled(view, world, turns[k].inverse() * pose, angle);
    }
    for (std::size_t s = 0; s < world.size(); ++s)
        for (std::size_t c = 0; c < 3; ++c) {
            double square = 0;
            for (std::size_t k = 0; k < 3; ++k)
                square += std::pow((static_cast<double>(after[k][s].value[c]) -
                                    static_cast<double>(before[k][s].value[c])) /
                                       angle,
                                   2);
            result.slope[s] += std::sqrt(square);
        }
    return result;
}

/// How far the samples of two views would have to move to agree: |difference| over slope.
void add_misfits(const Turnable& view, const Samples& other, std::vector<double>& misfits) {
    const Samples& a = view.samples;
    const Spread spread = spread_of(a, other);
    for (std::size_t s = 0; s < a.size(); ++s) {
        if (!(a[s].weight > 0.2F && other[s].weight > 0.2F)) continue;
        double difference = 0;
        for (std::size_t c = 0; c < 3; ++c)
            difference += std::abs(static_cast<double>(a[s].value[c]) -
                                   static_cast<double>(other[s].value[c]) - spread.offset[c]);
        if (view.slope[s] > 0.5 / (10 * kDegree)) misfits.push_back(difference / view.slope[s]);
    }
}

}  // namespace

ViewAlignment align_views(std::vector<Unturned> views, const Watch& watch) {
    ViewAlignment pose;
    pose.change.resize(views.size());
    for (const Unturned& view : views) pose.to_world.push_back(view.to_world.value_or(Rotation()));
    State state{views, pose};
    const auto placed = placed_in_turn(state, watch);
    double finest = 0;
    for (const Unturned& view : views) finest = std::max(finest, view.pyramid.finest_angle());
    for (const double degrees : {2.0, 1.0, 0.5, 0.25}) {
        refine(state, placed, std::max(degrees * kDegree, finest), 12, true);
        watch.check();
    }
    const auto world = fibonacci_directions(6000);
    const double angle = std::max(0.25 * kDegree, finest);
    for (std::size_t i = 0; i < views.size(); ++i) {
        std::vector<double> misfits;
        double best = 1;
        const Turnable view = turnable(views[i].pyramid, world, pose.to_world[i], angle);
        for (std::size_t j = 0; j < views.size(); ++j) {
            if (i == j) continue;
            add_misfits(view, sampled(views[j].pyramid, world, pose.to_world[j], angle), misfits);
            best = std::min(best,
                            disagreement(views[j], views[i], pose.to_world[j], pose.to_world[i]));
        }
        pose.residual.push_back(median(misfits));
        pose.agreement.push_back(1 - best);
    }
    return pose;
}

}  // namespace chromeball
