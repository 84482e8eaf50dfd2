#include "light/exposure.h"

#include <algorithm>
#include <cmath>

namespace chromeball {
namespace {

std::optional<double> positive(const Metadata& metadata, std::string_view name) {
    const auto value = metadata.number(name);
    return value && std::isfinite(*value) && *value > 0 ? value : std::nullopt;
}

}  // namespace

ExposureTags exposure_tags(const Metadata& metadata) {
    return {positive(metadata, "expTime"), positive(metadata, "aperture"),
            positive(metadata, "isoSpeed")};
}

std::optional<double> exposure_of(const ExposureTags& tags) {
    if (!tags.time) return std::nullopt;
    const double n = tags.aperture.value_or(1);
    return *tags.time * tags.iso.value_or(100) / 100 / (n * n);
}

double ev100_of(double exposure) { return -std::log2(exposure); }
double exposure_of_ev100(double ev100) { return std::exp2(-ev100); }

double noise_variance(const ExposedPhoto& photo, double light, double slope) {
    constexpr double kShot = 1.0 / 60000;  // of white, at ISO 100
    constexpr double kRead = 0.125;        // as if there were that much more light
    const double rounding = slope * photo.step;
    return kShot * photo.iso / 100 * (std::max(light, 0.0) + kRead) + rounding * rounding;
}

}  // namespace chromeball
