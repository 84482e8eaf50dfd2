#include "shot/solve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "shot/segments.h"
#include "shot/smooth.h"

namespace chromeball {
namespace {

constexpr double kNoise = 0.15;  // pixels, of the detections below

/// A shot with a moving ball of about 100 pixels' radius seen at 1000 pixels focal length, and what
/// a detection with noise makes of it.
struct Take {
    std::vector<Outline> truth;
    std::vector<TrackRecord> records;
};

using Path = std::function<V3d(double t)>;  ///< centre and radius, pixels

/// A slow move across the picture.
V3d drift(double t) {
    return {700 + 200 * std::sin(t / 20), 500 + 3 * t, 100 + 20 * std::cos(t / 25)};
}

Take take_of(const Path& path, int count, bool camera = true, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, kNoise);
    Take take;
    for (int i = 0; i < count; ++i) {
        TrackRecord r;
        r.frame = 1001 + i;
        r.display = {1920, 1080};
        r.camera.principal = V2d(960, 540);
        const V3d p = path(i);
        // Seen through a lens of 1000 pixels, whether that is known or not.
        Camera lens = r.camera;
        lens.focal = 1000;
        if (camera) r.camera = lens;
        const V3d axis = V3d((p.x - 960) / 1000, (540 - p.y) / 1000, -1).normalized();
        take.truth.push_back(outline_of({axis, std::atan(p.z / 1000)}, lens).value());
        Outline seen = take.truth.back();
        seen.cx += noise(random);
        seen.cy += noise(random);
        const double grown = noise(random);
        seen.a += grown;
        seen.b += grown;
        r.ball = Sighting{seen, V2d(kNoise, kNoise), kNoise, 0.9, 0.95, 0.3, true};
        take.records.push_back(r);
    }
    return take;
}

/// Root mean square of the rims' distances.
double rms(const std::vector<SolvedFrame>& solved, const std::vector<Outline>& truth) {
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
        sum += std::pow(rim_deviation(solved[i].outline.value(), truth[i]), 2);
    return std::sqrt(sum / static_cast<double>(truth.size()));
}

/// Root mean square second difference of the centre's error: what flickers.
double jitter(const std::vector<SolvedFrame>& solved, const std::vector<Outline>& truth) {
    double sum = 0;
    const auto error = [&](std::size_t i) { return solved[i].outline->cx - truth[i].cx; };
    for (std::size_t i = 1; i + 1 < truth.size(); ++i)
        sum += std::pow(error(i - 1) - 2 * error(i) + error(i + 1), 2);
    return std::sqrt(sum / static_cast<double>(truth.size() - 2));
}

void put(Take& take, std::size_t at, double cx, double cy, double r) {
    take.records[at].ball->outline = {cx, cy, r, r, 0};
}

TEST(Solve, BelievesSureSightingsFarFromAllOthers) {
    // Some frames in a row, and two on their own for a look further on.
    Take take = take_of(drift, 60);
    Take some;
    for (const std::size_t i : {0, 1, 2, 3, 4, 20, 50}) {
        some.records.push_back(take.records[i]);
        some.truth.push_back(take.truth[i]);
    }
    const auto solved = solve(some.records, {});
    for (std::size_t i = 0; i < some.truth.size(); ++i) {
        EXPECT_EQ(solved[i].outcome, FrameOutcome::found) << solved[i].frame;
        EXPECT_LT(rim_deviation(solved[i].outline.value(), some.truth[i]), 1.0) << solved[i].frame;
    }
}

TEST(Solve, TakesTheNoiseOutOfASlowMove) {
    for (const bool camera : {true, false}) {
        const Take take = take_of(drift, 60, camera);
        const auto solved = solve(take.records, {});
        // At the worst place of the rim, where single detections are off by 1.7 times their noise.
        EXPECT_LT(rms(solved, take.truth), (camera ? 1 : 1.4) * kNoise);
        EXPECT_LT(jitter(solved, take.truth), 0.15 * kNoise) << camera;  // white noise: 2.4
        for (const SolvedFrame& f : solved) {
            EXPECT_EQ(f.outcome, FrameOutcome::found);
            EXPECT_FALSE(f.flagged);
        }
    }
}

TEST(Solve, FollowsAShakingHand) {
    // 4 pixels at 3 and 2 pixels at 6 shakes a second.
    const auto shaken = [](double t) {
        return drift(t) + V3d(4 * std::sin(t * 0.79), 2 * std::sin(t * 1.6 + 1), 0);
    };
    const Take take = take_of(shaken, 96);
    const auto solved = solve(take.records, {});
    // As good as the detection itself: the shake is not taken for noise.
    EXPECT_LT(rms(solved, take.truth), 1.7 * kNoise);
    for (std::size_t i = 0; i < take.truth.size(); ++i)
        EXPECT_LT(rim_deviation(*solved[i].outline, take.truth[i]), 5 * kNoise) << i;
}

TEST(Solve, KeepsAStandingBallStill) {
    const Take take = take_of([](double) { return V3d(800, 500, 90); }, 40);
    const auto solved = solve(take.records, {});
    EXPECT_LT(jitter(solved, take.truth), 0.05 * kNoise);
    EXPECT_LT(rms(solved, take.truth), 0.7 * kNoise);
}

TEST(Solve, FollowsABallThatStartsAndStops) {
    const auto path = [](double t) {
        const double part = std::clamp((t - 30) / 20, 0.0, 1.0);
        return V3d(500 + 300 * part * part * (3 - 2 * part), 500, 90);
    };
    const Take take = take_of(path, 80);
    const auto solved = solve(take.records, {});
    for (std::size_t i = 0; i < take.truth.size(); ++i)
        // Where it starts and stops the acceleration jumps.
        EXPECT_LT(rim_deviation(*solved[i].outline, take.truth[i]), 5 * kNoise) << i;
}

TEST(Solve, OverrulesWhatWasSeenWrongly) {
    Take take = take_of(drift, 60);
    put(take, 10, 300, 900, 60);  // another thing
    put(take, 11, 310, 905, 61);
    put(take, 12, 305, 900, 60);
    put(take, 30, take.truth[30].cx + 9, take.truth[30].cy,
        take.truth[30].a - 6);   // its reflection
    put(take, 0, 100, 100, 40);  // at the ends
    put(take, 59, 100, 100, 40);
    const auto solved = solve(take.records, {});
    for (const std::size_t i : {10U, 11U, 12U, 30U}) {
        EXPECT_EQ(solved[i].outcome, FrameOutcome::filled) << i;
        EXPECT_TRUE(solved[i].flagged);
        EXPECT_NE(solved[i].message.find("overruled"), std::string::npos);
        EXPECT_LT(rim_deviation(*solved[i].outline, take.truth[i]), 3 * kNoise) << i;
    }
    for (const std::size_t i : {0U, 59U}) {
        EXPECT_EQ(solved[i].outcome, FrameOutcome::held) << i;
        EXPECT_LT(rim_deviation(*solved[i].outline, take.truth[i]), 25) << i;  // of the neighbour
    }
    EXPECT_EQ(solved[20].outcome, FrameOutcome::found);
}

TEST(Solve, FillsWhatIsPartlyHidden) {
    Take take = take_of(drift, 60);
    for (const std::size_t i : {20U, 21U, 22U}) {  // weak, and drawn to one side
        take.records[i].ball->outline.cx += 12;
        take.records[i].ball->sure = false;
        take.records[i].ball->confidence = 0.2;
    }
    const auto solved = solve(take.records, {});
    for (const std::size_t i : {20U, 21U, 22U}) {
        EXPECT_EQ(solved[i].outcome, FrameOutcome::filled);
        EXPECT_LT(rim_deviation(*solved[i].outline, take.truth[i]), 4 * kNoise) << i;
    }
}

TEST(Solve, DoesWithFramesWithoutABallWhatIsAsked) {
    Take take = take_of(drift, 60);
    for (std::size_t i = 30; i < 34; ++i) take.records[i].ball.reset();
    take.records[59].ball.reset();

    const auto held = solve(take.records, {});
    EXPECT_EQ(held[30].outcome, FrameOutcome::held);
    EXPECT_LT(rim_deviation(*held[30].outline, *held[29].outline), 0.5);
    EXPECT_LT(rim_deviation(*held[33].outline, *held[34].outline), 0.5);
    EXPECT_EQ(held[59].outcome, FrameOutcome::held);

    const auto filled = solve(take.records, {.missing = MissingFrames::interpolate});
    for (std::size_t i = 30; i < 34; ++i) {
        EXPECT_EQ(filled[i].outcome, FrameOutcome::filled);
        EXPECT_LT(rim_deviation(*filled[i].outline, take.truth[i]), 4 * kNoise) << i;
    }
    EXPECT_EQ(filled[59].outcome, FrameOutcome::held);  // there is no path beyond its end

    const auto skipped = solve(take.records, {.missing = MissingFrames::skip});
    EXPECT_EQ(skipped[31].outcome, FrameOutcome::missing);
    EXPECT_FALSE(skipped[31].outline);
    EXPECT_EQ(skipped[29].outcome, FrameOutcome::found);
}

TEST(Solve, TellsUnreadableFromMissing) {
    Take take = take_of(drift, 20);
    take.records[5].there = false;
    take.records[5].ball.reset();
    take.records[6].readable = false;
    take.records[6].ball.reset();
    take.records[6].message = "truncated";
    const auto solved = solve(take.records, {});
    EXPECT_EQ(solved[5].outcome, FrameOutcome::missing);
    EXPECT_EQ(solved[6].outcome, FrameOutcome::failed);
    EXPECT_EQ(solved[6].message, "truncated");
    EXPECT_FALSE(solved[5].outline);
    EXPECT_EQ(solved[7].outcome, FrameOutcome::found);
}

TEST(Solve, DoesNotSmoothAcrossACut) {
    const auto cut = [](double t) {
        return t < 25 ? V3d(500 + 2 * t, 500, 90) : V3d(1300 - 2 * t, 400, 60);
    };
    const Take take = take_of(cut, 50);
    const auto solved = solve(take.records, {});
    for (std::size_t i = 0; i < take.truth.size(); ++i) {
        EXPECT_LT(rim_deviation(*solved[i].outline, take.truth[i]), 4 * kNoise) << i;
        EXPECT_EQ(solved[i].piece, i < 25 ? 0 : 1);
    }
}

TEST(Solve, LocksABallThatStandsStill) {
    Take take = take_of([](double) { return V3d(800, 500, 90); }, 30);
    put(take, 3, 200, 200, 50);
    for (std::size_t i = 10; i < 20; ++i) take.records[i].ball.reset();
    const auto solved = solve(take.records, {.lock = true});
    for (const SolvedFrame& f : solved) EXPECT_EQ(f.outline, solved[0].outline);
    EXPECT_LT(rim_deviation(*solved[0].outline, take.truth[0]),
              kNoise);  // the worst place of the rim
    EXPECT_EQ(solved[3].outcome, FrameOutcome::filled);
    EXPECT_EQ(solved[15].outcome, FrameOutcome::filled);
    EXPECT_EQ(solved[5].outcome, FrameOutcome::found);
}

TEST(Solve, LetsKeysWin) {
    Take take = take_of(drift, 40);
    for (std::size_t i = 18; i < 23; ++i) take.records[i].ball.reset();
    SolveOptions options{.missing = MissingFrames::interpolate};
    const Outline& truth = take.truth[20];
    options.keys[1021] = {truth.cx + 5, truth.cy, truth.a, truth.a, 0};
    const auto solved = solve(take.records, options);
    EXPECT_NEAR(solved[20].outline->cx, truth.cx + 5, 1);      // the circle's cone is an ellipse
    EXPECT_GT(solved[19].outline->cx - take.truth[19].cx, 2);  // its neighbours follow
    EXPECT_NE(solved[20].message.find("--key"), std::string::npos);
}

TEST(Solve, GoesThroughKeysAndStaysAsStiffAsWithoutThem) {
    const Take take = take_of(drift, 80);
    const auto plain = solve(take.records, {});
    SolveOptions options;
    const Outline& truth = take.truth[40];
    const Outline key{truth.cx + 6, truth.cy - 3, truth.a, truth.b, truth.angle};
    options.keys[1041] = key;
    const auto solved = solve(take.records, options);
    EXPECT_LT(rim_deviation(*solved[40].outline, key), 0.15);  // up to the cone's shape
    // It bends to the key smoothly, and far from it nothing shakes.
    EXPECT_GT(solved[41].outline->cx, plain[41].outline->cx + 1);
    EXPECT_LT(solved[41].outline->cx, solved[40].outline->cx + 1);
    std::vector<SolvedFrame> far(solved.begin(), solved.begin() + 25);
    const std::vector<Outline> truths(take.truth.begin(), take.truth.begin() + 25);
    EXPECT_LT(jitter(far, truths), 0.15 * kNoise);
    const std::vector<SolvedFrame> before(plain.begin(), plain.begin() + 25);
    EXPECT_LT(rms(far, truths), rms(before, truths) + 0.5 * kNoise);
}

TEST(Solve, LocksTheBallWhereAKeyPutsIt) {
    const Take take = take_of([](double) { return V3d(800, 500, 90); }, 20);
    SolveOptions options{.lock = true};
    const Outline& seen = take.truth[3];
    options.keys[1004] = {seen.cx + 4, seen.cy, seen.a, seen.b, seen.angle};
    for (const SolvedFrame& f : solve(take.records, options))
        EXPECT_LT(rim_deviation(*f.outline, options.keys[1004]), 0.2) << f.frame;
}

TEST(Solve, TakesTheShapeOfAKeyThatIsAnEllipse) {
    const Take take = take_of([](double) { return V3d(960, 540, 90); }, 30, false);
    SolveOptions options;
    options.keys[1015] = {960, 540, 100, 80, 30};
    const Outline solved = *solve(take.records, options)[14].outline;
    EXPECT_LT(rim_deviation(solved, options.keys[1015]), 0.3);
    options.keys[1015] = {960, 540, 90, 90, 0};  // a circle tells place and size only
    EXPECT_LT(rim_deviation(*solve(take.records, options)[14].outline, take.truth[14]), 0.5);
}

TEST(Solve, TrustsAKeyMoreThanSightingsAroundIt) {
    // Another ball is taken for it, all the time but in the first and last frames.
    Take take = take_of(drift, 40);
    for (std::size_t i = 12; i < 26; ++i) put(take, i, 1500, 300, 60);
    const auto wrong = solve(take.records, {});
    EXPECT_GT(rim_deviation(*wrong[18].outline, take.truth[18]), 100);
    SolveOptions options{.missing = MissingFrames::interpolate};
    options.keys[1019] = take.truth[18];
    const auto solved = solve(take.records, options);
    for (std::size_t i = 12; i < 26; ++i)
        EXPECT_LT(rim_deviation(*solved[i].outline, take.truth[i]), 10) << i;
    EXPECT_EQ(solved[15].outcome, FrameOutcome::filled);
}

/// The same with what shapes tell of the lens; `spread` is its deviation, a part.
Take with_hints(Take take, double focal, double spread) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, spread);
    for (TrackRecord& r : take.records)
        r.ball->focal = FocalHint{focal * std::exp(noise(random)), focal * spread};
    return take;
}

TEST(Solve, TellsTheFocalLengthOfAShotFromAllItsOutlines) {
    Take take = with_hints(take_of(drift, 60, false), 1000, 0.1);
    take.records[7].ball->focal = FocalHint{200, 5};  // wrong, and sure of it
    take.records[30].ball->focal.reset();
    take.records[31].ball.reset();
    take.records[32].readable = false;
    const auto hint = focal_of_shot(take.records);
    ASSERT_TRUE(hint);
    EXPECT_NEAR(hint->focal, 1000, 50);
    // Twelve neighbours count as one: 60 frames as five.
    EXPECT_NEAR(hint->deviation, 100 / std::sqrt(5.0), 20);
}

TEST(Solve, TellsNoFocalLengthWhereItIsKnownOrHardlyAnyOutlineDoes) {
    EXPECT_FALSE(focal_of_shot({}));
    EXPECT_FALSE(focal_of_shot(take_of(drift, 20, false).records));
    EXPECT_FALSE(focal_of_shot(with_hints(take_of(drift, 20, true), 900, 0.1).records));
    Take few = with_hints(take_of(drift, 20, false), 1000, 0.1);
    EXPECT_TRUE(focal_of_shot(few.records));
    for (std::size_t i = 3; i < 20; ++i) few.records[i].ball->focal.reset();
    EXPECT_FALSE(focal_of_shot(few.records));
    Take distant = with_hints(take_of(drift, 20, false), 1000, 0.1);
    distant.records[4].distance = 12;
    EXPECT_FALSE(focal_of_shot(distant.records));
}

TEST(Solve, TakesToldOutlinesAsTheyAre) {
    Take take = take_of(drift, 5);
    const auto solved = solve(take.records, {.told = true});
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(solved[i].outline, take.records[i].ball->outline);
}

TEST(Solve, AnswersForShotsOfAnyLength) {
    EXPECT_TRUE(solve({}, {}).empty());
    for (int count = 1; count < 7; ++count) {
        const Take take = take_of(drift, count);
        const auto solved = solve(take.records, {});
        for (std::size_t i = 0; i < take.truth.size(); ++i)
            EXPECT_LT(rim_deviation(*solved[i].outline, take.truth[i]), 6 * kNoise);
    }
    Take none = take_of(drift, 3);
    for (TrackRecord& r : none.records) r.ball.reset();
    EXPECT_EQ(solve(none.records, {})[1].outcome, FrameOutcome::missing);
}

TEST(Pieces, KeepAStrayRunOutAndANewPlaceIn) {
    std::vector<Waypoint> points;
    for (int i = 0; i < 30; ++i) points.push_back({i, 100.0 + i, 100, 50, 1, false});
    points[10].x = points[11].x = 700;
    auto pieces = pieces_of(points);
    EXPECT_EQ(pieces[10], -1);
    EXPECT_EQ(pieces[11], -1);
    EXPECT_EQ(pieces[9], 0);
    EXPECT_EQ(pieces[29], 0);
    points[10].certain = true;
    EXPECT_NE(pieces_of(points)[10], -1);
    points[10].certain = false;
    for (std::size_t i = 15; i < 30; ++i) points[i].y = 500;
    pieces = pieces_of(points);
    EXPECT_EQ(pieces[14], 0);
    EXPECT_EQ(pieces[15], 1);
    EXPECT_TRUE(pieces_of({}).empty());
}

TEST(Pieces, TakeAFastPanForNoJump) {
    std::vector<Waypoint> points;
    for (int i = 0; i < 30; ++i) points.push_back({i, 40.0 * i, 100, 50, 1, false});
    for (const int piece : pieces_of(points)) EXPECT_EQ(piece, 0);
}

TEST(Smooth, GoesThroughEvenChangesWithoutBias) {
    Samples samples;
    samples.count = 50;
    for (int i = 0; i < 50; i += 1 + i % 3) {
        samples.at.push_back(i);
        samples.value.push_back(1000 + 3 * i - 0.1 * i * i + 1e-3 * i * i * i);
        samples.deviation.push_back(0.1);
        samples.weight.push_back(1);
    }
    const Smoothed curve = smooth(samples, {});
    for (int i = 0; i < 50; ++i)  // a cubic is what differences of order 4 leave free
        EXPECT_NEAR(curve.value[static_cast<std::size_t>(i)],
                    1000 + 3 * i - 0.1 * i * i + 1e-3 * i * i * i, 1e-3);
}

TEST(Smooth, FindsHowLargeTheNoiseReallyIs) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 1);
    Samples samples;
    samples.count = 300;
    for (int i = 0; i < 300; ++i) {
        samples.at.push_back(i);
        samples.value.push_back(noise(random));
        samples.deviation.push_back(0.4);
        samples.weight.push_back(1);
    }
    EXPECT_NEAR(smooth(samples, {}).noise, 2.5, 0.3);
}

}  // namespace
}  // namespace chromeball
