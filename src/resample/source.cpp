#include "resample/source.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numbers>

#include "core/parallel.h"
#include "resample/copies.h"
#include "resample/ellipse_rows.h"

namespace chromeball {
namespace {

using std::numbers::pi;

/// A pixel is used when the rim is this many times the lens' blur away: 97 % of an edge lies
/// within.
constexpr double kBlurInset = 2;

void copy_pixel(ImageView<const float> from, int x, int y, float* to) {
    const float* p = from.pixel(x, y);
    std::copy_n(p, 3, to);
    to[3] = from.channels > 3 ? p[3] : 1.0F;
}

/// A run of pixels in a row.
void copy_pixels(ImageView<const float> from, int x, int y, int count, float* to) {
    if (count <= 0) return;
    const float* p = from.pixel(x, y);
    if (from.channels > 3) {
        for (int i = 0; i < count; ++i, p += from.channels, to += 4) std::memcpy(to, p, 16);
        return;
    }
    // Four floats at a time, the fourth of them overwritten; the last may be the picture's last.
    for (int i = 0; i + 1 < count; ++i, p += 3, to += 4) {
        std::memcpy(to, p, 16);
        to[3] = 1;
    }
    std::copy_n(p, 3, to);
    to[3] = 1;
}

constexpr int kBandRows = 32;

ImageView<const float> rows_of(const Image& image, int first, int last) {
    const ImageView<const float> all = image.view();
    return {all.row(first), {all.size.width, last - first}, all.channels, all.stride};
}

template <class Work>
void for_each_row(const Image& image, const Work& work) {
    for_each_band(image.height(), kBandRows, [&](int first, int last) {
        for (int y = first; y < last; ++y) work(y);
    });
}

/// Pixels with a border that repeats the outermost ones.
Image bordered(const Image& pixels, int border) {
    Image out({pixels.width() + 2 * border, pixels.height() + 2 * border}, 4);
    for_each_row(out, [&](int y) {
        const int from_y = std::clamp(y - border, 0, pixels.height() - 1);
        copy_pixels(pixels.view(), 0, from_y, pixels.width(), out.pixel(border, y));
        for (int i = 0; i < border; ++i) {
            copy_pixel(pixels.view(), 0, from_y, out.pixel(i, y));
            copy_pixel(pixels.view(), pixels.width() - 1, from_y,
                       out.pixel(out.width() - 1 - i, y));
        }
    });
    return out;
}

/// Prepares rows of a ball's photo: with a border around it, wherever the ball reaches the photo's
/// edge, that repeats the outermost pixels. Left clear is every pixel of which a part, or of whose
/// blurred light a part, lies outside the outline (given in the bordered picture's pixels).
class PureBall {
public:
    PureBall(const Outline& outline, int border, double rim_blur, Image& out,
             std::vector<RowLight>& lights)
        : rows_(outline),
          border_(border),
          inset_(kBlurInset * rim_blur),
          surely_(1 - (1 + inset_) / outline.b),
          out_(out),
          lights_(lights) {}

    /// The photo's rows from `first` on.
    void add(int first, ImageView<const float> pixels) const {
        const int height = out_.height() - 2 * border_;
        for (int y = 0; y < pixels.size.height; ++y) {
            const int row = first + y + border_;
            prepare(pixels, y, row);
            light(row);
            for (int i = 0; i < border_; ++i) {
                if (first + y == 0) prepare(pixels, y, i);
                if (first + y == height - 1) prepare(pixels, y, height + border_ + i);
            }
        }
    }

private:
    /// The row y of the bordered picture from the row from_y of the pixels.
    void prepare(ImageView<const float> pixels, int from_y, int y) const {
        const auto outer = rows_.span(y + 0.5, 1);
        if (!outer) return;
        const auto copy = [&](int x) {
            copy_pixel(pixels, std::clamp(x - border_, 0, pixels.size.width - 1), from_y,
                       out_.pixel(x, y));
        };
        const auto copy_if_pure = [&](int first, int last) {
            for (int x = first; x < last; ++x)
                if (is_pure(x, y)) copy(x);
        };
        const int first = column(outer->left - 1), last = column(outer->right + 1);
        // Pixels whose middles lie in the shrunken ellipse are pure.
        const auto inner = rows_.span(y + 0.5, surely_);
        const int inner_first = inner ? column(std::ceil(inner->left - 0.5)) : last;
        const int inner_last = inner ? std::max(inner_first, column(inner->right + 0.5)) : last;
        copy_if_pure(first, inner_first);
        const int plain_first = std::clamp(border_, inner_first, inner_last);
        const int plain_last = std::clamp(border_ + pixels.size.width, plain_first, inner_last);
        for (int x = inner_first; x < plain_first; ++x) copy(x);
        copy_pixels(pixels, plain_first - border_, from_y, plain_last - plain_first,
                    plain_first < plain_last ? out_.pixel(plain_first, y) : nullptr);
        for (int x = plain_last; x < inner_last; ++x) copy(x);
        copy_if_pure(inner_last, last);
    }

    /// While the row is in the nearest cache.
    void light(int y) const {
        const auto span = rows_.span(y + 0.5, 1);
        if (!span) return;
        const int first = std::max(column(span->left - 1), border_),
                  last = std::min(column(span->right + 1), out_.width() - border_);
        if (first < last)
            lights_[static_cast<std::size_t>(y)] =
                row_light(out_.pixel(first, y), static_cast<std::size_t>(last - first));
    }

    bool is_pure(int x, int y) const {
        const EllipseRows::Place p = rows_.at(x + 0.5, y + 0.5);
        const double gradient = std::hypot(p.gu, p.gv);
        if (gradient == 0) return true;
        const double c = rows_.cosine(), s = rows_.sine();
        // First-order distance to the rim, less how far the square reaches outwards.
        const double nx = (p.gu * c - p.gv * s) / gradient, ny = (p.gu * s + p.gv * c) / gradient;
        return p.depth() >= 0.5 * (std::abs(nx) + std::abs(ny)) + inset_;
    }

    int column(double x) const {
        return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(out_.width())));
    }

    EllipseRows rows_;
    int border_;
    double inset_;
    double surely_;  ///< the ellipse made that much smaller holds pure pixels only
    Image& out_;
    std::vector<RowLight>& lights_;
};

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

/// The four pixels around a position in an image without a border.
struct Around {
    int x0, y0, x1, y1;
    float fx, fy;  ///< how far from the first to the second

    Around(Size size, V2d p) {
        const double x = std::clamp(p.x - 0.5, 0.0, size.width - 1.0);
        const double y = std::clamp(p.y - 0.5, 0.0, size.height - 1.0);
        x0 = static_cast<int>(x), y0 = static_cast<int>(y);
        x1 = std::min(x0 + 1, size.width - 1), y1 = std::min(y0 + 1, size.height - 1);
        fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    }
    /// The weight of a pixel in what is there.
    float part(int x, int y) const {
        const float across = (x == x0 ? 1 - fx : 0) + (x == x1 ? fx : 0);
        return across * ((y == y0 ? 1 - fy : 0) + (y == y1 ? fy : 0));
    }
};

/// Bilinear between the pixels of an image without a border, at a position inside it.
void sample(const Image& pixels, V2d p, float* out) {
    const auto [x0, y0, x1, y1, fx, fy] = Around(pixels.size(), p);
    float p00[4], p10[4], p01[4], p11[4];
    copy_pixel(pixels.view(), x0, y0, p00);
    copy_pixel(pixels.view(), x1, y0, p10);
    copy_pixel(pixels.view(), x0, y1, p01);
    copy_pixel(pixels.view(), x1, y1, p11);
    for (int i = 0; i < 4; ++i)
        out[i] =
            (1 - fy) * ((1 - fx) * p00[i] + fx * p10[i]) + fy * ((1 - fx) * p01[i] + fx * p11[i]);
}

/// The row of a lat-long that continues it as row y, and by how many columns it is turned then:
/// beyond a pole comes the other side.
struct LatLongRow {
    int y = 0, turn = 0;
};
LatLongRow latlong_row(Size size, int y) {
    LatLongRow row{y, 0};
    if (y < 0 || y >= size.height) row = {y < 0 ? -1 - y : 2 * size.height - 1 - y, size.width / 2};
    row.y = std::clamp(row.y, 0, size.height - 1);
    return row;
}

/// A lat-long's border: columns go round, rows continue beyond the pole on the other side.
Image prepared_latlong(const Image& pixels, int border) {
    const int width = pixels.width(), height = pixels.height();
    Image out({width + 2 * border, height + 2 * border}, 4);
    for_each_row(out, [&](int y) {
        const auto [from_y, turn] = latlong_row({width, height}, y - border);
        // Runs up to where the row begins anew.
        for (int x = 0; x < out.width();) {
            const int from_x = ((x - border + turn) % width + width) % width;
            const int count = std::min(out.width() - x, width - from_x);
            copy_pixels(pixels.view(), from_x, from_y, count, out.pixel(x, y));
            x += count;
        }
    });
    return out;
}

/// A face of a layout as an image of its own, turned (or mirrored) as `upright` has it.
Image face_image(const Image& pixels, const Face& face, const Face& upright, int size) {
    // Both are spanned by the same two axes: these are 0, 1 or -1.
    const auto sign = [](V3d a, V3d b) { return static_cast<int>(std::lround(a.dot(b))); };
    const int xx = sign(upright.right, face.right), xy = sign(upright.down, face.right);
    const int yx = sign(upright.right, face.down), yy = sign(upright.down, face.down);
    Image out({size, size}, 4);
    for_each_row(out, [&](int y) {
        for (int x = 0; x < size; ++x) {
            // Twice the offset of the pixel's middle from the face's.
            const int a = 2 * x + 1 - size, b = 2 * y + 1 - size;
            copy_pixel(pixels.view(), face.column * size + (xx * a + xy * b + size - 1) / 2,
                       face.row * size + (yx * a + yy * b + size - 1) / 2, out.pixel(x, y));
        }
    });
    return out;
}

/// A position on another face, in its pixels.
struct OnFace {
    int face;
    V2d at;
};
/// What a pixel of a face's border shows, fx and fy counted from the face's first pixel.
OnFace beyond_face(const Cube& cube, int face, int fx, int fy, int size) {
    const V3d d = cube.direction_on(face, 2 * (fx + 0.5) / size - 1, 2 * (fy + 0.5) / size - 1);
    const int other = face_of(d);
    return {other, (cube.coordinates_on(other, d) + V2d(1, 1)) * (0.5 * size)};
}

/// Faces below each other, as the layout `openexr` has them, with borders looked up, by direction,
/// on the faces that join there.
Image prepared_cube(const Image& pixels, const CubeLayout& layout, int size, int border) {
    const Cube cube;
    std::array<Image, 6> faces;
    for (std::size_t i = 0; i < 6; ++i)
        faces[i] = face_image(pixels, layout.faces[i], cube.layout().faces[i], size);
    const int padded = size + 2 * border;
    Image out({padded, 6 * padded}, 4);
    for_each_row(out, [&](int row) {
        const int face = row / padded, y = row % padded, fy = y - border;
        const bool inside = fy >= 0 && fy < size;
        if (inside)
            copy_pixels(faces[static_cast<std::size_t>(face)].view(), 0, fy, size,
                        out.pixel(border, row));
        for (int x = 0; x < padded; ++x) {
            const int fx = x - border;
            if (inside && fx == 0) {
                x += size - 1;
                continue;
            }
            const auto [other, at] = beyond_face(cube, face, fx, fy, size);
            sample(faces[static_cast<std::size_t>(other)], at, out.pixel(x, row));
        }
    });
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
    for_each_row(out, [&](int y) {
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
            copy_pixel(pixels.view(), nearest(dx), nearest(dy), out.pixel(x, y));
        }
    });
    return out;
}

std::vector<Copy> latlong_copies(const Source& source, int x, int y) {
    const int border = source.border;
    const Size size{source.pixels.width() - 2 * border, source.pixels.height() - 2 * border};
    std::vector<Copy> copies;
    const auto look = [&](int row) {
        const auto [from_y, turn] = latlong_row(size, row - border);
        if (from_y != y - border) return;
        const int first = x - border - turn;
        for (int to = first - size.width; to <= first + 2 * size.width; to += size.width)
            if (to >= -border && to < size.width + border && (to + border != x || row != y))
                copies.push_back({to + border, row, 1});
    };
    for (int i = 0; i < border; ++i) {
        look(i);
        look(source.pixels.height() - 1 - i);
    }
    look(y);
    return copies;
}

std::vector<Copy> cube_copies(const Source& source, int x, int y) {
    const int border = source.border, size = source.face_size, padded = size + 2 * border;
    const int own = y / padded, own_x = x - border, own_y = y % padded - border;
    // As far from its face's edge as borders are wide, and a bilinear tap more.
    const int near = border + 2;
    if (std::min(own_x, own_y) >= near && std::max(own_x, own_y) < size - near) return {};
    const Cube cube;
    const V3d d =
        cube.direction_on(own, 2 * (own_x + 0.5) / size - 1, 2 * (own_y + 0.5) / size - 1);
    std::vector<Copy> copies;
    for (int face = 0; face < 6; ++face) {
        if (face == own || !(d.dot(cube.layout().forward(face)) > 0)) continue;
        const V2d at = (cube.coordinates_on(face, d) + V2d(1, 1)) * (0.5 * size);
        if (std::max(std::abs(at.x - 0.5 * size), std::abs(at.y - 0.5 * size)) >
            0.5 * size + 2 * near)
            continue;
        const int middle_x = static_cast<int>(std::floor(at.x)),
                  middle_y = static_cast<int>(std::floor(at.y));
        for (int fy = std::max(middle_y - 3, -border);
             fy <= std::min(middle_y + 3, size + border - 1); ++fy)
            for (int fx = std::max(middle_x - 3, -border);
                 fx <= std::min(middle_x + 3, size + border - 1); ++fx) {
                if (fx >= 0 && fy >= 0 && fx < size && fy < size) continue;
                const auto [other, from] = beyond_face(cube, face, fx, fy, size);
                if (other != own) continue;
                const float part = Around({size, size}, from).part(own_x, own_y);
                if (part > 0) copies.push_back({fx + border, face * padded + fy + border, part});
            }
    }
    return copies;
}

}  // namespace

std::vector<Copy> copies_of(const Source& source, int x, int y) {
    if (std::holds_alternative<LatLong>(source.projection)) return latlong_copies(source, x, y);
    if (std::holds_alternative<Cube>(source.projection)) return cube_copies(source, x, y);
    return {};
}

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

BallSourceMaker::BallSourceMaker(Size size, const MirrorBall& ball, const Affine& to_pixels,
                                 double rim_blur)
    : size_(size), rim_blur_(rim_blur) {
    assert(size.width > 0 && size.height > 0);
    Source& source = source_;
    source.projection = ball;
    source.border = 1;
    source.to_pixels = to_pixels;
    source.to_pixels.x0 += source.border;
    source.to_pixels.y0 += source.border;
    source.ball = transformed(ball.outline(), source.to_pixels);
    source.pixels = Image({size.width + 2 * source.border, size.height + 2 * source.border}, 4);
    source.lights.resize(static_cast<std::size_t>(source.pixels.height()));
    source.left = source.top = source.border;
    source.right = source.border + size.width;
    source.bottom = source.border + size.height;
    const double hidden = 2 * pi * (1 - std::cos(ball.hidden_half_angle()));
    source.mean_solid_angle = (4 * pi - hidden) / area(*source.ball);
}

void BallSourceMaker::add(int first, ImageView<const float> rows) {
    assert(rows.size.width == size_.width && first >= 0 &&
           first + rows.size.height <= size_.height);
    PureBall(*source_.ball, source_.border, rim_blur_, source_.pixels, source_.lights)
        .add(first, rows);
}

Source BallSourceMaker::finish() {
    // Half a pixel, where the rim runs along rows, is the least at which a pixel is purely ball.
    source_.rim = RimStrip(source_.pixels, *source_.ball, 0.5 + kBlurInset * rim_blur_);
    return std::move(source_);
}

Source ball_source(const Image& pixels, const MirrorBall& ball, const Affine& to_pixels,
                   double rim_blur) {
    assert(!pixels.empty());
    BallSourceMaker maker(pixels.size(), ball, to_pixels, rim_blur);
    for_each_band(pixels.height(), kBandRows,
                  [&](int first, int last) { maker.add(first, rows_of(pixels, first, last)); });
    return maker.finish();
}

namespace {

/// A map's rows, without what borders repeat.
void set_lights(Source& source) {
    const Image& pixels = source.pixels;
    const int border = source.border;
    const int padded = source.face_size > 0 ? source.face_size + 2 * border : pixels.height();
    source.lights.resize(static_cast<std::size_t>(pixels.height()));
    for_each_row(pixels, [&](int y) {
        if (y % padded < border || y % padded >= padded - border) return;
        source.lights[static_cast<std::size_t>(y)] = row_light(
            pixels.pixel(border, y), static_cast<std::size_t>(pixels.width() - 2 * border));
    });
}

}  // namespace

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
        source.pixels = prepared_cube(pixels, cube->layout(), size, source.border);
        source.projection = Cube();
    } else if (std::holds_alternative<LatLong>(layout.projection)) {
        source.pixels = prepared_latlong(pixels, source.border);
    } else {
        source.pixels = prepared_angular(pixels, source.border);
    }
    source.mean_solid_angle = 4 * pi / (layout.directed_area() * size * size);
    set_lights(source);
    return source;
}

}  // namespace chromeball
