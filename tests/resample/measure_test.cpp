#include "resample/measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chromeball {
namespace {

Image filled(Size size, float r, float g, float b, float alpha) {
    Image image(size, 4);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const float pixel[4] = {r * alpha, g * alpha, b * alpha, alpha};
            std::copy_n(pixel, 4, image.pixel(x, y));
        }
    return image;
}

TEST(Measure, OfAFlatMapIsItsColourOverTheWholeSphere) {
    for (const Layout& layout : layouts()) {
        const MapMeasure m = measure(filled(layout.picture(32), 1, 2, 3, 1), &layout);
        EXPECT_NEAR(m.mean[0], 1, 1e-6) << layout.name;
        EXPECT_NEAR(m.mean[2], 3, 1e-6) << layout.name;
        EXPECT_NEAR(*m.covered_steradians, 4 * std::numbers::pi, 1e-9) << layout.name;
        EXPECT_NEAR(m.highest, m.lowest, 1e-6) << layout.name;
    }
}

TEST(Measure, WeighsBySolidAngleAndCountsWhatAlphaShows) {
    // The upper half is bright, the lower half is not shown: rows near the pole count for less.
    const Layout& latlong = *find_layout("latlong");
    Image map = filled({64, 32}, 4, 4, 4, 1);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            float* p = map.pixel(x, y);
            if (y == 0) p[0] = p[1] = p[2] = 400;  // the polar row: 0.24 % of the sphere
            if (y >= 16) std::fill_n(p, 4, 0.0F);
        }
    const MapMeasure m = measure(map, &latlong);
    EXPECT_NEAR(*m.covered_steradians, 2 * std::numbers::pi, 1e-9);
    EXPECT_NEAR(m.highest, 400, 1e-3);
    EXPECT_NEAR(m.lowest, 4, 1e-5);
    // The row's cosine over the sum of its half sphere's sixteen: 2 sin^2(pi / 64).
    EXPECT_NEAR(m.mean[1], 4 + 396 * 2 * std::pow(std::sin(std::numbers::pi / 64), 2), 1e-3);
    // As a mere picture every pixel counts the same.
    EXPECT_NEAR(measure(map, nullptr).mean[1], 4 + 396 / 16.0, 1e-3);
    EXPECT_FALSE(measure(map, nullptr).covered_steradians);
}

TEST(EmptyParts, AreTheCornersOfDisksAndTheCellsOfCrosses) {
    for (const char* name : {"angular", "mirror-ball", "cross-h", "cross-v"}) {
        const Layout& layout = *find_layout(name);
        Image map(layout.picture(32), 4);
        for (int y = 0; y < map.height(); ++y)
            for (int x = 0; x < map.width(); ++x) {
                const V2d p((x + 0.5) / map.width(), (y + 0.5) / map.height());
                const bool inside = std::visit([&](const auto& s) { return s.solid_angle(p) > 0; },
                                               layout.projection);
                if (inside) std::fill_n(map.pixel(x, y), 4, 1.0F);
            }
        EXPECT_TRUE(empty_parts_are_empty(map, layout)) << name;
        std::fill_n(map.pixel(0, 0), 4, 1.0F);
        EXPECT_FALSE(empty_parts_are_empty(map, layout)) << name;
    }
    const Layout& full = *find_layout("latlong");
    EXPECT_FALSE(empty_parts_are_empty(filled(full.picture(16), 0, 0, 0, 1), full));
}

}  // namespace
}  // namespace chromeball
