#include "resample/resample.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "resample/tap.h"

namespace chromeball {
namespace {

/// Rows handed to a thread at a time; a constant, so that nothing depends on the number of threads.
constexpr int kBandRows = 8;

/// What an output pixel's sub-samples add up to.
struct Sum {
    double r = 0, g = 0, b = 0, alpha = 0, total = 0;

    void add(double weight, const std::optional<Rgbw>& tap) {
        total += weight;
        if (!tap) return;
        r += weight * tap->r;
        g += weight * tap->g;
        b += weight * tap->b;
        alpha += weight * tap->w;
    }
    void store(float* pixel) const {
        if (!(total > 0)) return;
        pixel[0] = static_cast<float>(r / total);
        pixel[1] = static_cast<float>(g / total);
        pixel[2] = static_cast<float>(b / total);
        pixel[3] = static_cast<float>(std::min(alpha / total, 1.0));
    }
};

/// Sub-samples along one side of an output pixel whose footprint is that many source pixels long.
int sample_count(double footprint) {
    return static_cast<int>(std::clamp(std::ceil(1.5 * footprint), 2.0, 64.0));
}

/// One output picture: target T drawn from source P.
template <class T, class P>
class Pass {
public:
    Pass(const T& target, Size size, const Rotation& source_from_target, const Lookup<P>& lookup)
        : target_(target), size_(size), rotation_(source_from_target), lookup_(lookup) {}

    Sum fast(int x, int y) const {
        Sum sum;
        sum.add(1, exact_tap(position(x + 0.5, y + 0.5)));
        return sum;
    }

    Sum adaptive(int x, int y) const {
        const auto [at, steep] = footprint(x, y);
        if (!at) return exact_sum(x, y, 4, 4);  // a part of the pixel may be shown
        const V2d by_x(at->x.du, at->y.du), by_y(at->x.dv, at->y.dv);
        const int nx = sample_count(by_x.length()), ny = sample_count(by_y.length());
        const V2d centre = value_of(*at);
        const V2d reach(0.5 * (std::abs(by_x.x) + std::abs(by_y.x)),
                        0.5 * (std::abs(by_x.y) + std::abs(by_y.y)));
        if (steep || !lookup_.seamless(centre, reach)) return exact_sum(x, y, nx, ny);
        Sum sum;
        for (int j = 0; j < ny; ++j) {
            const V2d row = centre + by_y * ((j + 0.5) / ny - 0.5);
            for (int i = 0; i < nx; ++i)
                sum.add(1, lookup_.tap(row + by_x * ((i + 0.5) / nx - 0.5)));
        }
        return sum;
    }

private:
    struct Footprint {
        std::optional<Vec2<Dual>> at;  ///< source position, derivatives per output pixel
        bool steep = false;            ///< whether steps from there cannot be taken as straight
    };

    V2d position(double x, double y) const { return {x / size_.width, y / size_.height}; }

    Footprint footprint(int x, int y) const {
        // Off the middle by a little that no symmetry hits: a pole or the ball's axis has no
        // Jacobian.
        constexpr double kOff = 1e-4;
        const Vec2<Dual> p{Dual((x + 0.5 + kOff) / size_.width, 1.0 / size_.width, 0),
                           Dual((y + 0.5 + kOff) / size_.height, 0, 1.0 / size_.height)};
        const auto d = target_.to_direction(p);
        if (!d) return {};
        const Vec3<Dual> turned = rotation_ * *d;
        const bool steep =
            target_.curved(value_of(*d)) || lookup_.projection().curved(value_of(turned));
        auto at = lookup_.locate(turned);
        if (at) {  // back to the middle
            at->x.value -= kOff * (at->x.du + at->x.dv);
            at->y.value -= kOff * (at->y.du + at->y.dv);
        }
        return {at, steep};
    }

    std::optional<Rgbw> exact_tap(V2d p) const {
        const auto d = target_.to_direction(p);
        if (!d) return std::nullopt;
        const auto at = lookup_.locate(rotation_ * *d);
        return at ? lookup_.tap(*at) : std::nullopt;
    }

    Sum exact_sum(int x, int y, int nx, int ny) const {
        Sum sum;
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i)
                sum.add(1, exact_tap(position(x + (i + 0.5) / nx, y + (j + 0.5) / ny)));
        return sum;
    }

    const T& target_;
    Size size_;
    Rotation rotation_;
    const Lookup<P>& lookup_;
};

/// Calls draw(x, y) for all pixels and stores what it sums up.
template <class Draw>
void for_each_pixel(Image& out, const Watch& watch, const Draw& draw) {
    for_each_band(
        out.height(), kBandRows,
        [&](int first, int last) {
            for (int y = first; y < last; ++y)
                for (int x = 0; x < out.width(); ++x) draw(x, y).store(out.pixel(x, y));
        },
        watch);
}

/// A ball in a part of a photo, as a target: that part is the unit square.
class BallInRegion {
public:
    BallInRegion(const MirrorBall& ball, const Window& region) : ball_(ball), region_(region) {}

    template <class T>
    std::optional<Vec3<T>> to_direction(const Vec2<T>& p) const {
        return ball_.to_direction(Vec2<T>(p.x * T(region_.size.width) + T(region_.x),
                                          p.y * T(region_.size.height) + T(region_.y)));
    }
    bool curved(V3d d) const { return ball_.curved(d); }

private:
    const MirrorBall& ball_;
    Window region_;
};

// Catmull-Rom: keeps a crop about as sharp as the photo. Over- and undershoots are clamped by the
// caller to the range of the taps.
void cubic_weights(double t, double (&w)[4]) {
    w[0] = ((-0.5 * t + 1) * t - 0.5) * t;
    w[1] = (1.5 * t - 2.5) * t * t + 1;
    w[2] = ((-1.5 * t + 2) * t + 0.5) * t;
    w[3] = (0.5 * t - 0.5) * t * t;
}

/// A cubic lookup where all 16 pixels can be used; nothing elsewhere.
std::optional<Rgbw> cubic_tap(ImageView<const float> pixels, V2d p) {
    const int x0 = static_cast<int>(std::floor(p.x - 0.5)) - 1,
              y0 = static_cast<int>(std::floor(p.y - 0.5)) - 1;
    if (x0 < 0 || y0 < 0 || x0 + 4 > pixels.size.width || y0 + 4 > pixels.size.height)
        return std::nullopt;
    double wx[4], wy[4];
    cubic_weights(p.x - 0.5 - (x0 + 1), wx);
    cubic_weights(p.y - 0.5 - (y0 + 1), wy);
    double sum[3] = {};
    float low[3], high[3];
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            const float* pixel = pixels.pixel(x0 + i, y0 + j);
            if (pixel[3] < 1) return std::nullopt;
            for (int c = 0; c < 3; ++c) {
                sum[c] += wx[i] * wy[j] * pixel[c];
                low[c] = i + j == 0 ? pixel[c] : std::min(low[c], pixel[c]);
                high[c] = i + j == 0 ? pixel[c] : std::max(high[c], pixel[c]);
            }
        }
    const auto within = [&](int c) {
        return std::clamp(static_cast<float>(sum[c]), low[c], high[c]);
    };
    return Rgbw{within(0), within(1), within(2), 1};
}

}  // namespace

Image resample(const Source& source, const Layout& layout, int size, const ResampleOptions& options,
               const Watch& watch) {
    Image out(layout.picture(size), 4);
    std::visit(
        [&]<class T, class P>(const T& target, const P&) {
            const Lookup<P> lookup(source);
            const Pass<T, P> pass(target, out.size(), options.rotation.inverse(), lookup);
            if (options.filter == Filter::fast)
                for_each_pixel(out, watch, [&](int x, int y) { return pass.fast(x, y); });
            else
                for_each_pixel(out, watch, [&](int x, int y) { return pass.adaptive(x, y); });
        },
        layout.projection, source.projection);
    return out;
}

Image render_ball(const Source& map, const MirrorBall& ball, const Window& region,
                  const Rotation& rotation, const Watch& watch) {
    Image out(region.size, 4);
    const BallInRegion target(ball, region);
    std::visit(
        [&]<class P>(const P&) {
            const Lookup<P> lookup(map);
            const Pass<BallInRegion, P> pass(target, out.size(), rotation, lookup);
            for_each_pixel(out, watch, [&](int x, int y) { return pass.adaptive(x, y); });
        },
        map.projection);
    return out;
}

int natural_size(const Source& source, const Layout& layout) {
    const double wanted =
        std::sqrt(4 * std::numbers::pi / (layout.directed_area() * source.mean_solid_angle));
    const double power = std::clamp(std::round(std::log2(wanted)), 6.0, 12.0);
    return 1 << static_cast<int>(power);
}

Image crop_ball(const Image& pixels, const Outline& outline, const Affine& to_pixels, int size,
                const Watch& watch) {
    const Source source = ball_source(pixels, MirrorBall(outline), to_pixels);
    const Lookup<MirrorBall> lookup(source);
    const Affine to_photo = crop_of(outline, size).inverse();
    Image out({size, size}, 4);
    for_each_pixel(out, watch, [&](int x, int y) {
        // Alpha is the part of the pixel inside the circle; colour is the ball's throughout.
        constexpr int kGrid = 4;
        int inside = 0;
        for (int k = 0; k < kGrid * kGrid; ++k) {
            const double dx = x + (k % kGrid + 0.5) / kGrid - 0.5 * size;
            const double dy = y + (k / kGrid + 0.5) / kGrid - 0.5 * size;
            inside += dx * dx + dy * dy <= 0.25 * size * size;
        }
        Sum sum;
        sum.total = 1;
        if (inside == 0) return sum;
        const V2d at = source.to_pixels(to_photo(V2d(x + 0.5, y + 0.5)));
        auto tap = cubic_tap(source.pixels.view(), at);
        if (!tap) tap = lookup.tap(at);
        sum.total = 0;
        sum.add(1, tap);
        const double part = static_cast<double>(inside) / (kGrid * kGrid);
        return Sum{sum.r * part, sum.g * part, sum.b * part, sum.alpha * part, 1};
    });
    return out;
}

}  // namespace chromeball
