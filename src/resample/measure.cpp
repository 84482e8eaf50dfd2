#include "resample/measure.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "core/luminance.h"

namespace chromeball {

MapMeasure measure(const Image& pixels, const Layout* layout) {
    MapMeasure result;
    result.lowest = std::numeric_limits<double>::infinity();
    double covered = 0, whole = 0;
    std::array<double, 3> sum{};
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x) {
            double weight = 1;
            if (layout) {
                const V2d p((x + 0.5) / pixels.width(), (y + 0.5) / pixels.height());
                weight = std::visit([&](const auto& shape) { return shape.solid_angle(p); },
                                    layout->projection);
            }
            whole += weight;
            const float* v = pixels.pixel(x, y);
            const double alpha = pixels.channels() > 3 ? static_cast<double>(v[3]) : 1;
            if (weight == 0 || alpha <= 0) continue;
            covered += weight * alpha;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * static_cast<double>(v[c]);
            const double light = luminance(v) / alpha;
            if (light > 0) result.lowest = std::min(result.lowest, light);
            result.highest = std::max(result.highest, light);
        }
    if (covered > 0)
        for (std::size_t c = 0; c < 3; ++c) result.mean[c] = sum[c] / covered;
    // Solid angles taken at pixels' centres add up to 4 pi only nearly.
    if (layout && whole > 0) result.covered_steradians = 4 * std::numbers::pi * covered / whole;
    return result;
}

bool empty_parts_are_empty(const Image& pixels, const Layout& layout) {
    std::size_t empty = 0, dark = 0;
    for (int y = 0; y < pixels.height(); y += std::max(1, pixels.height() / 256))
        for (int x = 0; x < pixels.width(); x += std::max(1, pixels.width() / 256)) {
            // Half a pixel and a bit away from what is filled.
            const V2d p((x + 0.5) / pixels.width(), (y + 0.5) / pixels.height());
            const double margin = 2.0 / pixels.width();
            bool outside = true;
            for (const auto& off : std::array{V2d(0, 0), V2d(margin, 0), V2d(-margin, 0),
                                              V2d(0, margin), V2d(0, -margin)})
                outside = outside &&
                          std::visit([&](const auto& s) { return s.solid_angle(p + off) == 0; },
                                     layout.projection);
            if (!outside) continue;
            ++empty;
            const float* v = pixels.pixel(x, y);
            dark += (pixels.channels() > 3 && v[3] == 0) ||
                    (v[0] < 1e-3F && v[1] < 1e-3F && v[2] < 1e-3F);
        }
    return empty > 0 && dark == empty;
}

}  // namespace chromeball
