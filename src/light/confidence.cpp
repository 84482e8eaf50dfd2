#include "light/confidence.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "resample/tap.h"

namespace chromeball {
namespace {

/// Pixels per radian across the direction in which the mapping turns fastest: its Jacobian's
/// smaller singular value.
double least_scale(const Vec2<Dual>& at) {
    const double a = at.x.du, b = at.x.dv, c = at.y.du, d = at.y.dv;
    const double sum = a * a + b * b + c * c + d * d, det = a * d - b * c;
    const double root = std::sqrt(std::max(0.0, sum * sum - 4 * det * det));
    // The difference of nearly equal numbers loses its digits; the product of both values does not.
    const double larger = std::sqrt(0.5 * (sum + root));
    return larger > 0 ? std::abs(det) / larger : 0;
}

template <class P>
class Believed {
public:
    Believed(const View& view, double finest) : view_(view), lookup_(view.source), finest_(finest) {
        if (view.trust) trust_.emplace(*view.trust);
        if (view.source.ball) rows_ = EllipseRows(*view.source.ball);
    }

    float operator()(V3d d) const {
        // Off the pole of the mapping by a hair: there it has no Jacobian.
        const V3d side = std::abs(d.x) < 0.6 ? V3d(1, 0, 0) : V3d(0, 1, 0);
        const V3d e1 = d.cross(side).normalized(), e2 = d.cross(e1);
        constexpr double kOff = 1e-6;
        const auto part = [&](double base, double by_u, double by_v) {
            return Dual(base + kOff * by_u, by_u, by_v);
        };
        const auto at = lookup_.locate(
            Vec3<Dual>(part(d.x, e1.x, e2.x), part(d.y, e1.y, e2.y), part(d.z, e1.z, e2.z)));
        if (!at) return 0;
        const V2d place = value_of(*at);
        const auto tap = lookup_.tap(place);
        double shown = tap ? std::clamp(static_cast<double>(tap->w), 0.0, 1.0) : 0;
        // The outermost rim has no pixel that is purely ball, and is shown all the same.
        const Source& source = view_.source;
        if (!tap && source.ball && place.x >= source.left && place.x <= source.right &&
            place.y >= source.top && place.y <= source.bottom)
            shown = 1;
        if (!(shown > 0)) return 0;
        double value = std::min(1.0, finest_ * least_scale(*at)) * shown;
        if (view_.source.ball) {
            constexpr double kSafe = 2;  // pixels
            const double depth = rows_.at(place.x, place.y).depth();
            // The last of it still is better than nothing.
            constexpr double kLeast = 0.02;
            value *= std::clamp(depth / (view_.source.rim.first_depth() + kSafe), kLeast, 1.0);
        }
        if (trust_) {
            if (const auto trusted = trust_->tap(place))
                value *= std::clamp(static_cast<double>(trusted->r), 0.0, 1.0);
        }
        return static_cast<float>(value);
    }

private:
    const View& view_;
    Lookup<P> lookup_;
    std::optional<Lookup<P>> trust_;
    EllipseRows rows_;
    double finest_;
};

}  // namespace

void confidence(const View& view, double finest, std::span<const V3d> directions,
                std::span<float> out) {
    std::visit(
        [&]<class P>(const P&) {
            const Believed<P> believed(view, finest);
            for_each_band(static_cast<int>(directions.size()), 1024, [&](int first, int last) {
                for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last);
                     ++i)
                    out[i] = believed(directions[i]);
            });
        },
        view.source.projection);
}

Image trust_of(const Image& pixels, float white) {
    Image trust(pixels.size(), 3);
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x) {
            const float* p = pixels.pixel(x, y);
            const bool clipped = std::max({p[0], p[1], p[2]}) >= white;
            std::fill_n(trust.pixel(x, y), 3, clipped ? kClipped : 1.0F);
        }
    return trust;
}

bool any_doubt(const Image& trust) {
    for (int y = 0; y < trust.height(); ++y)
        for (int x = 0; x < trust.width(); ++x)
            if (trust.pixel(x, y)[0] < 1) return true;
    return false;
}

}  // namespace chromeball
