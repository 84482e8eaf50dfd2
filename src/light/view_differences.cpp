#include "light/view_differences.h"

#include <cmath>

#include "core/statistics.h"

namespace chromeball {

ViewSamples sampled(const ViewPyramid& view, const std::vector<V3d>& world,
                    const Rotation& to_world, double angle) {
    ViewSamples samples(world.size());
    view.sample(world, to_world, angle, samples);
    return samples;
}

ViewSpread spread_of(const ViewSamples& a, const ViewSamples& b) {
    ViewSpread spread;
    std::array<std::vector<double>, 3> differences;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i].weight > 0 && b[i].weight > 0)
            for (std::size_t c = 0; c < 3; ++c)
                differences[c].push_back(static_cast<double>(a[i].value[c]) -
                                         static_cast<double>(b[i].value[c]));
    std::vector<double> sizes;
    for (std::size_t c = 0; c < 3; ++c) {
        spread.offset[c] = median(differences[c]);
        for (const double d : differences[c]) sizes.push_back(std::abs(d - spread.offset[c]));
    }
    spread.scale = 1.4826 * median(sizes);
    return spread;
}

}  // namespace chromeball
