#include "resample/residual.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "core/luminance.h"

namespace chromeball {
namespace {

bool compared(const Image& photo, const Image& painted, int x, int y) {
    return painted.pixel(x, y)[3] > 0.999F &&
           (photo.channels() < 4 || photo.pixel(x, y)[3] > 0.999F);
}

double mean_luminance(const Image& photo, const Image& painted) {
    double sum = 0;
    std::size_t count = 0;
    for (int y = 0; y < photo.height(); ++y)
        for (int x = 0; x < photo.width(); ++x)
            if (compared(photo, painted, x, y)) {
                sum += std::max(0.0, luminance(photo.pixel(x, y)));
                ++count;
            }
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

double quantile(std::vector<double>& values, double q) {
    if (values.empty()) return 0;
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

Residual residual_of(const Image& photo, const Image& painted) {
    assert(photo.size() == painted.size());
    Residual residual;
    residual.picture = Image(photo.size(), 3);
    const double floor = std::max(0.01 * mean_luminance(photo, painted), 1e-12);
    std::vector<double> stops;
    for (int y = 0; y < photo.height(); ++y)
        for (int x = 0; x < photo.width(); ++x) {
            if (!compared(photo, painted, x, y)) continue;
            const double off = std::log2(std::max(luminance(painted.pixel(x, y)), floor) /
                                         std::max(luminance(photo.pixel(x, y)), floor));
            stops.push_back(std::abs(off));
            const auto more = static_cast<float>(std::clamp(off, -1.0, 1.0));
            float* colour = residual.picture.pixel(x, y);
            colour[0] = 0.5F + 0.5F * more;
            colour[1] = 0.5F - 0.5F * std::abs(more);
            colour[2] = 0.5F - 0.5F * more;
        }
    residual.pixels = stops.size();
    residual.median_stops = quantile(stops, 0.5);
    residual.p95_stops = quantile(stops, 0.95);
    return residual;
}

}  // namespace chromeball
