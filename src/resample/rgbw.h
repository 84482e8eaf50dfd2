#pragma once

namespace chromeball {

/// Red, green, blue, and a weight that colour is multiplied by.
struct Rgbw {
    float r = 0, g = 0, b = 0, w = 0;

    void add(float weight, const float* pixel) {
        r += weight * pixel[0];
        g += weight * pixel[1];
        b += weight * pixel[2];
        w += weight * pixel[3];
    }
};

}  // namespace chromeball
