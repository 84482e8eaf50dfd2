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

double clip_level(std::span<const ExposedPhoto> photos, bool integers) {
    const auto each = [&](auto f) {
        for (const ExposedPhoto& photo : photos) {
            Image row({photo.size.width, 1}, 3);
            for (int y = 0; y < photo.size.height; ++y) {
                photo.read(y, y + 1, row.view());
                for (int i = 0; i < photo.size.width * 3; ++i)
                    if (std::isfinite(row.row(0)[i])) f(row.row(0)[i]);
            }
        }
    };
    float most = 0;
    each([&](float z) { most = std::max(most, z); });
    if (integers && most > 0.97f) return 1;
    std::size_t at_top = 0, below = 0;
    each([&](float z) {
        at_top += z > 0.995f * most;
        below += z > 0.97f * most && z <= 0.985f * most;
    });
    constexpr std::size_t kFew = 24;  // a spot of light has a brightest pixel without clipping
    if (at_top > kFew && at_top > 3 * below) return static_cast<double>(most);
    return integers ? 1 : std::numeric_limits<double>::infinity();
}

double noise_variance(const ExposedPhoto& photo, double light, double slope) {
    constexpr double kShot = 1.0 / 60000;  // of white, at ISO 100
    constexpr double kRead = 0.125;        // as if there were that much more light
    const double rounding = slope * photo.step;
    return kShot * photo.iso / 100 * (std::max(light, 0.0) + kRead) + rounding * rounding;
}

}  // namespace chromeball
