#include "light/exposure.h"

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

}  // namespace chromeball
