#include "render/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "resample/resample.h"

namespace chromeball {
namespace {

using std::numbers::pi;
constexpr float kPi = std::numbers::pi_v<float>;

const Layout& column() { return *find_layout("openexr"); }
const Layout& latlong() { return *find_layout("latlong"); }

Layout layout_of(bool cube) { return cube ? column() : latlong(); }

/// Four channels, whatever the map has, in one of the two shapes.
Image as_light(Image pixels, const Layout& layout, bool& cube) {
    const bool is_cube = std::holds_alternative<Cube>(layout.projection);
    cube = is_cube;
    const bool fits = layout.name == "latlong" || layout.name == "openexr" ||
                      (layout.separate_faces && layout.name == "faces");
    if (fits && pixels.channels() == 4) return pixels;
    if (fits) {
        Image out(pixels.size(), 4);
        for_each_band(out.height(), 32, [&](int first, int last) {
            for (int y = first; y < last; ++y)
                for (int x = 0; x < out.width(); ++x) {
                    std::copy_n(pixels.pixel(x, y), 3, out.pixel(x, y));
                    out.pixel(x, y)[3] = 1;
                }
        });
        return out;
    }
    const Source source = map_source(pixels, layout);
    const int size =
        is_cube ? pixels.width() / layout.width_units : natural_size(source, latlong());
    pixels = {};
    return resample(source, is_cube ? column() : latlong(), size);
}

/// Half as large: means of 2 x 2 pixels. The pixels of a block have nearly the same solid angle.
Image halved(const Image& image, const Layout& layout) {
    const Size size{image.width() / 2, image.height() / 2};
    if (image.width() % 2 != 0 || image.height() % 2 != 0 ||
        size != layout.picture(size.width / layout.width_units))
        return resample(map_source(image, layout), layout,
                        std::max(1, image.width() / layout.width_units / 2));
    Image out(size, 4);
    for_each_band(size.height, 16, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            const float* above = image.row(2 * y);
            const float* below = image.row(2 * y + 1);
            float* to = out.row(y);
            for (int x = 0; x < size.width; ++x, above += 8, below += 8, to += 4)
                for (int c = 0; c < 4; ++c)
                    to[c] = 0.25F * ((above[c] + above[c + 4]) + (below[c] + below[c + 4]));
        }
    });
    return out;
}

/// Fills what a map does not show with what its coarser level has there.
void fill_holes(Image& image, const Source& coarser, const Layout& layout) {
    Image filling(image.size(), 4);
    resample(coarser, layout, filling.view(), {Filter::fast, {}});
    for_each_band(image.height(), 16, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < image.width(); ++x) {
                float* to = image.pixel(x, y);
                const float* from = filling.pixel(x, y);
                const float lacking = 1 - to[3];
                if (lacking <= 0) continue;
                for (int c = 0; c < 4; ++c) to[c] += lacking * from[c];
            }
    });
}

/// Alpha's mean over the sphere.
double coverage(const Image& image, const Layout& layout) {
    double shown = 0, all = 0;
    std::visit(
        [&](const auto& projection) {
            for (int y = 0; y < image.height(); ++y)
                for (int x = 0; x < image.width(); ++x) {
                    const double weight = projection.solid_angle(
                        V2d((x + 0.5) / image.width(), (y + 0.5) / image.height()));
                    shown += weight * static_cast<double>(image.pixel(x, y)[3]);
                    all += weight;
                }
        },
        layout.projection);
    return shown / all;
}

bool has_holes(const Image& image) {
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            if (image.pixel(x, y)[3] < 1) return true;
    return false;
}

/// Where nothing at all is shown around, black counts as shown.
void normalise(Image& image) {
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            float* p = image.pixel(x, y);
            const float scale = p[3] > 0 ? 1 / p[3] : 0;
            for (int c = 0; c < 3; ++c) p[c] *= scale;
            p[3] = 1;
        }
}

/// atan(x) for x in [-1, 1] to 2e-8. Abramowitz and Stegun, 4.4.49.
float small_arctangent(float x) {
    const float s = x * x;
    float p = 0.0028662257F;
    for (const float c : {-0.0161657367F, 0.0429096138F, -0.0752896400F, 0.1065626393F,
                          -0.1420889944F, 0.1999355085F, -0.3333314528F, 1.0F})
        p = p * s + c;
    return p * x;
}

float arctangent(float y, float x) {
    const float ax = std::abs(x), ay = std::abs(y);
    const float high = std::max(ax, ay), low = std::min(ax, ay);
    float a = high > 0 ? small_arctangent(low / high) : 0;
    if (ay > ax) a = 0.5F * kPi - a;
    if (x < 0) a = kPi - a;
    return y < 0 ? -a : a;
}

/// Right, down and forward of the faces of a cube in our order, as floats.
struct Frame {
    V3f right, down, forward;
};
const std::array<Frame, 6>& frames() {
    static const std::array<Frame, 6> kFrames = [] {
        std::array<Frame, 6> all;
        const CubeLayout& layout = cube_layouts().front();
        for (int i = 0; i < 6; ++i) {
            const Face& face = layout.faces[static_cast<std::size_t>(i)];
            all[static_cast<std::size_t>(i)] = {V3f(face.right), V3f(face.down),
                                                V3f(layout.forward(i))};
        }
        return all;
    }();
    return kFrames;
}

/// The longer axis of the ellipse that a footprint of two steps makes, in pixels, and how the steps
/// make it.
struct Axis {
    float longer, shorter;
    float of_x, of_y;  // unit: the longer axis is of_x by_x + of_y by_y
};
Axis axis_of(float ax, float ay, float bx, float by) {
    const float aa = ax * ax + ay * ay, bb = bx * bx + by * by, ab = ax * bx + ay * by;
    const float half = 0.5F * (aa - bb), mean = 0.5F * (aa + bb);
    const float root = std::sqrt(half * half + ab * ab);
    const float cosine = root > 0 ? half / root : 1;  // of twice the angle between steps and axes
    const float c = std::sqrt(std::max(0.0F, 0.5F * (1 + cosine)));
    const float s = std::copysign(std::sqrt(std::max(0.0F, 0.5F * (1 - cosine))), ab);
    return {std::sqrt(mean + root), std::sqrt(std::max(0.0F, mean - root)), c, s};
}

}  // namespace

Environment::Environment(Image pixels, const Layout& layout) {
    std::vector<Image> images;
    images.push_back(as_light(std::move(pixels), layout, cube_));
    const Layout shape = layout_of(cube_);
    while (images.back().width() / shape.width_units > (cube_ ? 1 : 2))
        images.push_back(halved(images.back(), shape));
    if (has_holes(images.front())) {
        covered_ = coverage(images.front(), shape);
        normalise(images.back());
        for (std::size_t i = images.size() - 1; i-- > 0;)
            fill_holes(images[i], map_source(images[i + 1], shape), shape);
    }
    const int lines = images.front().width() / shape.width_units;
    pixel_angle_ = (cube_ ? 0.5 : 1.0) * pi / lines;
    make_matte(images, shape);
    for (Image& image : images) {
        const int size = image.width() / shape.width_units;
        Source source = map_source(image, shape);
        image = {};
        levels_.push_back({std::move(source.pixels), cube_ ? size : 2 * size, size, source.border});
    }
}

void Environment::make_matte(const std::vector<Image>& images, const Layout& layout) {
    constexpr int kLines = 64, kFace = 32;
    const auto few = std::find_if(images.begin(), images.end(), [&](const Image& image) {
        return image.width() / layout.width_units <= kLines;
    });
    struct Light {
        V3f direction, flux;
    };
    std::vector<Light> lights;
    std::visit(
        [&](const auto& projection) {
            const double area = static_cast<double>(few->size().pixels());
            for (int y = 0; y < few->height(); ++y)
                for (int x = 0; x < few->width(); ++x) {
                    const V2d at((x + 0.5) / few->width(), (y + 0.5) / few->height());
                    const float* p = few->pixel(x, y);
                    const double part = projection.solid_angle(at) / area;
                    lights.push_back(
                        {V3f(*projection.to_direction(at)), V3f(V3d(p[0], p[1], p[2]) * part)});
                }
        },
        layout.projection);
    // What roundings and large pixels leave of 4 pi: a white world makes a white surface.
    Image matte({kFace, 6 * kFace}, 4);
    const Cube cube;
    for_each_band(matte.height(), 4, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            // A row's normals side by side, as processors like it.
            float nx[kFace], ny[kFace], nz[kFace], sums[3][kFace] = {};
            for (int x = 0; x < kFace; ++x) {
                const V3f n(*cube.to_direction(V2d((x + 0.5) / kFace, (y + 0.5) / matte.height())));
                nx[x] = n.x, ny[x] = n.y, nz[x] = n.z;
            }
            for (const Light& light : lights) {
                const V3f d = light.direction, flux = light.flux;
                for (int x = 0; x < kFace; ++x) {
                    const float cosine = std::max(0.0F, nx[x] * d.x + ny[x] * d.y + nz[x] * d.z);
                    sums[0][x] += flux.x * cosine;
                    sums[1][x] += flux.y * cosine;
                    sums[2][x] += flux.z * cosine;
                }
            }
            for (int x = 0; x < kFace; ++x) {
                for (int c = 0; c < 3; ++c) matte.pixel(x, y)[c] = sums[c][x] / kPi;
                matte.pixel(x, y)[3] = 1;
            }
        }
    });
    Source source = map_source(matte, column());
    matte_ = {std::move(source.pixels), kFace, kFace, source.border};
}

Environment::Place Environment::place_of(const V3f& r) const {
    if (!cube_) {
        const float across = std::sqrt(r.x * r.x + r.z * r.z);
        const float u = 0.5F - arctangent(r.x, r.z) * (0.5F / kPi);
        const float v = 0.5F - arctangent(r.y, across) / kPi;
        return {u * static_cast<float>(levels_.front().width),
                v * static_cast<float>(levels_.front().height), 0};
    }
    const int face = face_of(V3d(r));
    const Frame& f = frames()[static_cast<std::size_t>(face)];
    const float half = 0.5F * static_cast<float>(levels_.front().width) / r.dot(f.forward);
    return {half * (r.dot(f.right) + r.dot(f.forward)), half * (r.dot(f.down) + r.dot(f.forward)),
            face};
}

V3f Environment::tap(const Level& level, const Place& place, float scale) const {
    const auto border = static_cast<float>(level.border);
    const float x = place.x * scale + border - 0.5F, y = place.y * scale + border - 0.5F;
    const int x0 = std::clamp(static_cast<int>(x), 0, level.pixels.width() - 2);
    const int y0 = std::clamp(static_cast<int>(y), 0, level.height + 2 * level.border - 2);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const float* p = level.pixels.pixel(x0, y0 + place.face * (level.height + 2 * level.border));
    const float* q = p + static_cast<std::ptrdiff_t>(level.pixels.width()) * 4;
    const float a = (1 - fx) * (1 - fy), b = fx * (1 - fy), c = (1 - fx) * fy, d = fx * fy;
    float sum[4];
    for (int i = 0; i < 4; ++i) sum[i] = a * p[i] + b * p[i + 4] + (c * q[i] + d * q[i + 4]);
    return {sum[0], sum[1], sum[2]};
}

V3f Environment::trilinear(const V3f& r, float level) const {
    const Place place = place_of(r);
    const auto last = static_cast<float>(levels_.size() - 1);
    level = std::clamp(level, 0.0F, last);
    const auto lower = static_cast<std::size_t>(level);
    const float part = level - static_cast<float>(lower);
    const auto scale = [&](std::size_t i) {
        return static_cast<float>(levels_[i].width) / static_cast<float>(levels_.front().width);
    };
    const V3f fine = tap(levels_[lower], place, scale(lower));
    if (part <= 0 || lower + 1 >= levels_.size()) return fine;
    const V3f coarse = tap(levels_[lower + 1], place, scale(lower + 1));
    return fine + (coarse - fine) * part;
}

V3f Environment::radiance(const V3f& r, const V3f& by_x, const V3f& by_y) const {
    // The footprint's sides in pixels of the finest level.
    float ax = 0, ay = 0, bx = 0, by = 0;
    if (cube_) {
        const Frame& f = frames()[static_cast<std::size_t>(face_of(V3d(r)))];
        const float depth = r.dot(f.forward), n = 0.5F * static_cast<float>(levels_[0].width);
        const float a = r.dot(f.right) / depth, b = r.dot(f.down) / depth, k = n / depth;
        ax = k * (by_x.dot(f.right) - a * by_x.dot(f.forward));
        ay = k * (by_x.dot(f.down) - b * by_x.dot(f.forward));
        bx = k * (by_y.dot(f.right) - a * by_y.dot(f.forward));
        by = k * (by_y.dot(f.down) - b * by_y.dot(f.forward));
    } else {
        const auto lines = static_cast<float>(levels_[0].height);
        const float square = std::max(r.x * r.x + r.z * r.z, 1e-12F), root = std::sqrt(square);
        const float h = lines / kPi / square, v = lines / kPi / root;
        ax = h * (by_x.z * r.x - by_x.x * r.z);
        ay = -v * by_x.y;
        bx = h * (by_y.z * r.x - by_y.x * r.z);
        by = -v * by_y.y;
        // Around a pole a pixel's step is no longer than half a turn.
        ax = std::clamp(ax, -lines, lines);
        bx = std::clamp(bx, -lines, lines);
    }
    const Axis axis = axis_of(ax, ay, bx, by);
    constexpr float kMostTaps = 32;
    const float taps =
        std::clamp(std::ceil(axis.longer / std::max(axis.shorter, 1.0F)), 1.0F, kMostTaps);
    const float width = std::max(axis.shorter, axis.longer / taps);
    // Half a level finer than the footprint: the mean of 2^l pixels and the bilinear tap blur too.
    const float level = width > 1 ? std::log2(width) - 0.5F : 0;
    if (taps == 1) return trilinear(r, level);
    const V3f step = by_x * axis.of_x + by_y * axis.of_y;
    V3f sum(0);
    const auto count = static_cast<int>(taps);
    for (int i = 0; i < count; ++i) {
        const float t = (static_cast<float>(i) + 0.5F) / taps - 0.5F;
        sum += trilinear((r + step * t).normalized(), level);
    }
    return sum / taps;
}

V3f Environment::radiance(const V3f& r, float solid_angle) const {
    const float side = std::sqrt(solid_angle);
    const V3f other = std::abs(r.x) < 0.7F ? V3f(1, 0, 0) : V3f(0, 1, 0);
    const V3f across = r.cross(other).normalized();
    return radiance(r, across * side, r.cross(across) * side);
}

V3f Environment::matte(const V3f& normal) const {
    const int face = face_of(V3d(normal));
    const Frame& f = frames()[static_cast<std::size_t>(face)];
    const float depth = normal.dot(f.forward), half = 0.5F * static_cast<float>(matte_.width);
    return tap(
        matte_,
        {half * (normal.dot(f.right) / depth + 1), half * (normal.dot(f.down) / depth + 1), face},
        1);
}

}  // namespace chromeball
