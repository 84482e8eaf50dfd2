#include "light/rotation.h"

#include <gtest/gtest.h>

#include <random>

#include "core/parallel.h"
#include "light/rotation_search.h"
#include "support/views.h"

namespace chromeball {
namespace {

using test::ball_view;
using test::degrees_between;
using test::Place;

constexpr Size kPhoto{240, 240};
const Outline kOutline{120, 120, 110, 110, 0};

View view_of(const Image& photo, const MirrorBall& ball) {
    return {ball_source(photo, ball, {}), std::nullopt};
}

Unturned unturned(const Image& photo, const MirrorBall& ball) {
    return {ViewPyramid(view_of(photo, ball)), std::nullopt, std::nullopt};
}

/// Somewhere in the middle of SO(3), far from all axes.
const Rotation kTurn = Rotation::yaw_pitch_roll(107, -31, 64);

/// Balls far away in a place, the second one turned.
std::vector<Unturned> pair(const Place& a, const Place& b, double exposure = 1) {
    const MirrorBall ball(kOutline);
    const auto first = [&](V3d world, V3d) { return a(world); };
    const auto second = [&](V3d world, V3d seen) {
        V3d light = test::with_photographer(b(world), seen) * exposure;
        light.x *= 1.2;
        return light;
    };
    std::vector<Unturned> views;
    views.push_back(unturned(ball_view(kPhoto, ball, {}, first), ball));
    views.push_back(unturned(ball_view(kPhoto, ball, kTurn, second), ball));
    return views;
}

TEST(Align, FindsAnyTurnWhateverExposureTintAndPhotographer) {
    const Place place(1);
    const ViewAlignment found = align_views(pair(place, place, 0.3));
    EXPECT_EQ(found.to_world[0], Rotation());
    EXPECT_LT(degrees_between(found.to_world[1], kTurn), 0.03);  // a pixel spans 1 degree
    for (const double agreement : found.agreement) EXPECT_GT(agreement, 0.8);
    for (const double residual : found.residual) EXPECT_LT(residual, 0.01);
}

/// Turns of cameras that look at the ball from that far apart, rolled and lifted at random.
std::vector<Rotation> random_turns(double apart, int count, unsigned seed) {
    std::mt19937 random(seed);  // its numbers are the same everywhere
    const auto angle = [&] { return 360 * (static_cast<double>(random()) / 4294967296.0); };
    std::vector<Rotation> turns;
    for (int i = 0; i < count; ++i)
        turns.push_back(Rotation::about_z(angle()) * Rotation::about_x(apart) *
                        Rotation::about_z(angle()));
    return turns;
}

/// Two balls far away in places, with who photographs them; the second one turned.
ViewAlignment aligned(const Place& a, const Place& b, const Rotation& turn) {
    const MirrorBall ball(kOutline);
    const auto shown = [](const Place& place) {
        return
            [&place](V3d world, V3d seen) { return test::with_photographer(place(world), seen); };
    };
    std::vector<Unturned> views;
    views.push_back(unturned(ball_view(kPhoto, ball, {}, shown(a)), ball));
    views.push_back(unturned(ball_view(kPhoto, ball, turn, shown(b)), ball));
    return align_views(std::move(views));
}

TEST(Align, FindsTurnsFromSixtyDegreesToBackToBack) {
    // Back to back both show sharply what the other shows at its rim only: nothing is fine there.
    struct Case {
        double apart, tolerance;
    };
    for (const auto& [apart, tolerance] : {Case{60, 0.05}, Case{120, 0.05}, Case{180, 0.15}}) {
        unsigned seed = static_cast<unsigned>(apart);
        for (const Rotation& turn : random_turns(apart, 1, seed)) {
            const Place place(++seed);
            const ViewAlignment found = aligned(place, place, turn);
            EXPECT_LT(degrees_between(found.to_world[1], turn), tolerance)
                << apart << " degrees, place " << seed;
            for (const double agreement : found.agreement)
                EXPECT_GT(agreement, kLeastAgreement + 0.1) << apart << " degrees, place " << seed;
        }
    }
}

TEST(Align, IsNotDrawnToATurnThatLaysOnePhotographerOnTheOther) {
    // Where correlation, to which two dark figures on each other count most, chose a wrong turn.
    struct Case {
        double apart;
        unsigned seed, place;
    };
    for (const auto& [apart, seed, place] : {Case{75, 75, 76}, Case{60, 1027, 327}}) {
        const Rotation turn = random_turns(apart, 1, seed).front();
        const ViewAlignment found = aligned(Place(place), Place(place), turn);
        EXPECT_LT(degrees_between(found.to_world[1], turn), 0.05) << "place " << place;
        for (const double agreement : found.agreement)
            EXPECT_GT(agreement, kLeastAgreement + 0.1) << "place " << place;
    }
}

TEST(Likeness, IsOneOfTheSameWhateverExposureAndTint) {
    const Place place(8);
    std::vector<ViewPyramid::Sample> a, b, other;
    for (const V3d& d : fibonacci_directions(1000)) {
        const auto sample = [](V3d light) {
            ViewPyramid::Sample one{{}, 1};
            for (int c = 0; c < 3; ++c) one.value[c] = static_cast<float>(std::log2(light[c]));
            return one;
        };
        a.push_back(sample(place(d)));
        b.push_back(sample({0.3 * place(d).x, 0.2 * place(d).y, 5 * place(d).z}));
        other.push_back(sample(place(Rotation::yaw_pitch_roll(70, 30, 20) * d)));
    }
    EXPECT_NEAR(likeness(a, b), 1, 1e-6);
    EXPECT_LT(std::abs(likeness(a, other)), 0.15);
    // A tenth of it shows something else, ten stops darker: it costs about that tenth.
    auto hidden = b;
    for (std::size_t i = 300; i < 400; ++i) std::fill_n(hidden[i].value, 3, -10.0F);
    EXPECT_GT(likeness(a, hidden), 0.8);
    // Nothing is said of what they hardly share.
    for (std::size_t i = 20; i < b.size(); ++i) b[i].weight = 0;
    EXPECT_EQ(likeness(a, b), -1);
}

TEST(Align, BelievesNoTurnOfDifferentPlaces) {
    unsigned number = 100;
    for (const double apart : {60.0, 180.0}) {
        const Rotation turn = random_turns(apart, 1, number).front();
        const ViewAlignment found = aligned(Place(number), Place(number + 1), turn);
        number += 2;
        for (const double agreement : found.agreement)
            EXPECT_LT(agreement, kLeastAgreement - 0.1) << apart << " degrees";
    }
}

TEST(Align, TellsViewsOfDifferentPlaces) {
    const ViewAlignment found = align_views(pair(Place(1), Place(2)));
    for (const double agreement : found.agreement) EXPECT_LT(agreement, kLeastAgreement - 0.1);
}

TEST(Align, IsTheSameForAnyNumberOfThreads) {
    const Place place(3);
    std::vector<ViewAlignment> found;
    for (const int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        found.push_back(align_views(pair(place, place)));
    }
    EXPECT_EQ(found[0].to_world[1], found[1].to_world[1]);
    EXPECT_EQ(found[0].residual, found[1].residual);
}

TEST(Align, LeavesTurnsThatAreToldAsTheyAre) {
    const Place place(4);
    auto views = pair(place, place);
    const Rotation wrong = Rotation::about_y(3) * kTurn;
    views[0].to_world = Rotation::about_x(20);
    views[1].to_world = Rotation::about_x(20) * wrong;
    const ViewAlignment found = align_views(std::move(views));
    EXPECT_EQ(found.to_world[0], Rotation::about_x(20));
    EXPECT_EQ(found.to_world[1], Rotation::about_x(20) * wrong);
}

TEST(Align, PutsTheOthersIntoTheFrameOfTheOneThatIsTold) {
    const Place place(4);
    auto views = pair(place, place);
    const Rotation world = Rotation::yaw_pitch_roll(-70, 12, 3);
    views[1].to_world = world;
    const ViewAlignment found = align_views(std::move(views));
    EXPECT_LT(degrees_between(found.to_world[0], world * kTurn.inverse()), 0.03);
}

TEST(Align, PutsAnOutlineRightThatIsOff) {
    const Place place(5);
    const MirrorBall ball(kOutline);
    const auto shown = [&](V3d world, V3d) { return place(world); };
    Outline off = kOutline;
    off.cx += 1.2;
    off.cy -= 0.6;
    off.a = off.b = 109.5;
    const Camera camera;
    auto views = std::vector{unturned(ball_view(kPhoto, ball, {}, shown), ball),
                             unturned(ball_view(kPhoto, ball, kTurn, shown), MirrorBall(off))};
    views[1].ball = BallModel{off, camera, true, 1};
    const ViewAlignment found = align_views(std::move(views));
    EXPECT_NEAR(found.change[1].right, -1.2, 0.1);
    EXPECT_NEAR(found.change[1].down, 0.6, 0.1);
    EXPECT_NEAR(found.change[1].growth, 110 / 109.5 - 1, 1e-3);
    EXPECT_LT(degrees_between(found.to_world[1], kTurn), 0.05);  // 1.2 pixels are 1.2 degrees
}

TEST(Align, FindsHowFarAwayCamerasStood) {
    const Place place(6);
    Camera camera;
    camera.focal = 110 * std::sqrt(8.0 * 8 - 1);
    camera.principal = V2d(120, 120);
    const MirrorBall near(camera, cone_of(kOutline, camera)), far(kOutline);
    const auto shown = [&](V3d world, V3d) { return place(world); };
    auto views = std::vector{unturned(ball_view(kPhoto, near, {}, shown), far),
                             unturned(ball_view(kPhoto, near, kTurn, shown), far)};
    Camera unknown;
    unknown.principal = V2d(120, 120);
    for (Unturned& view : views) view.ball = BallModel{kOutline, unknown, false, 0};
    const ViewAlignment found = align_views(std::move(views));
    for (const BallChange& change : found.change) EXPECT_NEAR(1 / change.inverse_distance, 8, 0.3);
    EXPECT_LT(degrees_between(found.to_world[1], kTurn), 0.05);
}

TEST(Align, StopsWhenAskedTo) {
    const Place place(1);
    const std::atomic<bool> stop = true;
    EXPECT_THROW(align_views(pair(place, place), {&stop, {}}), Error);
}

}  // namespace
}  // namespace chromeball
