#include "light/view_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/statistics.h"
#include "light/view_differences.h"

namespace chromeball {
namespace {

using std::numbers::pi;
constexpr double kDegree = pi / 180;

/// So many samples tell as much as one would without errors in common.
constexpr double kCorrelated = 10;
/// Differences of more standard deviations are something else. Of Gaussian ones 95 % is kept.
constexpr double kTukey = 4.685;

/// The views' samples at a moment, and how they change. All changes are seen as turns of a view
/// about the world's axes, which may differ from sample to sample.
struct Moment {
    /// By turns about x, y, z, per radian, for red, green, blue.
    using Gradient = std::array<V3d, 3>;
    std::vector<ViewSamples> samples;              ///< a view
    std::vector<std::vector<Gradient>> gradients;  ///< a view; NaN where a turn leads out of it
    std::vector<std::vector<V3d>> changes;         ///< an unknown, as turns; empty where it is one
};

/// Where in the picture the samples' places go by turns about x, y, z, per radian.
using Moves = std::array<std::vector<V2d>, 3>;

// Places change smoothly: any step that is long against rounding and short against the ball.
constexpr double kStep = 1e-3;

Moves moves_by_turns(const ViewPyramid& view, const Rotation& pose, const std::vector<V3d>& world) {
    std::vector<V2d> ahead(world.size()), back(world.size());
    Moves moves;
    for (const UnknownKind kind :
         {UnknownKind::about_x, UnknownKind::about_y, UnknownKind::about_z}) {
        view.places(world, turn_about(kind, kStep) * pose, ahead);
        view.places(world, turn_about(kind, -kStep) * pose, back);
        auto& by = moves[static_cast<std::size_t>(kind)];
        by.resize(world.size());
        for (std::size_t s = 0; s < world.size(); ++s)
            by[s] = view.way(back[s], ahead[s]) / (2 * kStep);
    }
    return moves;
}

std::vector<Moment::Gradient> gradients_of(const std::vector<ViewPyramid::Slope>& slopes,
                                           const Moves& moves) {
    std::vector<Moment::Gradient> gradients(slopes.size());
    for (std::size_t s = 0; s < slopes.size(); ++s)
        for (std::size_t c = 0; c < 3; ++c) {
            const V2d slope(static_cast<double>(slopes[s].right[c]),
                            static_cast<double>(slopes[s].down[c]));
            gradients[s][c] =
                V3d(slope.dot(moves[0][s]), slope.dot(moves[1][s]), slope.dot(moves[2][s]));
        }
    return gradients;
}

/// The shortest turn that moves a sample's place as much as `move`: with P the moves by turns, a
/// 2 x 3 matrix, P^T (P P^T)^-1 move.
V3d turn_for(V2d move, const Moves& moves, std::size_t sample) {
    double xx = 0, xy = 0, yy = 0;
    for (const auto& one : moves) {
        xx += one[sample].x * one[sample].x;
        xy += one[sample].x * one[sample].y;
        yy += one[sample].y * one[sample].y;
    }
    const double det = xx * yy - xy * xy;
    const V2d solved((yy * move.x - xy * move.y) / det, (xx * move.y - xy * move.x) / det);
    return V3d(moves[0][sample].dot(solved), moves[1][sample].dot(solved),
               moves[2][sample].dot(solved));
}

/// What a change of a view's ball does to its samples: a turn each.
std::vector<V3d> change_as_turns(TurningViews& state, const ViewUnknown& u, const Moves& moves,
                                 const std::vector<V3d>& world) {
    const Unturned& view = state.views[u.view];
    const BallChange now = state.pose.change[u.view];
    const auto places = [&](double by, std::vector<V2d>& to) {
        state.change(u.view, changed(now, *view.ball, u.kind, by));
        view.pyramid.places(world, state.pose.to_world[u.view], to);
        const double reached = amount(state.pose.change[u.view], *view.ball, u.kind);
        state.change(u.view, now);
        return reached;
    };
    std::vector<V2d> ahead(world.size()), back(world.size());
    const double most = places(kStep, ahead), least = places(-kStep, back);
    std::vector<V3d> turns(world.size());
    for (std::size_t s = 0; s < world.size(); ++s)
        turns[s] = turn_for(view.pyramid.way(back[s], ahead[s]) / (most - least), moves, s);
    return turns;
}

Moment moment_of(TurningViews& state, const std::vector<std::size_t>& placed,
                 const std::vector<ViewUnknown>& unknowns, const std::vector<V3d>& world,
                 double angle) {
    const std::size_t count = state.views.size();
    Moment moment{std::vector<ViewSamples>(count),
                  std::vector<std::vector<Moment::Gradient>>(count),
                  std::vector<std::vector<V3d>>(unknowns.size())};
    std::vector<ViewPyramid::Slope> slopes(world.size());
    std::vector<Moves> moves(count);
    for (const std::size_t i : placed) {
        const ViewPyramid& view = state.views[i].pyramid;
        const Rotation& pose = state.pose.to_world[i];
        moment.samples[i].resize(world.size());
        view.sample(world, pose, angle, moment.samples[i], slopes);
        moves[i] = moves_by_turns(view, pose, world);
        moment.gradients[i] = gradients_of(slopes, moves[i]);
    }
    for (std::size_t k = 0; k < unknowns.size(); ++k)
        if (!unknowns[k].turns())
            moment.changes[k] = change_as_turns(state, unknowns[k], moves[unknowns[k].view], world);
    return moment;
}

/// Two views at a moment.
class Pair {
public:
    Pair(const Moment& moment, std::size_t a, std::size_t b, double angle)
        : first(a),
          second(b),
          a_(moment.samples[a]),
          b_(moment.samples[b]),
          a_gradients_(moment.gradients[a]),
          b_gradients_(moment.gradients[b]),
          spread_(spread_of(a_, b_)),
          noise_(std::max(spread_.scale, 0.02)),
          shift_(shift(angle)) {}

    double weight(std::size_t s) const {
        return std::sqrt(static_cast<double>(a_[s].weight) * static_cast<double>(b_[s].weight));
    }
    double difference(std::size_t s, std::size_t c) const {
        return static_cast<double>(a_[s].value[c]) - static_cast<double>(b_[s].value[c]) -
               spread_.offset[c];
    }
    /// Both views' mean, so that what turns both alike cancels: one may be blurred more.
    V3d gradient(std::size_t s, std::size_t c) const {
        return (a_gradients_[s][c] + b_gradients_[s][c]) * 0.5;
    }
    /// Of a difference, by noise and by how far off samples are still.
    double variance(double steep) const {
        return noise_ * noise_ + steep * steep * shift_ * shift_;
    }

    const std::size_t first, second;

private:
    /// How far off samples are where it shows. What is steep differs by that much without being
    /// something else: it must neither be left out nor outweigh all else.
    double shift(double angle) const {
        std::vector<double> shifts;
        for (std::size_t s = 0; s < a_.size(); ++s)
            for (std::size_t c = 0; c < 3; ++c)
                if (a_[s].weight > 0 && b_[s].weight > 0)
                    if (const double steep = gradient(s, c).length(); steep * angle > 4 * noise_)
                        shifts.push_back(std::abs(difference(s, c)) / steep);
        return std::clamp(1.4826 * median(shifts), 0.01 * kDegree, 0.5 * angle);
    }

    const ViewSamples& a_;
    const ViewSamples& b_;
    const std::vector<Moment::Gradient>& a_gradients_;
    const std::vector<Moment::Gradient>& b_gradients_;
    ViewSpread spread_;
    double noise_, shift_;
};

/// normal times the unknowns' changes is right.
struct NormalEquations {
    Eigen::MatrixXd normal;
    Eigen::VectorXd right;

    explicit NormalEquations(std::size_t unknowns)
        : normal(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(unknowns),
                                       static_cast<Eigen::Index>(unknowns))),
          right(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns))) {}
};

/// An unknown of one of a pair's views: what it adds to the first it takes from the second.
struct Involved {
    std::size_t unknown;
    double sign;
};

std::vector<Involved> involved_in(const Pair& pair, const std::vector<ViewUnknown>& unknowns) {
    std::vector<Involved> involved;
    for (std::size_t k = 0; k < unknowns.size(); ++k)
        if (unknowns[k].view == pair.first || unknowns[k].view == pair.second)
            involved.push_back({k, unknowns[k].view == pair.first ? 1.0 : -1.0});
    return involved;
}

/// What two views that should show the same say of the unknowns.
void add_pair(const Pair& pair, const Moment& moment, const std::vector<ViewUnknown>& unknowns,
              NormalEquations& equations) {
    const auto involved = involved_in(pair, unknowns);
    std::vector<double> row(involved.size());
    /// The difference's change with each of them; false where a place leaves the picture.
    const auto fill_row = [&](std::size_t s, V3d slope) {
        bool known = true;
        for (std::size_t k = 0; k < involved.size(); ++k) {
            const auto& [u, sign] = involved[k];
            const double by = unknowns[u].turns() ? slope[static_cast<int>(unknowns[u].kind)]
                                                  : slope.dot(moment.changes[u][s]);
            known = known && std::isfinite(by);
            row[k] = sign * by;
        }
        return known;
    };
    for (std::size_t s = 0; s < moment.samples[pair.first].size(); ++s) {
        const double weight = pair.weight(s);
        if (!(weight > 0)) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const V3d slope = pair.gradient(s, c);
            const double r = pair.difference(s, c);
            const double variance = pair.variance(slope.length());
            const double part = r * r / (kTukey * kTukey * variance);
            if (part >= 1) continue;
            // Neighbouring samples err together.
            const double w = weight * (1 - part) * (1 - part) / (kCorrelated * variance);
            if (!fill_row(s, slope) || !std::isfinite(variance)) continue;
            for (std::size_t k = 0; k < involved.size(); ++k) {
                const auto a = static_cast<Eigen::Index>(involved[k].unknown);
                const double wk = w * row[k];
                equations.right[a] -= wk * r;
                for (std::size_t l = 0; l < involved.size(); ++l)
                    equations.normal(a, static_cast<Eigen::Index>(involved[l].unknown)) +=
                        wk * row[l];
            }
        }
    }
}

/// What is expected of the unknowns beforehand: to be about 0.
void add_expectations(const TurningViews& state, const std::vector<ViewUnknown>& unknowns,
                      NormalEquations& equations) {
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
        const ViewUnknown& u = unknowns[k];
        if (!(u.deviation > 0)) continue;
        const double information = 1 / (u.deviation * u.deviation);
        const auto a = static_cast<Eigen::Index>(k);
        const double now = amount(state.pose.change[u.view], *state.views[u.view].ball, u.kind);
        equations.normal(a, a) += information;
        equations.right[a] -= information * now;
    }
}

/// The unknowns' changes, none of them above `most`; nothing where there are none to believe.
std::optional<Eigen::VectorXd> changes_by(NormalEquations equations, double most) {
    // What nothing tells stays where it is.
    Eigen::MatrixXd& normal = equations.normal;
    normal.diagonal().array() += 1e-6 * normal.diagonal().maxCoeff() + 1e-12;
    Eigen::VectorXd by = normal.ldlt().solve(equations.right);
    const double longest = by.cwiseAbs().maxCoeff();
    if (!(longest < 1e9)) return std::nullopt;
    if (longest > most) by *= most / longest;
    return by;
}

void apply(const Eigen::VectorXd& by, const std::vector<ViewUnknown>& unknowns,
           const std::vector<std::size_t>& placed, TurningViews& state) {
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
        const ViewUnknown& u = unknowns[k];
        const double change = by[static_cast<Eigen::Index>(k)];
        Rotation& pose = state.pose.to_world[u.view];
        if (u.turns())
            pose = turn_about(u.kind, change) * pose;
        else
            state.change(u.view, changed(state.pose.change[u.view], *state.views[u.view].ball,
                                         u.kind, change));
    }
    for (const std::size_t i : placed)  // products drift
        if (const auto tidy = Rotation::nearest(state.pose.to_world[i].rows()))
            if (!state.views[i].to_world) state.pose.to_world[i] = *tidy;
}

/// One step of Gauss and Newton; returns its largest angle.
double step(TurningViews& state, const std::vector<std::size_t>& placed,
            const std::vector<ViewUnknown>& unknowns, const std::vector<V3d>& world, double angle) {
    const Moment moment = moment_of(state, placed, unknowns, world, angle);
    NormalEquations equations(unknowns.size());
    for (std::size_t m = 0; m < placed.size(); ++m)
        for (std::size_t n = m + 1; n < placed.size(); ++n)
            add_pair(Pair(moment, placed[m], placed[n], angle), moment, unknowns, equations);
    add_expectations(state, unknowns, equations);
    const auto by = changes_by(std::move(equations), 2 * angle);
    if (!by) return 0;
    apply(*by, unknowns, placed, state);
    return by->cwiseAbs().maxCoeff();
}

/// ViewSamples over the sphere whose spacing goes with the angle that each is averaged over.
std::vector<V3d> directions_for(double angle) {
    const double wanted = 4 * pi / (angle * angle);
    return fibonacci_directions(static_cast<int>(std::clamp(wanted, 1000.0, 24000.0)));
}

}  // namespace

void refine(TurningViews& state, const std::vector<std::size_t>& placed, double angle, int steps,
            bool balls) {
    const auto unknowns = unknowns_of(state.views, placed, balls);
    if (unknowns.empty()) return;
    const auto world = directions_for(angle);
    constexpr double kStill = 3e-3;  // of the angle
    for (int k = 0; k < steps; ++k)
        if (step(state, placed, unknowns, world, angle) < kStill * angle) break;
}

}  // namespace chromeball
