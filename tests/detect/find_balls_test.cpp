#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "detect/detect.h"
#include "detect/painted.h"

namespace chromeball {
namespace {

using painted::camera_photo;
using painted::Scene;

const std::vector<float>& street_light() {
    static const std::vector<float> light = Scene{}.light();
    return light;
}

Candidate best_of(const Photo& photo, const DetectOptions& options = {}) {
    const auto balls = find_balls(photo, options);
    return balls.empty() ? Candidate{} : balls.front();
}

/// The contract's measure of a right outline: centre and both axes within a part of the radius.
void expect_outline(const Candidate& ball, const Outline& truth, double part) {
    EXPECT_GE(ball.confidence, DetectOptions().threshold);
    EXPECT_NEAR(ball.outline.cx, truth.cx, part * truth.b);
    EXPECT_NEAR(ball.outline.cy, truth.cy, part * truth.b);
    EXPECT_NEAR(ball.outline.a, truth.a, part * truth.a);
    EXPECT_NEAR(ball.outline.b, truth.b, part * truth.b);
}

void expect_no_ball(const Photo& photo) {
    for (const Candidate& ball : find_balls(photo)) EXPECT_LT(ball.confidence, 0.5);
}

Photo without_color(const Photo& photo) {
    Photo grey = painted::empty_photo(photo.window.size, PixelType::u8, 1);
    for (std::size_t i = 0; i < grey.pixels.size(); ++i) grey.pixels[i] = photo.pixels[3 * i + 1];
    return grey;
}

TEST(FindBalls, AMirrorBallInAStreetIsFoundToHalfAPercent) {
    const Scene scene;
    const Candidate ball = best_of(camera_photo(street_light(), scene.size));
    expect_outline(ball, scene.outline(), 0.005);
    EXPECT_GT(ball.visible_rim, 0.6);
    EXPECT_LT(ball.rim_blur, 2);
}

TEST(FindBalls, ABallThatIsKnownButForASixthOfItsRadiusIsFollowedFromThere) {
    const Scene scene;
    const Photo photo = camera_photo(street_light(), scene.size);
    const Outline truth = scene.outline();
    for (const V2d& off : {V2d(0, 0), V2d(0.12, 0.1), V2d(-0.1, -0.1), V2d(-0.15, 0.05)}) {
        DetectOptions options;
        options.start = Outline{truth.cx + off.x * truth.a, truth.cy + off.y * truth.a,
                                1.05 * truth.a, 1.05 * truth.a, 0};
        SCOPED_TRACE(off);
        expect_outline(best_of(photo, options), truth, 0.005);
    }
    // Of what lies elsewhere nothing is said.
    DetectOptions elsewhere;
    elsewhere.start = Outline{truth.cx - 3 * truth.a, truth.cy, truth.a, truth.a, 0};
    for (const Candidate& ball : find_balls(photo, elsewhere))
        EXPECT_GT(std::abs(ball.outline.cx - truth.cx), truth.a);
}

TEST(FindBalls, AnOffAxisBallIsAnEllipseThatPointsToTheMiddle) {
    Scene scene;
    scene.camera.focal = 520;
    scene.centre = {2.6, 1.5, -7};
    const Outline truth = scene.outline();
    ASSERT_GT(truth.a / truth.b, 1.05);
    const Candidate ball = best_of(camera_photo(scene));
    expect_outline(ball, truth, 0.01);
    EXPECT_NEAR(ball.outline.angle, truth.angle, 8);
}

TEST(FindBalls, TheKnownCameraGivesTheConesEllipse) {
    Scene scene;
    scene.camera.focal = 520;
    scene.centre = {2.6, 1.5, -7};
    const Candidate ball = best_of(camera_photo(scene), {.camera = scene.camera});
    expect_outline(ball, scene.outline(), 0.01);
    const auto shape = outline_of(cone_of(ball.outline, scene.camera), scene.camera).value();
    EXPECT_LT(rim_deviation(ball.outline, shape), 0.1);
}

TEST(FindBalls, AFlippedPictureHasTheFlippedOutline) {
    // A half pixel lost anywhere (pixel centres taken for corners) shows as a whole one here.
    const Scene scene;
    const Photo photo = camera_photo(street_light(), scene.size);
    Photo flipped = photo;
    const auto count = scene.size.pixels();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            flipped.pixels[3 * i + c] = photo.pixels[3 * (count - 1 - i) + c];
    const Outline one = best_of(photo).outline, other = best_of(flipped).outline;
    EXPECT_NEAR(one.cx + other.cx, scene.size.width, 0.3);
    EXPECT_NEAR(one.cy + other.cy, scene.size.height, 0.3);
}

TEST(FindBalls, CoordinatesAreThoseOfTheDisplayWindow) {
    const Scene scene;
    Photo photo = camera_photo(street_light(), scene.size);
    // The camera moves along; where its axis meets the picture has a say in the outline.
    Camera camera = scene.camera;
    const Outline at_corner = best_of(photo, {.camera = camera}).outline;
    photo.window.x = 100;
    photo.window.y = -40;
    camera.principal += V2d(100, -40);
    const Outline moved = best_of(photo, {.camera = camera}).outline;
    EXPECT_NEAR(moved.cx, at_corner.cx + 100, 0.2);
    EXPECT_NEAR(moved.cy, at_corner.cy - 40, 0.2);
}

TEST(FindBalls, SceneLinearFloatsOfAnyScaleWillDo) {
    const Scene scene;
    for (const float scale : {1e-3f, 1.f, 5e3f}) {
        std::vector<float> light = street_light();
        for (float& v : light) v *= scale;
        expect_outline(best_of(painted::float_photo(light, scene.size)), scene.outline(), 0.01);
    }
}

TEST(FindBalls, OneChannelIsEnough) {
    const Scene scene;
    expect_outline(best_of(without_color(camera_photo(street_light(), scene.size))),
                   scene.outline(), 0.01);
}

TEST(FindBalls, NoiseDoesNotHideTheBall) {
    const Scene scene;
    expect_outline(best_of(camera_photo(street_light(), scene.size, 8)), scene.outline(), 0.02);
}

TEST(FindBalls, ALowContrastPictureLikeALogEncodedOneIsSearchedToo) {
    const Scene scene;
    Photo photo = camera_photo(street_light(), scene.size, 0);
    for (std::byte& code : photo.pixels)
        code = static_cast<std::byte>(90 + std::to_integer<int>(code) / 3);
    expect_outline(best_of(photo), scene.outline(), 0.02);
}

TEST(FindBalls, APoleBeforeTheBallIsOutvoted) {
    Scene scene;
    const double left = scene.outline().cx + 30;
    scene.before = [left](double x, double) {
        return x > left && x < left + 45 ? V3d(0.2, 0.15, 0.1) : V3d(-1);
    };
    expect_outline(best_of(camera_photo(scene)), scene.outline(), 0.02);
}

TEST(FindBalls, AStandThatHidesTheBottomIsOutvoted) {
    Scene scene;
    const Outline o = scene.outline();
    scene.before = [o](double x, double y) {
        return std::abs(x - o.cx) < 0.55 * o.b && y > o.cy + 0.8 * o.b ? V3d(0.02) : V3d(-1);
    };
    expect_outline(best_of(camera_photo(scene)), o, 0.02);
}

TEST(FindBalls, ABallCutByTheFrameIsCompleted) {
    Scene scene;
    scene.centre = {-3.1, 0.5, -9};
    const Outline truth = scene.outline();
    ASSERT_LT(truth.cx - truth.a, -20);
    expect_outline(best_of(camera_photo(scene)), truth, 0.02);
}

TEST(FindBalls, ABallThatFillsThePictureIsFound) {
    Scene scene;
    scene.size = {480, 480};
    scene.camera = {1000.0, {240, 240}};
    scene.centre = {0, 0, -4.4};
    expect_outline(best_of(camera_photo(scene)), scene.outline(), 0.01);
}

/// Light as a lens out of focus gathers it: each point a disc of so many pixels' radius.
std::vector<float> out_of_focus(const std::vector<float>& light, Size size, double radius) {
    std::vector<float> soft(light.size());
    const int reach = static_cast<int>(radius);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            float sum[3] = {}, count = 0;
            for (int v = -reach; v <= reach; ++v)
                for (int u = -reach; u <= reach; ++u) {
                    if (u * u + v * v > radius * radius) continue;
                    const int i = std::clamp(x + u, 0, size.width - 1);
                    const int j = std::clamp(y + v, 0, size.height - 1);
                    for (int c = 0; c < 3; ++c)
                        sum[c] += light[static_cast<std::size_t>(3 * (j * size.width + i) + c)];
                    count += 1;
                }
            for (int c = 0; c < 3; ++c)
                soft[static_cast<std::size_t>(3 * (y * size.width + x) + c)] = sum[c] / count;
        }
    return soft;
}

TEST(FindBalls, ABallOutOfFocusIsFound) {
    const Scene scene;
    for (const double part : {0.01, 0.02, 0.03}) {
        const double radius = part * scene.outline().a;
        SCOPED_TRACE(radius);
        expect_outline(
            best_of(camera_photo(out_of_focus(street_light(), scene.size, radius), scene.size)),
            scene.outline(), 0.02);
    }
}

TEST(FindBalls, ASmallBallIsFound) {
    Scene scene;
    scene.centre = {4, 2.5, -30};
    ASSERT_LT(scene.outline().a, 35);
    expect_outline(best_of(camera_photo(scene)), scene.outline(), 0.02);
}

TEST(FindBalls, TwoRunsGiveTheSameNumbers) {
    const Photo photo = camera_photo(street_light(), Scene{}.size);
    const auto one = find_balls(photo), other = find_balls(photo);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].outline, other[i].outline);
        EXPECT_EQ(one[i].confidence, other[i].confidence);
    }
}

TEST(FindBalls, CandidatesComeBestFirstAndAreFew) {
    const auto balls = find_balls(camera_photo(street_light(), Scene{}.size));
    ASSERT_FALSE(balls.empty());
    EXPECT_LE(balls.size(), 8u);
    for (std::size_t i = 1; i < balls.size(); ++i)
        EXPECT_LE(balls[i].confidence, balls[i - 1].confidence);
}

TEST(FindBalls, NearAndRadiusRangeLeaveTheOthersOut) {
    const Scene scene;
    const Photo photo = camera_photo(street_light(), scene.size);
    const Outline truth = scene.outline();
    DetectOptions here, elsewhere, sized, smaller;
    here.near = V2d(truth.cx + 0.5 * truth.b, truth.cy);
    elsewhere.near = V2d(truth.cx + 1.3 * truth.b, truth.cy);
    sized.radius_range = {{0.9 * truth.b, 1.05 * truth.a}};
    smaller.radius_range = {{10, 0.8 * truth.b}};
    expect_outline(best_of(photo, here), truth, 0.01);
    expect_outline(best_of(photo, sized), truth, 0.01);
    EXPECT_LT(best_of(photo, elsewhere).confidence, 0.5);
    for (const Candidate& ball : find_balls(photo, smaller))
        EXPECT_LE(ball.outline.b, 0.81 * truth.b);
}

TEST(FindBalls, DeviationsAreOfTheErrorsSize) {
    const Scene scene;
    const Candidate ball = best_of(camera_photo(street_light(), scene.size));
    const Outline truth = scene.outline();
    for (const double d :
         {ball.deviation.cx, ball.deviation.cy, ball.deviation.a, ball.deviation.b}) {
        EXPECT_GT(d, 0.005);
        EXPECT_LT(d, 1);
    }
    EXPECT_LT(std::abs(ball.outline.cx - truth.cx), 6 * ball.deviation.cx + 0.2);
    EXPECT_LT(std::abs(ball.outline.a - truth.a), 6 * ball.deviation.a + 0.2);
}

// Round things that mirror nothing.

TEST(FindBalls, AMatteBallIsNotFound) {
    Scene scene;
    scene.surface = [](V3d n, V3d) {
        return V3d(0.4) * (0.15 + std::max(0.0, n.dot(V3d(0.5, 0.6, 0.62))));
    };
    expect_no_ball(camera_photo(scene, 2));
}

TEST(FindBalls, AGlossyBallWithAHighlightIsNotFound) {
    Scene scene;
    scene.surface = [](V3d n, V3d) {
        const double lit = std::max(0.0, n.dot(V3d(0.35, 0.5, 0.79)));
        return V3d(0.5, 0.05, 0.04) * (0.2 + lit) + V3d(1) * std::pow(lit, 120);
    };
    expect_no_ball(camera_photo(scene, 2));
}

TEST(FindBalls, AChequeredBallIsNotFound) {
    Scene scene;
    scene.surface = [](V3d n, V3d) {
        const int u = static_cast<int>(std::floor(std::atan2(n.x, n.z) * 4 / std::numbers::pi));
        const int v = static_cast<int>(std::floor(std::asin(n.y) * 6 / std::numbers::pi));
        return ((u + v) % 2 ? V3d(0.05) : V3d(0.1, 0.5, 0.15)) * (0.4 + 0.6 * n.y);
    };
    expect_no_ball(camera_photo(scene, 2));
}

TEST(FindBalls, AChequeredDiscIsNotFound) {
    Scene scene;
    const Outline o = scene.outline();
    scene.before = [o](double x, double y) {
        if (std::hypot(x - o.cx, y - o.cy) > o.b) return V3d(-1);
        const int u = static_cast<int>(std::floor(x / 23)),
                  v = static_cast<int>(std::floor(y / 23));
        return (u + v) % 2 ? V3d(0.8) : V3d(0.1);
    };
    expect_no_ball(camera_photo(scene, 2));
}

TEST(FindBalls, AWheelOfRingsAndSpokesIsNotFound) {
    Scene scene;
    const Outline o = scene.outline();
    scene.before = [o](double x, double y) {
        const double r = std::hypot(x - o.cx, y - o.cy) / o.b;
        if (r > 1) return V3d(-1);
        if (r > 0.75) return V3d(0.03);
        if (r > 0.65) return V3d(0.5);
        const double spoke = std::fmod(std::atan2(y - o.cy, x - o.cx) + 7, 0.628);
        return spoke < 0.2 || r < 0.15 ? V3d(0.45) : V3d(0.06);
    };
    expect_no_ball(camera_photo(scene, 2));
}

TEST(FindBalls, AStreetWithoutABallHasNone) {
    Scene scene;
    scene.centre = {0, 0, 9};  // behind the camera
    expect_no_ball(camera_photo(scene));
}

// Pictures that are none.

TEST(FindBalls, TinyAndThinPicturesHaveNoBallAndDoNotCrash) {
    for (const Size size :
         {Size{0, 0}, Size{1, 1}, Size{1, 50000}, Size{50000, 1}, Size{17, 17}, Size{20, 5000}})
        for (const int channels : {1, 2, 3, 4})
            expect_no_ball(painted::empty_photo(size, PixelType::u8, channels));
}

TEST(FindBalls, NotANumberAndInfinityDoNotCrash) {
    std::vector<float> light = street_light();
    const float odd[] = {std::numeric_limits<float>::quiet_NaN(),
                         std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity(), -1.f};
    for (std::size_t i = 0; i < light.size(); i += 997) light[i] = odd[i % 4];
    const Scene scene;
    expect_outline(best_of(painted::float_photo(light, scene.size)), scene.outline(), 0.02);
    std::fill(light.begin(), light.end(), odd[0]);
    expect_no_ball(painted::float_photo(light, scene.size));
    std::fill(light.begin(), light.end(), odd[1]);
    expect_no_ball(painted::float_photo(light, scene.size));
}

TEST(FindBalls, AStopEndsTheSearch) {
    const std::atomic<bool> stop = true;
    const Photo photo = camera_photo(street_light(), Scene{}.size);
    try {
        find_balls(photo, {}, {.stop = &stop});
        FAIL() << "nothing was thrown";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), Error::Kind::interrupted);
    }
}

}  // namespace
}  // namespace chromeball
