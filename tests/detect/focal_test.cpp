#include <gtest/gtest.h>

#include <cmath>

#include "detect/detect.h"
#include "detect/focal.h"
#include "detect/painted.h"

// The focal length that a ball's outline tells, where it does.

namespace chromeball {
namespace {

using painted::camera_photo;
using painted::Scene;

std::optional<FocalEstimate> told_by(const Photo& photo, const DetectOptions& options = {}) {
    const auto balls = find_balls(photo, options);
    return balls.empty() ? std::nullopt : balls.front().focal;
}

TEST(Focal, WideLensesAreMeasuredWithinTheirDeviation) {
    struct Case {
        double focal;
        V3d centre;
    };
    for (const auto& [focal, centre] : {Case{520, {2.6, 1.5, -7}}, Case{700, {1.7, -2, -8}},
                                        Case{600, {-3, 1, -8}}, Case{800, {-2, 1, -9}}}) {
        Scene scene;
        scene.camera.focal = focal;
        scene.centre = centre;
        const auto told = told_by(camera_photo(scene));
        ASSERT_TRUE(told) << focal;
        EXPECT_LT(told->deviation, 0.2 * focal);
        EXPECT_NEAR(told->focal, focal, 3 * told->deviation);
    }
}

TEST(Focal, ABallInTheMiddleTellsNothing) {
    Scene scene;
    scene.camera.focal = 520;
    scene.centre = {0.1, 0.05, -7};
    EXPECT_EQ(told_by(camera_photo(scene)), std::nullopt);
}

TEST(Focal, AKnownCameraIsNotAskedAgain) {
    Scene scene;
    scene.camera.focal = 520;
    scene.centre = {2.6, 1.5, -7};
    EXPECT_EQ(told_by(camera_photo(scene), {.camera = scene.camera}), std::nullopt);
}

TEST(Focal, AnEllipseThatPointsElsewhereTellsNothing) {
    // 200 pixels right of the principal point, longer along the line to it, or across it.
    const detecting::Lens lens{1000, 500, 400};
    detecting::ShapeCovariance sure{};
    sure[3][3] = sure[4][4] = 1e-8;
    EXPECT_TRUE(detecting::focal_of({700, 400, 80, 0.01, 0}, sure, lens));
    EXPECT_FALSE(detecting::focal_of({700, 400, 80, -0.01, 0}, sure, lens));
    EXPECT_FALSE(detecting::focal_of({700, 400, 80, 0.01, 0.01}, sure, lens));
    EXPECT_FALSE(detecting::focal_of({500, 400, 80, 0.01, 0}, sure, lens));
    // The same, but hardly known.
    sure[3][3] = sure[4][4] = 1e-4;
    EXPECT_FALSE(detecting::focal_of({700, 400, 80, 0.01, 0}, sure, lens));
}

TEST(Focal, TheDeviationIsThatOfTheShape) {
    const detecting::Lens lens{1000, 500, 400};
    detecting::ShapeCovariance covariance{};
    covariance[3][3] = 4e-6;  // 0.002 of 0.02: a tenth, and so half a tenth of the focal length
    const auto told = detecting::focal_of({700, 400, 80, 0.02, 0}, covariance, lens);
    ASSERT_TRUE(told);
    EXPECT_NEAR(told->deviation / told->focal, 0.05, 0.01);
}

}  // namespace
}  // namespace chromeball
