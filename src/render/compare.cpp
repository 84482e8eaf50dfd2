#include "render/compare.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace chromeball {

Comparison compared(const Image& first, const Image& second) {
    assert(first.size() == second.size() && first.channels() == 4 && second.channels() == 4);
    const int width = first.width();
    Comparison result;
    result.picture = Image({3 * width, first.height()}, 4);
    double square = 0, sum = 0;
    std::size_t count = 0;
    const auto compressed = [](float x) {
        const auto v = static_cast<double>(std::max(0.0F, x));
        return v / (1 + v);
    };
    for (int y = 0; y < first.height(); ++y) {
        std::copy_n(first.row(y), 4 * width, result.picture.row(y));
        std::copy_n(second.row(y), 4 * width, result.picture.pixel(width, y));
        for (int x = 0; x < width; ++x) {
            const float *a = first.pixel(x, y), *b = second.pixel(x, y);
            float* out = result.picture.pixel(2 * width + x, y);
            out[3] = 1;
            const bool covered = a[3] > 0 || b[3] > 0;
            for (int c = 0; c < 3; ++c) {
                out[c] = std::abs(a[c] - b[c]);
                const double off = compressed(a[c]) - compressed(b[c]);
                if (!covered) continue;
                square += off * off;
                sum += std::abs(off);
                ++count;
            }
        }
    }
    const auto n = static_cast<double>(std::max<std::size_t>(count, 1));
    result.difference = sum / n;
    result.psnr =
        square > 0 ? -10 * std::log10(square / n) : std::numeric_limits<double>::infinity();
    return result;
}

}  // namespace chromeball
