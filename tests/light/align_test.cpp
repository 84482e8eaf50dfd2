#include "light/align.h"

#include <gtest/gtest.h>

#include "light/bracket_scene.h"

namespace chromeball {
namespace {

using namespace test;

constexpr Size kSize{240, 180};

void expect_shifts(const std::vector<Alignment>& found, const std::vector<Take>& takes,
                   double tolerance) {
    for (std::size_t k = 0; k < takes.size(); ++k) {
        EXPECT_TRUE(found[k].measured) << k;
        EXPECT_LT((found[k].shift - takes[k].shift).length(), tolerance)
            << k << ": " << found[k].shift.x << ", " << found[k].shift.y;
    }
}

TEST(Align, FindsFractionsOfAPixelAcrossExposures) {
    const std::vector<Take> takes{
        {0.03, {3.4, -2.7}}, {0.08, {0, 0}}, {0.2, {-5.25, 1.5}}, {0.5, {1.2, 8.6}}};
    const auto photos = photos_of(textured, kSize, takes);
    const std::vector<int> order{0, 1, 2, 3};
    expect_shifts(align(photos, order, 1, Response::srgb()), takes, 0.06);
}

TEST(Align, TakesTheBallsOutlinesForAStart) {
    // Waves of 20 pixels look alike every 20 pixels: only the hint knows which.
    const auto waves = [](double x, double y) {
        const double v = 0.3 + 0.1 * std::sin(0.314159 * x) + 0.1 * std::sin(0.314159 * y);
        return Rgb{v, v, v};
    };
    const std::vector<Take> takes{{1, {0, 0}}, {0.5, {41.3, -20.6}}};
    const auto photos = photos_of(waves, kSize, takes);
    AlignOptions options;
    options.hints = {V2d(0, 0), V2d(39, -22)};
    const std::vector<int> order{1, 0};
    expect_shifts(align(photos, order, 0, Response::srgb(), options), takes, 0.06);
}

TEST(Align, LooksOnlyAtTheRegion) {
    // Outside everything moves the other way.
    const V2d shift(4.3, 2.2);
    const auto here = [](double x, double y) {
        return x > 60 && x < 180 && y > 40 && y < 140 ? textured(x, y) : textured(240 - x, y);
    };
    const auto there = [&](double x, double y) {
        return x > 60 && x < 180 && y > 40 && y < 140 ? textured(x, y)
                                                      : textured(240 - x - 2 * shift.x, y);
    };
    std::vector<ExposedPhoto> photos{photo_of(here, kSize, {0.1, {0, 0}}, 1),
                                     photo_of(there, kSize, {0.05, shift}, 2)};
    AlignOptions options;
    options.region = Window{65, 45, {110, 90}};
    const std::vector<int> order{1, 0};
    const auto found = align(photos, order, 0, Response::srgb(), options);
    EXPECT_LT((found[1].shift - shift).length(), 0.1);
}

TEST(Align, AWrongCurveHardlyMovesIt) {
    std::vector<Take> takes{{0.1, {0, 0}}, {0.3, {2.5, -1.25}}};
    for (Take& take : takes) take.curve = contrasty;
    const auto photos = photos_of(textured, kSize, takes);
    const std::vector<int> order{0, 1};
    expect_shifts(align(photos, order, 0, Response::srgb()), takes, 0.15);
}

TEST(Align, KeepsATripodStill) {
    const std::vector<Take> takes{{0.03, {0, 0}}, {0.1, {0, 0}}, {0.5, {0, 0}}};
    const auto found =
        align(photos_of(textured, kSize, takes), std::vector<int>{0, 1, 2}, 1, Response::srgb());
    for (const Alignment& one : found) EXPECT_EQ(one.shift, V2d(0, 0));
}

/// Where the ball is taken to be.
constexpr Window kBall{80, 50, {90, 80}};
bool in_ball(double x, double y) { return x > 80 && x < 170 && y > 50 && y < 130; }

/// Somebody in a coat with a pattern of its own.
Rgb passer_by(double x, double y) {
    const double v = 0.4 * (1 + 0.4 * grain(x / 9 + 700, y / 9 + 300));
    return {v, 0.7 * v, 0.5 * v};
}

TEST(Align, LaysAPhotoWhoseRegionIsHiddenOnTheOthersByWhatLiesAround) {
    const std::vector<Take> takes{{0.06, {3.3, -2.4}}, {0.1, {0, 0}}, {0.3, {-1.6, 4.2}}};
    const auto hidden = [](double x, double y) {
        return in_ball(x, y) ? passer_by(x, y) : textured(x, y);
    };
    auto photos = photos_of(textured, kSize, takes);
    photos[0] = photo_of(hidden, kSize, takes[0], 1);
    AlignOptions options;
    options.region = kBall;
    const std::vector<int> order{0, 1, 2};
    expect_shifts(align(photos, order, 1, Response::srgb(), options), takes, 0.1);
    // A hint for it is another ball's beside it, or what was taken for one.
    options.hints = {V2d(61, -7), V2d(0, 0), V2d(-1, 4)};
    expect_shifts(align(photos, order, 1, Response::srgb(), options), takes, 0.1);
}

TEST(Align, DoesNotBelieveAHintThatThePictureContradicts) {
    const std::vector<Take> takes{{0.06, {2.2, 1.4}}, {0.15, {0, 0}}};
    const auto photos = photos_of(textured, kSize, takes);
    AlignOptions options;
    options.region = kBall;
    options.hints = {V2d(-48, 20), V2d(0, 0)};
    expect_shifts(align(photos, std::vector<int>{0, 1}, 1, Response::srgb(), options), takes, 0.1);
}

TEST(Align, SaysOfAPhotoOfSomethingElseThatItIs) {
    const std::vector<Take> takes{{0.06, {2.2, 1.4}}, {0.15, {0, 0}}, {0.3, {-2.5, 0.7}}};
    auto photos = photos_of(textured, kSize, takes);
    photos[0] = photo_of(passer_by, kSize, {0.15, {0, 0}}, 1);
    for (const bool hinted : {false, true}) {
        AlignOptions options;
        if (hinted) {
            options.region = kBall;
            options.hints = {V2d(3, 2), V2d(0, 0), V2d(-2, 1)};
        }
        const auto found = align(photos, std::vector<int>{0, 1, 2}, 1, Response::srgb(), options);
        EXPECT_FALSE(found[0].measured);
        EXPECT_TRUE(found[0].unlike);
        EXPECT_TRUE(found[2].measured);
        EXPECT_FALSE(found[2].unlike);
        EXPECT_LT((found[2].shift - takes[2].shift).length(), 0.1);
    }
}

TEST(Align, LaysPhotosOnTheOthersAcrossOneOfSomethingElse) {
    const std::vector<Take> takes{{0.05, {2.2, 1.4}}, {0.15, {9, 9}}, {0.3, {0, 0}}};
    auto photos = photos_of(textured, kSize, takes);
    photos[1] = photo_of(passer_by, kSize, {0.15, {0, 0}}, 2);
    const auto found = align(photos, std::vector<int>{0, 1, 2}, 2, Response::srgb());
    EXPECT_TRUE(found[1].unlike);
    EXPECT_TRUE(found[0].measured);
    EXPECT_LT((found[0].shift - takes[0].shift).length(), 0.1);
}

TEST(Align, KnowsPhotosInNoiseForTheSame) {
    // The short exposure's texture is hardly more than its noise and steps.
    std::vector<Take> takes{{0.02, {2.2, 1.4}}, {0.15, {0, 0}}};
    for (Take& take : takes) take.noise = 0.004;
    for (const bool whole : {true, false}) {
        AlignOptions options;
        if (!whole) options.region = kBall;
        const auto found = align(photos_of(textured, kSize, takes), std::vector<int>{0, 1}, 1,
                                 Response::srgb(), options);
        EXPECT_TRUE(found[0].measured);
        EXPECT_LT((found[0].shift - takes[0].shift).length(), 0.3);
    }
}

TEST(Align, SaysWhenPhotosShareNothing) {
    std::vector<Take> takes{{1, {0, 0}}, {1000, {0, 0}}};
    const auto found =
        align(photos_of(textured, kSize, takes), std::vector<int>{0, 1}, 0, Response::srgb());
    EXPECT_TRUE(found[0].measured);
    EXPECT_FALSE(found[1].measured);
    EXPECT_EQ(found[1].shift, V2d(0, 0));
}

}  // namespace
}  // namespace chromeball
