#include "resample/source.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace chromeball {
namespace {

using std::numbers::pi;

/// A pixel is used when the rim is this many times the lens' blur away: 97 % of an edge lies
/// within.
constexpr double kBlurInset = 2;

void copy_pixel(const Image& from, int x, int y, float* to) {
    const float* p = from.pixel(x, y);
    std::copy_n(p, 3, to);
    to[3] = from.channels() > 3 ? p[3] : 1.0F;
}

template <class Work>
void for_each_row(const Image& image, const Work& work) {
    for_each_band(image.height(), 32, [&](int first, int last) {
        for (int y = first; y < last; ++y) work(y);
    });
}

/// Pixels with a border that repeats the outermost ones.
Image bordered(const Image& pixels, int border) {
    Image out({pixels.width() + 2 * border, pixels.height() + 2 * border}, 4);
    for_each_row(out, [&](int y) {
        for (int x = 0; x < out.width(); ++x)
            copy_pixel(pixels, std::clamp(x - border, 0, pixels.width() - 1),
                       std::clamp(y - border, 0, pixels.height() - 1), out.pixel(x, y));
    });
    return out;
}

/// Clears every pixel of which a part, or of whose blurred light a part, lies outside the outline.
void drop_impure(Image& pixels, const Outline& outline, double rim_blur) {
    const double turn = outline.angle * pi / 180, c = std::cos(turn), s = std::sin(turn);
    const double inset = kBlurInset * rim_blur;
    const double surely = std::max(0.0, 1 - (1 + inset) / outline.b);
    for_each_row(pixels, [&](int y) {
        for (int x = 0; x < pixels.width(); ++x) {
            const double dx = x + 0.5 - outline.cx, dy = y + 0.5 - outline.cy;
            const double u = (dx * c + dy * s) / outline.a, v = (dy * c - dx * s) / outline.b;
            if (u * u + v * v < surely * surely) continue;
            const double gu = u / outline.a, gv = v / outline.b;
            const double gradient = std::hypot(gu, gv);
            if (gradient == 0) continue;
            // First-order distance to the rim, inwards, less how far the square reaches outwards.
            const double inside = (1 - u * u - v * v) / (2 * gradient);
            const double nx = (gu * c - gv * s) / gradient, ny = (gu * s + gv * c) / gradient;
            if (inside < 0.5 * (std::abs(nx) + std::abs(ny)) + inset)
                std::fill_n(pixels.pixel(x, y), 4, 0.0F);
        }
    });
}

Outline transformed(const Outline& outline, const Affine& to) {
    // Only shifts and crops (whose result is a circle) occur.
    const V2d centre = to(V2d(outline.cx, outline.cy));
    if (to.xy == 0 && to.xx == 1 && to.yy == 1)
        return {centre.x, centre.y, outline.a, outline.b, outline.angle};
    const double turn = outline.angle * pi / 180;
    const V2d end =
        to(V2d(outline.cx + outline.a * std::cos(turn), outline.cy + outline.a * std::sin(turn)));
    const V2d side =
        to(V2d(outline.cx - outline.b * std::sin(turn), outline.cy + outline.b * std::cos(turn)));
    return {centre.x, centre.y, (end - centre).length(), (side - centre).length(), outline.angle};
}

/// Bilinear between the pixels of an image without a border, at a position inside it.
void sample(const Image& pixels, V2d p, float* out) {
    const double x = std::clamp(p.x - 0.5, 0.0, pixels.width() - 1.0);
    const double y = std::clamp(p.y - 0.5, 0.0, pixels.height() - 1.0);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, pixels.width() - 1), y1 = std::min(y0 + 1, pixels.height() - 1);
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    float p00[4], p10[4], p01[4], p11[4];
    copy_pixel(pixels, x0, y0, p00);
    copy_pixel(pixels, x1, y0, p10);
    copy_pixel(pixels, x0, y1, p01);
    copy_pixel(pixels, x1, y1, p11);
    for (int i = 0; i < 4; ++i)
        out[i] =
            (1 - fy) * ((1 - fx) * p00[i] + fx * p10[i]) + fy * ((1 - fx) * p01[i] + fx * p11[i]);
}

/// A lat-long's border: columns go round, rows continue beyond the pole on the other side.
Image prepared_latlong(const Image& pixels, int border) {
    const int width = pixels.width(), height = pixels.height();
    Image out({width + 2 * border, height + 2 * border}, 4);
    for (int y = 0; y < out.height(); ++y) {
        int from_y = y - border, turn = 0;
        if (from_y < 0 || from_y >= height) {
            from_y = from_y < 0 ? -1 - from_y : 2 * height - 1 - from_y;
            turn = width / 2;
        }
        from_y = std::clamp(from_y, 0, height - 1);
        for (int x = 0; x < out.width(); ++x)
            copy_pixel(pixels, ((x - border + turn) % width + width) % width, from_y,
                       out.pixel(x, y));
    }
    return out;
}

/// The face's cell of a layout as an image of its own.
Image face_image(const Image& pixels, const Face& face, int size) {
    Image out({size, size}, 4);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            copy_pixel(pixels, face.column * size + x, face.row * size + y, out.pixel(x, y));
    return out;
}

/// Faces below each other, with borders looked up, by direction, on the faces that join there.
Image prepared_cube(const Image& pixels, const Cube& cube, int size, int border) {
    std::array<Image, 6> faces;
    for (std::size_t i = 0; i < 6; ++i) faces[i] = face_image(pixels, cube.layout().faces[i], size);
    const int padded = size + 2 * border;
    Image out({padded, 6 * padded}, 4);
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < padded; ++y)
            for (int x = 0; x < padded; ++x) {
                float* to = out.pixel(x, face * padded + y);
                const int fx = x - border, fy = y - border;
                if (fx >= 0 && fx < size && fy >= 0 && fy < size) {
                    std::copy_n(faces[static_cast<std::size_t>(face)].pixel(fx, fy), 4, to);
                    continue;
                }
                const V3d d =
                    cube.direction_on(face, 2 * (fx + 0.5) / size - 1, 2 * (fy + 0.5) / size - 1);
                const int other = face_of(d);
                const V2d ab = cube.coordinates_on(other, d);
                sample(faces[static_cast<std::size_t>(other)], (ab + V2d(1, 1)) * (0.5 * size), to);
            }
    return out;
}

/// An angular map whose pixels beyond the edge hold what lies there: the other side of +Z.
Image prepared_angular(const Image& pixels, int border) {
    const int size = pixels.width();
    Image out = bordered(pixels, border);
    const auto inside = [&](double x, double y) {
        // The corner farthest out: a pixel that the edge cuts may hold anything in part of it.
        const double dx = std::abs(2 * x / size - 1) + 1.0 / size,
                     dy = std::abs(2 * y / size - 1) + 1.0 / size;
        return dx * dx + dy * dy <= 1;
    };
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x) {
            const double px = x - border + 0.5, py = y - border + 0.5;
            if (inside(px, py)) continue;
            const double dx = 2 * px / size - 1, dy = 2 * py / size - 1, r = std::hypot(dx, dy);
            // Radius r beyond 1 is radius 2 - r on the other side; a cut pixel (r < 1) is drawn in:
            // to 1.45 pixels from the edge, where the nearest pixel's middle is 0.7 off at most and
            // the pixel itself another 0.7.
            const double safe = 1 - 2.9 / size;
            const double to = r > 1 ? -std::min(2 - r, safe) : std::min(r, safe);
            const auto nearest = [&](double along) {
                return std::clamp(static_cast<int>(0.5 * size * (1 + along / r * to)), 0, size - 1);
            };
            copy_pixel(pixels, nearest(dx), nearest(dy), out.pixel(x, y));
        }
    return out;
}

}  // namespace

Window needed_window(const Outline& outline, const Window& available) {
    const double turn = outline.angle * pi / 180;
    const double half_width =
        std::hypot(outline.a * std::cos(turn), outline.b * std::sin(turn)) + 2;
    const double half_height =
        std::hypot(outline.a * std::sin(turn), outline.b * std::cos(turn)) + 2;
    const auto cut = [](double v, int low, int high) {
        return static_cast<int>(std::clamp(v, static_cast<double>(low), static_cast<double>(high)));
    };
    const int right = available.x + available.size.width,
              bottom = available.y + available.size.height;
    const int x0 = cut(std::floor(outline.cx - half_width), available.x, right);
    const int x1 = cut(std::ceil(outline.cx + half_width), available.x, right);
    const int y0 = cut(std::floor(outline.cy - half_height), available.y, bottom);
    const int y1 = cut(std::ceil(outline.cy + half_height), available.y, bottom);
    return {x0, y0, {x1 - x0, y1 - y0}};
}

Source ball_source(const Image& pixels, const MirrorBall& ball, const Affine& to_pixels,
                   double rim_blur) {
    assert(!pixels.empty());
    Source source;
    source.projection = ball;
    source.border = 1;
    source.pixels = bordered(pixels, source.border);
    source.to_pixels = to_pixels;
    source.to_pixels.x0 += source.border;
    source.to_pixels.y0 += source.border;
    source.ball = transformed(ball.outline(), source.to_pixels);
    drop_impure(source.pixels, *source.ball, rim_blur);
    // Half a pixel, where the rim runs along rows, is the least at which a pixel is purely ball.
    source.rim = RimStrip(source.pixels, *source.ball, 0.5 + kBlurInset * rim_blur);
    source.left = source.top = source.border;
    source.right = source.border + pixels.width();
    source.bottom = source.border + pixels.height();
    const double hidden = 2 * pi * (1 - std::cos(ball.hidden_half_angle()));
    source.mean_solid_angle = (4 * pi - hidden) / area(*source.ball);
    return source;
}

Source map_source(const Image& pixels, const Layout& layout) {
    const int size = pixels.width() / layout.width_units;
    assert(pixels.size() == layout.picture(size));
    if (const auto* ball = std::get_if<MirrorBall>(&layout.projection))
        return ball_source(pixels, *ball, scale(size, size));

    Source source;
    source.projection = layout.projection;
    source.border = 2;
    source.to_pixels = {static_cast<double>(pixels.width()),  0,
                        static_cast<double>(source.border),   0,
                        static_cast<double>(pixels.height()), static_cast<double>(source.border)};
    if (const auto* cube = std::get_if<Cube>(&layout.projection)) {
        source.face_size = size;
        source.pixels = prepared_cube(pixels, *cube, size, source.border);
    } else if (std::holds_alternative<LatLong>(layout.projection)) {
        source.pixels = prepared_latlong(pixels, source.border);
    } else {
        source.pixels = prepared_angular(pixels, source.border);
    }
    source.mean_solid_angle = 4 * pi / (layout.directed_area() * size * size);
    return source;
}

}  // namespace chromeball
