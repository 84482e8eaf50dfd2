// From an output pixel's position to a direction, and from that to a position in the source, for
// all lanes at once. Included once a target.
#if defined(CHROMEBALL_RESAMPLE_KERNEL_MAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CHROMEBALL_RESAMPLE_KERNEL_MAP_INL_H_
#undef CHROMEBALL_RESAMPLE_KERNEL_MAP_INL_H_
#else
#define CHROMEBALL_RESAMPLE_KERNEL_MAP_INL_H_
#endif

#include "resample/kernel.h"
#include "resample/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chromeball::kernel {
namespace HWY_NAMESPACE {

// How far a mapping can be trusted to be straight around a place.
constexpr float kStraight = 0, kCurved = 1, kNowhere = 2;

constexpr float kCos30 = 0.8660254F, kSin75 = 0.9659258F;

/// Directions, of any length, and how the target bends there (kStraight, kCurved, kNowhere).
struct Direction {
    V x, y, z, bend;
};

HWY_INLINE V turned(const float* row, V x, V y, V z) {
    return hn::MulAdd(set(row[0]), x, hn::MulAdd(set(row[1]), y, hn::Mul(set(row[2]), z)));
}

HWY_INLINE Direction turned(const TargetForm& form, V x, V y, V z, V bend) {
    const float* m = form.matrix.data();
    return {turned(m, x, y, z), turned(m + 3, x, y, z), turned(m + 6, x, y, z), bend};
}

HWY_INLINE V bend_where(hn::Mask<D> curved) { return hn::IfThenElseZero(curved, set(kCurved)); }

// One a target's shape: positions from the middle, in pixels -> directions. As the classes of
// these names in src/map.

struct FaceTarget {
    const TargetForm& form;
    V scale;
    explicit FaceTarget(const TargetForm& f) : form(f), scale(set(2 / f.width)) {}
    HWY_INLINE Direction operator()(V x, V y) const {
        return turned(form, hn::Mul(x, scale), hn::Mul(y, scale), set(1), hn::Zero(D()));
    }
};

struct LatLongTarget {
    const TargetForm& form;
    V around, up;
    explicit LatLongTarget(const TargetForm& f)
        : form(f), around(set(-2 / f.width)), up(set(-1 / f.height)) {}
    HWY_INLINE Direction operator()(V x, V y) const {
        const SinCos lon = sin_cos_pi(hn::Mul(x, around)), lat = sin_cos_pi(hn::Mul(y, up));
        return turned(form, hn::Mul(lat.cos, lon.sin), lat.sin, hn::Mul(lat.cos, lon.cos),
                      bend_where(hn::Gt(hn::Abs(lat.sin), set(kSin75))));
    }
};

struct AngularTarget {
    const TargetForm& form;
    V scale;
    explicit AngularTarget(const TargetForm& f) : form(f), scale(set(2 / f.width)) {}
    HWY_INLINE Direction operator()(V px, V py) const {
        const V x = hn::Mul(px, scale), y = hn::Neg(hn::Mul(py, scale));
        const V r = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
        const V safe = hn::Max(r, set(1e-12F));
        const SinCos theta = sin_cos_pi(hn::Min(safe, set(1)));
        const V ratio = hn::Div(theta.sin, safe);
        const V bend = hn::IfThenElse(hn::Gt(r, set(1)), set(kNowhere),
                                      bend_where(hn::Lt(theta.cos, set(-kCos30))));
        return turned(form, hn::Mul(ratio, x), hn::Mul(ratio, y), hn::Neg(theta.cos), bend);
    }
};

struct BallTarget {
    const TargetForm& form;
    V scale;
    explicit BallTarget(const TargetForm& f) : form(f), scale(set(2 / f.width)) {}
    HWY_INLINE Direction operator()(V px, V py) const {
        const V s = hn::Mul(px, scale), t = hn::Neg(hn::Mul(py, scale));
        const V square = hn::MulAdd(s, s, hn::Mul(t, t));
        const V twice_n =
            hn::Mul(set(2), hn::Sqrt(hn::Max(hn::Sub(set(1), square), hn::Zero(D()))));
        const V z = hn::NegMulAdd(set(2), square, set(1));
        const V bend = hn::IfThenElse(hn::Gt(square, set(1)), set(kNowhere),
                                      bend_where(hn::Lt(z, set(-kCos30))));
        return turned(form, hn::Mul(twice_n, s), hn::Mul(twice_n, t), z, bend);
    }
};

/// Positions in the source's pixels, of a cube in those of a face, and how the source bends there.
struct Place {
    V x, y, face, bend;
};

// One a source's shape: directions -> places.

struct LatLongSource {
    static constexpr bool kFaces = false;
    const SourceForm& form;
    explicit LatLongSource(const SourceForm& f) : form(f) {}
    HWY_INLINE Place operator()(V x, V y, V z) const {
        const V across = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(z, z)));
        const V lon = atan2_over_pi(x, z), lat = atan2_over_pi(y, across);
        const V length2 = hn::MulAdd(across, across, hn::Mul(y, y));
        const auto curved = hn::Gt(hn::Mul(y, y), hn::Mul(set(kSin75 * kSin75), length2));
        return {hn::NegMulAdd(lon, set(0.5F * form.x_scale), set(form.x0 + 0.5F * form.x_scale)),
                hn::NegMulAdd(lat, set(form.y_scale), set(form.y0 + 0.5F * form.y_scale)),
                hn::Zero(D()), bend_where(curved)};
    }
};

/// As Cube in the layout `openexr`; ties between axes go to X, then Y.
struct CubeSource {
    static constexpr bool kFaces = true;
    const SourceForm& form;
    explicit CubeSource(const SourceForm& f) : form(f) {}
    HWY_INLINE Place operator()(V x, V y, V z) const {
        const V ax = hn::Abs(x), ay = hn::Abs(y), az = hn::Abs(z);
        const auto is_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az));
        const auto is_y = hn::AndNot(is_x, hn::Ge(ay, az));
        const V major = hn::IfThenElse(is_x, x, hn::IfThenElse(is_y, y, z));
        const V first = hn::IfThenElse(is_x, set(0), hn::IfThenElse(is_y, set(2), set(4)));
        const V face = hn::Add(first, hn::IfThenElseZero(hn::Lt(major, hn::Zero(D())), set(1)));
        return on_face(x, y, z, face);
    }
    /// On a face's plane, whichever face really shows the direction.
    HWY_INLINE Place on_face(V x, V y, V z, V face) const {
        const auto is_x = hn::Lt(face, set(1.5F)), is_z = hn::Gt(face, set(3.5F));
        const V odd = hn::NegMulAdd(set(2), hn::Floor(hn::Mul(face, set(0.5F))), face);
        const V sign = hn::NegMulAdd(set(2), odd, set(1));
        const V depth = hn::Mul(sign, hn::IfThenElse(is_x, x, hn::IfThenElse(is_z, z, y)));
        const V right = hn::IfThenElse(is_x, hn::Mul(sign, z),
                                       hn::IfThenElse(is_z, hn::Neg(hn::Mul(sign, x)), x));
        const V down = hn::Neg(hn::IfThenElse(hn::Or(is_x, is_z), y, hn::Mul(sign, z)));
        const V half_x = hn::Div(set(0.5F * form.x_scale), depth);
        return {hn::MulAdd(right, half_x, set(form.x0 + 0.5F * form.x_scale)),
                hn::MulAdd(down, half_x, set(form.y0 + 0.5F * form.y_scale)), face, hn::Zero(D())};
    }
};

struct AngularSource {
    static constexpr bool kFaces = false;
    const SourceForm& form;
    explicit AngularSource(const SourceForm& f) : form(f) {}
    HWY_INLINE Place operator()(V x, V y, V z) const {
        const V square = hn::MulAdd(x, x, hn::Mul(y, y));
        const V across = hn::Sqrt(square);
        const V r = atan2_over_pi(across, hn::Neg(z));
        const V ratio = hn::Div(r, hn::Max(across, set(1e-30F)));
        const V length = hn::Sqrt(hn::MulAdd(z, z, square));
        // +Z exactly, which is the whole edge, is put at its right end, as Angular does.
        const V u = hn::IfThenElse(hn::Gt(across, hn::Zero(D())), hn::Mul(ratio, x), r);
        return {hn::MulAdd(u, set(0.5F * form.x_scale), set(form.x0 + 0.5F * form.x_scale)),
                hn::NegMulAdd(hn::Mul(ratio, y), set(0.5F * form.y_scale),
                              set(form.y0 + 0.5F * form.y_scale)),
                hn::Zero(D()), bend_where(hn::Gt(z, hn::Mul(set(kCos30), length)))};
    }
};

/// z points towards the camera. Bends of a lens apart, see SourceForm.
template <bool kNear, bool kLens>
struct BallSource {
    static constexpr bool kFaces = false;
    const SourceForm& form;
    explicit BallSource(const SourceForm& f) : form(f) {}
    HWY_INLINE Place operator()(V x, V y, V z) const {
        const V zero = hn::Zero(D()), one = set(1);
        const V across2 = hn::MulAdd(x, x, hn::Mul(y, y));
        const V length = hn::Sqrt(hn::MulAdd(z, z, across2));
        // length + z loses its digits towards the back; there it is across2 / (length - z).
        const V far = hn::Add(length, hn::Abs(z));
        const V sum = hn::IfThenElse(hn::Lt(z, zero), hn::Div(across2, far), far);
        const V scale =
            hn::Div(one, hn::Sqrt(hn::Max(hn::Mul(hn::Add(length, length), sum), set(1e-36F))));
        const V v = hn::Mul(sum, scale);
        V a = hn::Mul(x, scale), b = hn::Mul(y, scale);
        auto nowhere = hn::Le(v, set(form.hidden_v));
        if constexpr (kNear) {
            const V w = hn::Mul(hn::Sub(hn::Max(v, set(form.hidden_v)), set(form.g_middle)),
                                set(form.g_scale));
            V g = set(form.g[0]);
            for (int i = 1; i < form.g_terms; ++i)
                g = hn::MulAdd(g, w, set(form.g[static_cast<std::size_t>(i)]));
            a = hn::Mul(a, g);
            b = hn::Mul(b, g);
            const V depth = hn::MulAdd(a, set(form.k_a), hn::MulAdd(b, set(form.k_b), one));
            nowhere = hn::Or(nowhere, hn::Le(depth, zero));
            const V shrink = hn::Div(one, hn::Max(depth, set(1e-6F)));
            a = hn::Mul(a, shrink);
            b = hn::Mul(b, shrink);
        }
        V px = transformed(form.to_pixels.data(), a, b);
        V py = transformed(form.to_pixels.data() + 2, a, b);
        if constexpr (kLens) bend(px, py);
        const V bend =
            hn::IfThenElse(nowhere, set(kNowhere), bend_where(hn::Lt(v, set(form.curved_v))));
        return {hn::Add(px, set(form.base_x)), hn::Add(py, set(form.base_y)), zero, bend};
    }

private:
    static HWY_INLINE V transformed(const float* row, V a, V b) {
        return hn::MulAdd(a, set(row[0]), hn::Mul(b, set(row[1])));
    }
    /// Offsets on the pinhole's plane -> offsets in pixels. With r^2 = |p|^2, q^2 = |p0|^2 and
    /// e = r^2 - q^2, computed as 2 p0.(p - p0) + |p - p0|^2, the lens' factor differs from that at
    /// p0 by e (k1 + k2 (2 q^2 + e) + k3 (3 q^4 + 3 q^2 e + e^2)): nothing cancels.
    HWY_INLINE void bend(V& x, V& y) const {
        const float q = form.lens_x * form.lens_x + form.lens_y * form.lens_y;
        const V e = hn::MulAdd(hn::MulAdd(set(2 * form.lens_x), set(1), x), x,
                               hn::Mul(hn::Add(set(2 * form.lens_y), y), y));
        const V cubic = hn::MulAdd(hn::Add(e, set(3 * q)), e, set(3 * q * q));
        const V more =
            hn::Mul(e, hn::MulAdd(set(form.k3), cubic,
                                  hn::MulAdd(set(form.k2), hn::Add(e, set(2 * q)), set(form.k1))));
        const float at_base = 1 + q * (form.k1 + q * (form.k2 + q * form.k3));
        const V factor = hn::Add(more, set(at_base));
        const V dx = hn::MulAdd(x, factor, hn::Mul(set(form.lens_x), more));
        const V dy = hn::MulAdd(y, factor, hn::Mul(set(form.lens_y), more));
        x = transformed(form.lens_to_pixels.data(), dx, dy);
        y = transformed(form.lens_to_pixels.data() + 2, dx, dy);
    }
};

/// Calls work with the target's function.
template <class Work>
HWY_INLINE void with_target(const TargetForm& form, const Work& work) {
    switch (form.shape) {
        case TargetForm::Shape::latlong:
            return work(LatLongTarget(form));
        case TargetForm::Shape::face:
            return work(FaceTarget(form));
        case TargetForm::Shape::angular:
            return work(AngularTarget(form));
        case TargetForm::Shape::ball:
            return work(BallTarget(form));
    }
}

/// Calls work with the source's function.
template <class Work>
HWY_INLINE void with_source(const SourceForm& form, const Work& work) {
    switch (form.shape) {
        case SourceForm::Shape::latlong:
            return work(LatLongSource(form));
        case SourceForm::Shape::cube:
            return work(CubeSource(form));
        case SourceForm::Shape::angular:
            return work(AngularSource(form));
        case SourceForm::Shape::ball:
            break;
    }
    if (form.lens) return work(BallSource<true, true>(form));
    if (form.g_terms > 0) return work(BallSource<true, false>(form));
    work(BallSource<false, false>(form));
}

}  // namespace HWY_NAMESPACE
}  // namespace chromeball::kernel
HWY_AFTER_NAMESPACE();

#endif  // include guard, one a target
