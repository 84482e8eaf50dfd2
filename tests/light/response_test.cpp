#include "light/response.h"

#include <gtest/gtest.h>

#include "light/bracket_scene.h"

namespace chromeball {
namespace {

using namespace test;

constexpr Size kSize{240, 160};

std::vector<V2d> still(std::size_t count) { return std::vector<V2d>(count, V2d(0, 0)); }

std::vector<Take> takes_at(const std::vector<double>& stops, double (*curve)(double)) {
    std::vector<Take> takes;
    for (const double s : stops) takes.push_back({std::exp2(s), {0, 0}, curve});
    return takes;
}

using Told = std::vector<std::optional<double>>;

BracketFit fit_of(const std::vector<ExposedPhoto>& photos, const Told& told, bool solve) {
    const auto patches = even_patches(photos, still(photos.size()));
    return fit_bracket(patches, photos, told, {Response::srgb(), solve});
}

/// Largest difference of a curve from the one that took the photos, stops, over well shown numbers.
double curve_error(const Response& response, double (*curve)(double)) {
    double least = 1e9, most = -1e9;
    for (double light = 0.02; light < 0.85; light *= 1.1) {
        const auto found = static_cast<double>(response.light(static_cast<float>(curve(light))));
        const double off = std::log2(found / light);
        least = std::min(least, off), most = std::max(most, off);
    }
    return most - least;
}

TEST(Response, OfSrgbUndoesItsEncoding) {
    const Response response = Response::srgb();
    for (double light = 0.001; light <= 1; light *= 1.3)
        EXPECT_NEAR(response.light(static_cast<float>(srgb_encoded(light))), light, 1e-5);
    EXPECT_EQ(response.light(1), 1);
    EXPECT_EQ(response.light(0), 0);
    // Slope of the power law at 0.5: 2.4 / 1.055 ((0.5 + 0.055) / 1.055)^1.4.
    EXPECT_NEAR(response.slope(0.5f), 0.9248, 2e-3);
}

TEST(Response, LinearGoesOnBeyondWhite) {
    EXPECT_EQ(Response::linear().light(17), 17);
    EXPECT_EQ(Response::linear().slope(17), 1);
}

TEST(BracketFit, FindsExposuresThatNobodyTold) {
    const std::vector<double> stops{-3, -1.1, 0.2, 2};
    const auto photos = photos_of(squares, kSize, takes_at(stops, srgb_encoded));
    const BracketFit fit = fit_of(photos, Told(4), false);
    for (std::size_t k = 0; k < 4; ++k) {
        ASSERT_TRUE(fit.stops[k]);
        // A hundredth of a stop: rounding to 8 bits, averaged over patches.
        EXPECT_NEAR(*fit.stops[k] - *fit.stops[0], stops[k] - stops[0], 0.01) << k;
    }
    EXPECT_LT(fit.rms_stops, 0.02);
}

TEST(BracketFit, RecoversACurveThatIsNotSrgb) {
    const std::vector<double> stops{-3, -1.5, 0, 1.5, 3};
    const auto photos = photos_of(squares, kSize, takes_at(stops, contrasty));
    const Told told(stops.begin(), stops.end());
    const BracketFit solved = fit_of(photos, told, true);
    EXPECT_GT(curve_error(Response::srgb(), contrasty), 0.5);
    EXPECT_LT(curve_error(solved.response, contrasty), 0.06);
    EXPECT_LT(solved.rms_stops, 0.6 * fit_of(photos, told, false).rms_stops);
    EXPECT_GT(solved.curve_stops, 0.3);
}

TEST(BracketFit, LeavesATrueCurveAlone) {
    const std::vector<double> stops{-3, -1.5, 0, 1.5, 3};
    const auto photos = photos_of(squares, kSize, takes_at(stops, srgb_encoded));
    const BracketFit solved = fit_of(photos, Told(stops.begin(), stops.end()), true);
    EXPECT_LT(curve_error(solved.response, srgb_encoded), 0.03);
}

TEST(BracketFit, TheCurveRisesEverywhere) {
    const std::vector<double> stops{-2, 0, 2};
    const auto photos = photos_of(squares, kSize, takes_at(stops, contrasty));
    const BracketFit solved = fit_of(photos, Told(stops.begin(), stops.end()), true);
    for (float z = 0; z < 1; z += 1 / 255.0f)
        EXPECT_GE(solved.response.light(z + 1 / 255.0f), solved.response.light(z)) << z;
}

TEST(BracketFit, SeesThroughOneWrongTag) {
    const std::vector<double> stops{-3, -1.5, 0, 1.5, 3};
    Told told(stops.begin(), stops.end());
    told[3] = 3.5;  // two stops too much
    for (const bool solve : {false, true}) {
        auto* const curve = solve ? contrasty : srgb_encoded;
        const auto photos = photos_of(squares, kSize, takes_at(stops, curve));
        const BracketFit fit = fit_of(photos, told, solve);
        for (std::size_t k = 0; k < stops.size(); ++k)
            EXPECT_NEAR(*fit.stops[k], stops[k], 0.08) << k << (solve ? " solved" : "");
    }
}

TEST(BracketFit, SaysWhichPhotoCannotBeSolved) {
    // Nine stops apart: nothing is well exposed in both.
    const auto flat = [](double, double) { return Rgb{0.5, 0.5, 0.5}; };
    const auto photos = photos_of(flat, kSize, takes_at({0, -0.5, -9}, srgb_encoded));
    const BracketFit fit = fit_of(photos, {0.0, std::nullopt, std::nullopt}, false);
    EXPECT_TRUE(fit.stops[0] && fit.stops[1]);
    EXPECT_FALSE(fit.stops[2]);
}

TEST(EvenPatches, AreFoundWhereTheShiftSaysTheyAre) {
    const std::vector<Take> takes{{1, {0, 0}}, {1, {32, -16}}};
    const auto photos = photos_of(squares, kSize, takes);
    const std::vector<V2d> shifts{V2d(0, 0), V2d(32, -16)};
    const auto patches = even_patches(photos, shifts);
    ASSERT_GT(patches.size(), 50U);
    for (const Patch& patch : patches)
        if (std::isfinite(patch.stored[0][1]) && std::isfinite(patch.stored[1][1])) {
            EXPECT_NEAR(patch.stored[0][1], patch.stored[1][1], 0.01);
        }
}

}  // namespace
}  // namespace chromeball
