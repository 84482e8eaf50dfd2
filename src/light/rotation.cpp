#include "light/rotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/statistics.h"
#include "light/view_differences.h"
#include "light/view_placing.h"
#include "light/view_refinement.h"

namespace chromeball {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// How much two views differ, turned as they are, over how much they do turned at random; each in
/// detail as well as in the large.
double disagreement(const Unturned& a, const Unturned& b, const Rotation& a_pose,
                    const Rotation& b_pose) {
    constexpr double kAngle = 2 * kDegree;
    const auto world = fibonacci_directions(3000);
    const ViewSamples fixed = sampled(a.pyramid, world, a_pose, kAngle);
    const double now = spread_of(fixed, sampled(b.pyramid, world, b_pose, kAngle)).scale;
    std::vector<double> others;
    for (int k = 0; k < 24; ++k) {
        const Rotation turn = Rotation::yaw_pitch_roll(15.0 * k, 47.0 * k, 71.0 * k + 60);
        others.push_back(spread_of(fixed, sampled(b.pyramid, world, turn * b_pose, kAngle)).scale);
    }
    const double usual = median(others);
    return usual > 0 ? std::min(1.0, now / usual) : 1;
}

/// A view's samples all around, and how they change when it is turned.
struct Turnable {
    ViewSamples samples;
    std::vector<double> slope;  ///< per radian, in the direction of most, summed over channels
};

Turnable turnable(const ViewPyramid& view, const std::vector<V3d>& world, const Rotation& pose,
                  double angle) {
    Turnable result{sampled(view, world, pose, angle), std::vector<double>(world.size())};
    const std::array turns{Rotation::about_x(0.5 * angle / kDegree),
                           Rotation::about_y(0.5 * angle / kDegree),
                           Rotation::about_z(0.5 * angle / kDegree)};
    std::array<ViewSamples, 3> after, before;
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
void add_misfits(const Turnable& view, const ViewSamples& other, std::vector<double>& misfits) {
    const ViewSamples& a = view.samples;
    const ViewSpread spread = spread_of(a, other);
    for (std::size_t s = 0; s < a.size(); ++s) {
        if (!(a[s].weight > 0.2F && other[s].weight > 0.2F)) continue;
        double difference = 0;
        for (std::size_t c = 0; c < 3; ++c)
            difference += std::abs(static_cast<double>(a[s].value[c]) -
                                   static_cast<double>(other[s].value[c]) - spread.offset[c]);
        if (view.slope[s] > 0.5 / (10 * kDegree)) misfits.push_back(difference / view.slope[s]);
    }
}

/// How well the views fit, turned as they are.
void judge(const std::vector<Unturned>& views, double finest, ViewAlignment& pose) {
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
}

}  // namespace

ViewAlignment align_views(std::vector<Unturned> views, const Watch& watch) {
    ViewAlignment pose;
    pose.change.resize(views.size());
    for (const Unturned& view : views) pose.to_world.push_back(view.to_world.value_or(Rotation()));
    TurningViews state{views, pose};
    const auto placed = placed_in_turn(state, watch);
    double finest = 0;
    for (const Unturned& view : views) finest = std::max(finest, view.pyramid.finest_angle());
    for (const double degrees : {2.0, 1.0, 0.5, 0.25}) {
        refine(state, placed, std::max(degrees * kDegree, finest), 12, true);
        watch.check();
    }
    judge(views, finest, pose);
    return pose;
}

}  // namespace chromeball
