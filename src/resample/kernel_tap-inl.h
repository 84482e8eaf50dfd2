// Weighted pixels. Included once a target.
#if defined(CHROMEBALL_RESAMPLE_KERNEL_TAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHROMEBALL_RESAMPLE_KERNEL_TAP_INL_H_
#undef CHROMEBALL_RESAMPLE_KERNEL_TAP_INL_H_
#else
#define CHROMEBALL_RESAMPLE_KERNEL_TAP_INL_H_
#endif

#include <algorithm>
#include <cstddef>

#include "resample/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chromeball::kernel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

/// One RGBA pixel.
struct Pixel {
    float v[4];
};
HWY_INLINE Pixel load_pixel(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
HWY_INLINE void store_pixel(const Pixel& pixel, float* to) { std::copy_n(pixel.v, 4, to); }
HWY_INLINE void stream_pixel(const Pixel& pixel, float* to) { store_pixel(pixel, to); }
HWY_INLINE float alpha_of(const Pixel& pixel) { return pixel.v[3]; }
HWY_INLINE Pixel gray(float x) { return {{x, x, x, x}}; }
template <class F>
HWY_INLINE Pixel combined(const Pixel& a, const Pixel& b, const F& f) {
    return {{f(a.v[0], b.v[0]), f(a.v[1], b.v[1]), f(a.v[2], b.v[2]), f(a.v[3], b.v[3])}};
}
HWY_INLINE Pixel add(const Pixel& a, const Pixel& b) {
    return combined(a, b, [](float x, float y) { return x + y; });
}
HWY_INLINE Pixel multiply(const Pixel& a, const Pixel& b) {
    return combined(a, b, [](float x, float y) { return x * y; });
}
HWY_INLINE Pixel divide(const Pixel& a, const Pixel& b) {
    return combined(a, b, [](float x, float y) { return x / y; });
}
HWY_INLINE Pixel subtract(const Pixel& a, const Pixel& b) {
    return combined(a, b, [](float x, float y) { return x - y; });
}
HWY_INLINE Pixel lower(const Pixel& a, const Pixel& b) {
    return combined(a, b, [](float x, float y) { return std::min(x, y); });
}
HWY_INLINE Pixel higher(const Pixel& a, const Pixel& b) {
    return combined(a, b, [](float x, float y) { return std::max(x, y); });
}
HWY_INLINE Pixel multiply_add(const Pixel& a, const Pixel& b, const Pixel& c) {
    return add(multiply(a, b), c);
}

#else

using D4 = hn::FixedTag<float, 4>;
/// One RGBA pixel.
using Pixel = hn::Vec<D4>;
HWY_INLINE Pixel load_pixel(const float* p) { return hn::LoadU(D4(), p); }
HWY_INLINE void store_pixel(Pixel pixel, float* to) { hn::StoreU(pixel, D4(), to); }
/// Past the caches; to: on a multiple of 16 bytes.
HWY_INLINE void stream_pixel(Pixel pixel, float* to) { hn::Stream(pixel, D4(), to); }
HWY_INLINE float alpha_of(Pixel pixel) { return hn::ExtractLane(pixel, 3); }
HWY_INLINE Pixel gray(float x) { return hn::Set(D4(), x); }
HWY_INLINE Pixel divide(Pixel a, Pixel b) { return hn::Div(a, b); }
// One pixel, or several side by side.
template <class P>
HWY_INLINE P add(P a, P b) {
    return hn::Add(a, b);
}
template <class P>
HWY_INLINE P subtract(P a, P b) {
    return hn::Sub(a, b);
}
template <class P>
HWY_INLINE P multiply(P a, P b) {
    return hn::Mul(a, b);
}
template <class P>
HWY_INLINE P lower(P a, P b) {
    return hn::Min(a, b);
}
template <class P>
HWY_INLINE P higher(P a, P b) {
    return hn::Max(a, b);
}
template <class P>
HWY_INLINE P multiply_add(P a, P b, P c) {
    return hn::MulAdd(a, b, c);
}

#endif

#if HWY_MAX_BYTES >= 32

using D8 = hn::FixedTag<float, 8>;  // two neighbours
using V8 = hn::Vec<D8>;

HWY_INLINE V8 left_and_right(float left, float right) {
    return hn::Combine(D8(), gray(right), gray(left));
}

/// Sums up bilinear taps. Weights are never differences of pixels, so that light beside a sun does
/// not lose its digits, or its sign.
class TapSum {
public:
    HWY_INLINE TapSum()
        : sign_(left_and_right(-1, 1)), start_(left_and_right(1, 0)), sum_(hn::Zero(D8())) {}
    /// pixel: the upper left of the four; fx, fy: how far to the right and down, 0 to 1.
    HWY_INLINE void add(const float* pixel, std::ptrdiff_t row, float fx, float fy) {
        const D8 d;
        const V8 across = hn::MulAdd(hn::Set(d, fx), sign_, start_);
        const V8 below = hn::Set(d, fy);
        const V8 above = hn::Sub(hn::Set(d, 1), below);
        const V8 column =
            hn::MulAdd(hn::LoadU(d, pixel), above, hn::Mul(hn::LoadU(d, pixel + row), below));
        sum_ = hn::MulAdd(column, across, sum_);
    }
    HWY_INLINE Pixel total() const {
        return hn::Add(hn::LowerHalf(D4(), sum_), hn::UpperHalf(D4(), sum_));
    }

private:
    V8 sign_, start_, sum_;
};

#else

class TapSum {
public:
    HWY_INLINE TapSum() : sum_(gray(0)) {}
    HWY_INLINE void add(const float* pixel, std::ptrdiff_t row, float fx, float fy) {
        take(pixel, (1 - fx) * (1 - fy));
        take(pixel + 4, fx * (1 - fy));
        take(pixel + row, (1 - fx) * fy);
        take(pixel + row + 4, fx * fy);
    }
    HWY_INLINE Pixel total() const { return sum_; }

private:
    HWY_INLINE void take(const float* pixel, float weight) {
        sum_ = multiply_add(load_pixel(pixel), gray(weight), sum_);
    }
    Pixel sum_;
};

#endif

/// As cubic_slope of the scalar reference.
template <class P>
HWY_INLINE P cubic_slope(P before, P after, P half, P three, P zero) {
    const P low = multiply(three, lower(before, after));
    const P high = multiply(three, higher(before, after));
    const P mean = multiply(half, add(before, after));
    return higher(lower(mean, higher(low, zero)), lower(high, zero));
}

/// As monotone_cubic of the scalar reference.
template <class P>
HWY_INLINE P monotone_cubic(P p0, P p1, P p2, P p3, P t, P half, P three, P zero) {
    const P rise = subtract(p2, p1);
    const P m1 = cubic_slope(subtract(p1, p0), rise, half, three, zero);
    const P m2 = cubic_slope(rise, subtract(p3, p2), half, three, zero);
    const P bend = subtract(add(m1, m2), add(rise, rise));
    const P c2 = subtract(subtract(rise, m1), bend);
    const P value = multiply_add(t, multiply_add(t, multiply_add(t, bend, c2), m1), p1);
    // Rounding must not carry it out of the range either: light is not negative.
    return higher(lower(value, higher(p1, p2)), lower(p1, p2));
}

#if HWY_MAX_BYTES >= 32
HWY_INLINE V8 below_each_other(const float* pixel, std::ptrdiff_t row) {
    return hn::Combine(D8(), load_pixel(pixel + row), load_pixel(pixel));
}
#endif

/// The monotone cubic through 4 x 4 pixels; pixel: the upper left of the inner four.
HWY_INLINE Pixel cubic_tap(const float* pixel, std::ptrdiff_t row, float fx, float fy) {
    const float* top = pixel - row;
    const Pixel half = gray(0.5F), three = gray(3), zero = gray(0), down = gray(fy);
#if HWY_MAX_BYTES >= 32
    const D8 d;
    const V8 half2 = hn::Set(d, 0.5F), three2 = hn::Set(d, 3), zero2 = hn::Zero(d),
             across = hn::Set(d, fx);
    const V8 upper = monotone_cubic(below_each_other(top - 4, row), below_each_other(top, row),
                                    below_each_other(top + 4, row), below_each_other(top + 8, row),
                                    across, half2, three2, zero2);
    const float* third = pixel + row;
    const V8 under = monotone_cubic(below_each_other(third - 4, row), below_each_other(third, row),
                                    below_each_other(third + 4, row),
                                    below_each_other(third + 8, row), across, half2, three2, zero2);
    const D4 d4;
    return monotone_cubic(hn::LowerHalf(d4, upper), hn::UpperHalf(d4, upper),
                          hn::LowerHalf(d4, under), hn::UpperHalf(d4, under), down, half, three,
                          zero);
#else
    const Pixel across = gray(fx);
    const auto one_row = [&](const float* first) HWY_ATTR {
        return monotone_cubic(load_pixel(first - 4), load_pixel(first), load_pixel(first + 4),
                              load_pixel(first + 8), across, half, three, zero);
    };
    return monotone_cubic(one_row(top), one_row(pixel), one_row(pixel + row),
                          one_row(pixel + 2 * row), down, half, three, zero);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace chromeball::kernel
HWY_AFTER_NAMESPACE();

#endif  // include guard, one a target
