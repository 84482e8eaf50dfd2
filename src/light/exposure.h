#pragma once

#include <optional>

#include "core/metadata.h"

namespace chromeball {

/// How much light a photo was given, as its file tells it; what it is silent about is absent.
struct ExposureTags {
    std::optional<double> time;      ///< seconds
    std::optional<double> aperture;  ///< the f-number N
    std::optional<double> iso;

    bool operator==(const ExposureTags&) const = default;
};

/// From metadata under OpenEXR's standard names (see pass_through): expTime, aperture, isoSpeed.
/// Numbers that are not above 0 count as silent.
ExposureTags exposure_tags(const Metadata& metadata);

/// How large a number the camera writes for one unit of light, up to a factor of the camera's own:
/// time x (ISO / 100) / N^2 (ISO 2720). An absent ISO counts as 100, an absent N as 1; nothing
/// without a time.
std::optional<double> exposure_of(const ExposureTags& tags);

}  // namespace chromeball
