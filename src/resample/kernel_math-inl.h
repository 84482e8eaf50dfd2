// Elementary functions for the kernels, for all lanes at once. Included once a target.
#if defined(CHROMEBALL_RESAMPLE_KERNEL_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHROMEBALL_RESAMPLE_KERNEL_MATH_INL_H_
#undef CHROMEBALL_RESAMPLE_KERNEL_MATH_INL_H_
#else
#define CHROMEBALL_RESAMPLE_KERNEL_MATH_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace chromeball::kernel {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using DI = hn::RebindToSigned<D>;
using VI = hn::Vec<DI>;

HWY_INLINE V set(float value) { return hn::Set(D(), value); }

struct SinCos {
    V sin, cos;
};

/// Sine and cosine of pi x, |x| up to a few: the reduction to |x| <= 1/4 is exact, then Taylor's
/// series to where they are good to half a float's last digit.
HWY_INLINE SinCos sin_cos_pi(V x) {
    const D d;
    const DI di;
    const V quarters = hn::Round(hn::Add(x, x));
    const V r = hn::Mul(hn::NegMulAdd(set(0.5F), quarters, x), set(3.14159265F));
    const V z = hn::Mul(r, r);
    V s = set(2.7557319e-6F);
    s = hn::MulAdd(s, z, set(-1.9841270e-4F));
    s = hn::MulAdd(s, z, set(8.3333333e-3F));
    s = hn::MulAdd(s, z, set(-1.6666667e-1F));
    s = hn::MulAdd(hn::Mul(s, z), r, r);
    V c = set(2.4801587e-5F);
    c = hn::MulAdd(c, z, set(-1.3888889e-3F));
    c = hn::MulAdd(c, z, set(4.1666667e-2F));
    c = hn::MulAdd(c, z, set(-0.5F));
    c = hn::MulAdd(c, z, set(1));
    const VI q = hn::ConvertTo(di, quarters);
    const auto odd = hn::RebindMask(d, hn::TestBit(q, hn::Set(di, 1)));
    const V sine = hn::IfThenElse(odd, c, s), cosine = hn::IfThenElse(odd, s, c);
    // Bit 1 of q, and of q + 1, moved to the sign's place.
    const VI sine_sign = hn::ShiftLeft<30>(hn::And(q, hn::Set(di, 2)));
    const VI cosine_sign = hn::ShiftLeft<30>(hn::And(hn::Add(q, hn::Set(di, 1)), hn::Set(di, 2)));
    return {hn::Xor(sine, hn::BitCast(d, sine_sign)), hn::Xor(cosine, hn::BitCast(d, cosine_sign))};
}

/// The angle of (x, y) over pi, in [-1, 1]; 0 at the origin. Good to 1e-7.
/// The polynomial is that of Cephes' atanf (S. Moshier), good for |t| <= tan(pi / 8).
HWY_INLINE V atan2_over_pi(V y, V x) {
    const V ax = hn::Abs(x), ay = hn::Abs(y);
    const V low = hn::Min(ax, ay), high = hn::Max(hn::Max(ax, ay), set(1e-37F));
    const auto steep = hn::Gt(low, hn::Mul(high, set(0.41421356F)));
    const V t = hn::Div(hn::IfThenElse(steep, hn::Sub(low, high), low),
                        hn::IfThenElse(steep, hn::Add(low, high), high));
    const V z = hn::Mul(t, t);
    V p = set(8.05374449538e-2F);
    p = hn::MulAdd(p, z, set(-1.38776856032e-1F));
    p = hn::MulAdd(p, z, set(1.99777106478e-1F));
    p = hn::MulAdd(p, z, set(-3.33329491539e-1F));
    p = hn::MulAdd(hn::Mul(p, z), t, t);
    V angle = hn::MulAdd(p, set(0.318309886F), hn::IfThenElseZero(steep, set(0.25F)));
    angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(set(0.5F), angle), angle);
    angle = hn::IfThenElse(hn::Lt(x, hn::Zero(D())), hn::Sub(set(1), angle), angle);
    return hn::CopySignToAbs(angle, y);
}

}  // namespace HWY_NAMESPACE
}  // namespace chromeball::kernel
HWY_AFTER_NAMESPACE();

#endif  // include guard, one a target
