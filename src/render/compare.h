#pragma once

#include "core/image.h"

namespace chromeball {

/// Two pictures of one thing.
struct Comparison {
    Image picture;          ///< the first, the second, and their absolute difference, side by side
    double psnr = 0;        ///< dB, of x / (1 + x) where either is covered; infinite for equal ones
    double difference = 0;  ///< mean absolute difference there, of x / (1 + x)
};

/// Both RGBA and of one size.
Comparison compared(const Image& first, const Image& second);

}  // namespace chromeball
