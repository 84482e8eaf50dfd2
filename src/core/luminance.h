#pragma once

namespace chromeball {

/// One number for an RGB pixel's light, by ITU-R BT.709's weights: near enough to what eyes say,
/// whatever the working space's primaries, for telling bright from dark.
inline double luminance(const float* rgb) {
    return 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
           0.0722 * static_cast<double>(rgb[2]);
}

}  // namespace chromeball
