#include "detect/edge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "detect/grey.h"
#include "detect/painted.h"

namespace chromeball {
namespace {

using painted::Scene;

/// Blurs rows of RGB by a Gaussian's sigma, pixels, and turns rows into columns.
std::vector<float> blurred_and_turned(const std::vector<float>& light, Size size, double sigma) {
    const int reach = static_cast<int>(std::ceil(4 * sigma));
    std::vector<float> turned(light.size());
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            for (int c = 0; c < 3; ++c) {
                double sum = 0, weights = 0;
                for (int i = -reach; i <= reach; ++i) {
                    const int from = std::clamp(x + i, 0, size.width - 1);
                    const double weight = sigma > 0 ? std::exp(-0.5 * i * i / (sigma * sigma)) : 1;
                    weights += weight;
                    sum += weight *
                           static_cast<double>(
                               light[static_cast<std::size_t>(3 * (y * size.width + from) + c)]);
                }
                turned[static_cast<std::size_t>(3 * (x * size.height + y) + c)] =
                    static_cast<float>(sum / weights);
            }
    return turned;
}

/// Scene-linear light through a lens that blurs by a sigma, pixels.
Photo blurred_photo(const Scene& scene, double sigma) {
    const auto [width, height] = scene.size;
    const auto columns = blurred_and_turned(scene.light(), scene.size, sigma);
    return painted::float_photo(blurred_and_turned(columns, {height, width}, sigma), scene.size);
}

detecting::EdgeFit fit_of(const Scene& scene, double sigma) {
    const detecting::Lens lens{*scene.camera.focal, scene.camera.principal.x,
                               scene.camera.principal.y, true};
    const auto grey = detecting::grey_of(blurred_photo(scene, sigma));
    return detecting::fit_edge(grey, scene.outline(), {.rays = 320, .step = 0.7}, lens);
}

TEST(Edge, TellsTheBlursOfSharpPicturesApart) {
    // The finest that a renderer's picture has, and a lens's of 0.4 pixels on top: less than a
    // tenth of a pixel between them, which moves the rim by more than that.
    Scene scene;
    scene.samples = 3;
    const double sharp = fit_of(scene, 0).blur, softer = fit_of(scene, 0.4).blur;
    EXPECT_LT(sharp, softer);
    EXPECT_GT(sharp, 0.3);  // a pixel's own, and that of looking between pixels
    EXPECT_LT(sharp, 0.5);
    EXPECT_LT(softer, 0.64);
}

}  // namespace
}  // namespace chromeball
