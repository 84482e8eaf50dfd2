// The light in a row of pixels, once for every kind of processor.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "resample/row_light.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "resample/row_light.h"

HWY_BEFORE_NAMESPACE();
namespace chromeball {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A whole pixel at least; of wider vectors several, whose channels are told apart at the end.
#if HWY_TARGET == HWY_SCALAR
constexpr std::size_t kLanes = 1;
using D = hn::ScalableTag<float>;
#else
constexpr std::size_t kLanes = HWY_MAX_BYTES / sizeof(float);
using D = hn::FixedTag<float, kLanes>;
#endif
using V = hn::Vec<D>;
/// Vectors side by side, a multiple of a pixel: one after the other they would wait for each sum.
constexpr std::size_t kSideBySide = 4;

HWY_INLINE V light(V value) {
    const D d;
    const auto counts = hn::And(hn::Gt(value, hn::Zero(d)),
                                hn::Le(value, hn::Set(d, std::numeric_limits<float>::max())));
    return hn::IfThenElseZero(counts, value);
}

RowLight light_of_row(const float* pixels, std::size_t count) {
    const D d;
    constexpr std::size_t kStep = kSideBySide * kLanes;
    V sum[kSideBySide], highest[kSideBySide];
    for (std::size_t k = 0; k < kSideBySide; ++k) sum[k] = highest[k] = hn::Zero(d);
    std::size_t i = 0;
    for (; i + kStep <= 4 * count; i += kStep)
        for (std::size_t k = 0; k < kSideBySide; ++k) {
            const V value = light(hn::LoadU(d, pixels + i + k * kLanes));
            sum[k] = hn::Add(sum[k], value);
            highest[k] = hn::Max(highest[k], value);
        }
    float sums[kStep], most[kStep];
    for (std::size_t k = 0; k < kSideBySide; ++k) {
        hn::StoreU(sum[k], d, sums + k * kLanes);
        hn::StoreU(highest[k], d, most + k * kLanes);
    }
    RowLight row;
    const auto take = [&](std::size_t channel, float more, float peak) {
        if (channel > 2) return;
        row.sum[channel] += more;
        row.highest[channel] = std::max(row.highest[channel], peak);
    };
    for (std::size_t k = 0; k < kStep; ++k) take(k % 4, sums[k], most[k]);
    for (; i < 4 * count; ++i) {
        const float value = pixels[i];
        if (value > 0 && value <= std::numeric_limits<float>::max()) take(i % 4, value, value);
    }
    return row;
}

}  // namespace HWY_NAMESPACE
}  // namespace chromeball
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chromeball {

HWY_EXPORT(light_of_row);

RowLight row_light(const float* pixels, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(light_of_row)(pixels, count);
}

}  // namespace chromeball
#endif
