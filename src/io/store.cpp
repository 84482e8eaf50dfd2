#include "io/store.h"

#include <Imath/half.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "core/parallel.h"
#include "io/encoders.h"
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace chromeball::io {
namespace {

template <class T, class Convert>
void convert(std::span<const float> values, std::byte* out, Convert to) {
    for (const float value : values) {
        const T stored = to(value);
        std::memcpy(out, &stored, sizeof stored);
        out += sizeof stored;
    }
}

void store_half(std::span<const float> values, std::byte* out) {
    convert<std::uint16_t>(values, out, [](float v) { return Imath::half(v).bits(); });
}

#if defined(__x86_64__)
/// The processor's own conversion, where it has one; the library uses it only where all code may.
__attribute__((target("avx,f16c"))) void store_half_f16c(std::span<const float> values,
                                                         std::byte* out) {
    std::size_t i = 0;
    for (; i + 8 <= values.size(); i += 8, out += 16)
        _mm_storeu_si128(
            reinterpret_cast<__m128i*>(out),
            _mm256_cvtps_ph(_mm256_loadu_ps(values.data() + i), _MM_FROUND_TO_NEAREST_INT));
    store_half(values.subspan(i), out);
}
#endif

}  // namespace

void store(std::span<const float> values, PixelType type, std::byte* out) {
    switch (type) {
        case PixelType::u8:
            return convert<std::uint8_t>(
                values, out, [](float v) { return static_cast<std::uint8_t>(v * 255.0f + 0.5f); });
        case PixelType::u16:
            return convert<std::uint16_t>(values, out, [](float v) {
                return static_cast<std::uint16_t>(v * 65535.0f + 0.5f);
            });
        case PixelType::f16:
#if defined(__x86_64__)
            if (__builtin_cpu_supports("avx") && __builtin_cpu_supports("f16c"))
                return store_half_f16c(values, out);
#endif
            return store_half(values, out);
        case PixelType::f32:
            std::memcpy(out, values.data(), values.size_bytes());
            return;
    }
}

void store_rows(const Values& values, int first, int last, std::byte* out, WriteReport& report) {
    constexpr int kBand = 16;
    const int count = last - first;
    std::vector<WriteReport> reports(static_cast<std::size_t>((count + kBand - 1) / kBand));
    for_each_band(count, kBand, [&](int from, int to) {
        reports[static_cast<std::size_t>(from / kBand)] = values.store(
            first + from, first + to, out + static_cast<std::size_t>(from) * values.row_bytes());
    });
    for (const WriteReport& one : reports) add(report, one);
}

}  // namespace chromeball::io
