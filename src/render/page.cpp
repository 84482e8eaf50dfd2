#include "render/page.h"

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "map/dual.h"
#include "resample/resample.h"

namespace chromeball {
namespace {

// Typed arrays of browsers are little-endian, as all machines that run them are.
static_assert(std::endian::native == std::endian::little);

std::string base64(std::span<const std::byte> bytes) {
    constexpr std::string_view kLetters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            return i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U;
        };
        const std::uint32_t all = at(0) << 16 | at(1) << 8 | at(2);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : kLetters[all >> (18 - 6 * k) & 63U];
    }
    return text;
}

template <class T>
std::string base64(const std::vector<T>& values) {
    return base64(std::as_bytes(std::span(values)));
}

std::string map_text(const Image& faces) {
    std::vector<std::uint16_t> halves;
    halves.reserve(faces.size().pixels() * 3);
    for (int y = 0; y < faces.height(); ++y)
        for (int x = 0; x < faces.width(); ++x)
            for (int c = 0; c < 3; ++c)
                halves.push_back(
                    Imath::half(std::clamp(faces.pixel(x, y)[c], -65504.0F, 65504.0F)).bits());
    return base64(halves);
}

/// Runs of equal 8-bit values: length, from 1 to 255, and value.
std::string coverage_text(const Image& faces) {
    std::vector<std::uint8_t> runs;
    for (int y = 0; y < faces.height(); ++y)
        for (int x = 0; x < faces.width(); ++x) {
            const auto value = static_cast<std::uint8_t>(
                std::lround(255 * std::clamp(faces.pixel(x, y)[3], 0.0F, 1.0F)));
            if (!runs.empty() && runs.back() == value && runs[runs.size() - 2] < 255)
                ++runs[runs.size() - 2];
            else
                runs.insert(runs.end(), {1, value});
        }
    return base64(runs);
}

std::string vectors_text(const std::vector<V3f>& vectors, float scale) {
    std::vector<std::int16_t> values;
    values.reserve(vectors.size() * 3);
    for (const V3f& v : vectors)
        for (const float part : {v.x, v.y, v.z})
            values.push_back(static_cast<std::int16_t>(
                std::lround(32767 * std::clamp(part / scale, -1.0F, 1.0F))));
    return base64(values);
}

template <class T>
std::string indices_text(const Mesh& mesh) {
    std::vector<T> values;
    values.reserve(mesh.triangles.size() * 3);
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t i : t) values.push_back(static_cast<T>(i));
    return base64(values);
}

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

/// A texel of a face or, outside of it, the nearest one.
const float* texel(const Image& face, int x, int y) {
    return face.pixel(std::clamp(x, 0, face.width() - 1), std::clamp(y, 0, face.height() - 1));
}

/// The mean, over a texel, of what is drawn bilinearly between the texels: along each axis
/// (c[-1] + 6 c[0] + c[1]) / 8.
float drawn(const Image& face, int x, int y, int channel) {
    constexpr float kWeights[] = {0.125F, 0.75F, 0.125F};
    float sum = 0;
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
            sum += kWeights[i] * kWeights[j] * texel(face, x + i - 1, y + j - 1)[channel];
    return sum;
}

/// Texels between which what is drawn has the means that a face holds: without, what is larger
/// than a pixel is blurred twice. They stay between those of their neighbours, so that lamps get no
/// dark rims.
Image sharpened(const Image& means) {
    constexpr int kRounds = 4;  // each leaves at most three quarters of what is wrong
    Image texels = means;
    for (int round = 0; round < kRounds; ++round) {
        const Image before = texels;
        for (int y = 0; y < means.height(); ++y)
            for (int x = 0; x < means.width(); ++x)
                for (int c = 0; c < 3; ++c) {
                    float low = means.pixel(x, y)[c], high = low;
                    for (int k = 0; k < 9; ++k) {
                        const float near = texel(means, x + k % 3 - 1, y + k / 3 - 1)[c];
                        low = std::min(low, near);
                        high = std::max(high, near);
                    }
                    texels.pixel(x, y)[c] = std::clamp(
                        before.pixel(x, y)[c] + means.pixel(x, y)[c] - drawn(before, x, y, c), low,
                        high);
                }
    }
    return texels;
}

/// The same for all faces of a column, each by itself.
void sharpen(Image& faces) {
    const int side = faces.width();
    const auto row = static_cast<std::ptrdiff_t>(side) * 4;
    for_each_band(6, 1, [&](int first, int last) {
        for (int f = first; f < last; ++f) {
            Image face({side, side}, 4);
            std::copy_n(faces.row(f * side), side * row, face.row(0));
            face = sharpened(face);
            std::copy_n(face.row(0), side * row, faces.row(f * side));
        }
    });
}

void replace_all(std::string& text, std::string_view mark, std::string_view by) {
    for (std::size_t at = text.find(mark); at != std::string::npos;
         at = text.find(mark, at + by.size()))
        text.replace(at, mark.size(), by);
}

}  // namespace

Image page_faces(const Environment& environment, const Image& map, const Layout& layout, int face,
                 const Image& confidence) {
    const Layout& opengl = *find_layout("faces-opengl");
    Image faces = resample(map_source(map, layout), opengl, face);
    if (!confidence.empty()) {
        ResampleOptions plain;
        plain.keeps_light = false;
        const Image believed = resample(map_source(confidence, layout), opengl, face, plain);
        for (int y = 0; y < faces.height(); ++y)
            for (int x = 0; x < faces.width(); ++x)
                faces.pixel(x, y)[3] *= std::clamp(believed.pixel(x, y)[0], 0.0F, 1.0F);
    }
    const Size size = faces.size();
    std::visit(
        [&](const auto& projection) {
            for_each_band(size.height, 16, [&](int first, int last) {
                for (int y = first; y < last; ++y)
                    for (int x = 0; x < size.width; ++x) {
                        const auto d = projection.to_direction(
                            Vec2<Dual>{Dual((x + 0.5) / size.width, 1.0 / size.width, 0),
                                       Dual((y + 0.5) / size.height, 0, 1.0 / size.height)});
                        const V3f light = environment.radiance(V3f(value_of(*d)),
                                                               V3f(V3d(d->x.du, d->y.du, d->z.du)),
                                                               V3f(V3d(d->x.dv, d->y.dv, d->z.dv)));
                        for (int c = 0; c < 3; ++c) faces.pixel(x, y)[c] = light[c];
                    }
            });
        },
        opengl.projection);
    sharpen(faces);
    return faces;
}

std::string page(const Image& faces, const Mesh& mesh, const PageOptions& options) {
    assert(faces.channels() == 4 && faces.width() == options.face);
    float scale = 0;
    for (const V3f& p : mesh.positions)
        scale = std::max({scale, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const bool wide = mesh.positions.size() > 65536;
    const std::string data = fmt::format(
        R"({{"face":{},"map":"{}","coverage":"{}","vertices":{},"triangles":{},"scale":{},)"
        R"("positions":"{}","normals":"{}","indices":"{}",)"
        R"("azimuth":{},"elevation":{},"distance":{},"fov":{}}})",
        options.face, map_text(faces), coverage_text(faces), mesh.positions.size(),
        mesh.triangles.size(), scale, vectors_text(mesh.positions, scale),
        vectors_text(mesh.normals, 1),
        wide ? indices_text<std::uint32_t>(mesh) : indices_text<std::uint16_t>(mesh),
        options.azimuth, options.elevation, options.distance, options.fov);
    std::string html(page_template());
    replace_all(html, "@TITLE@", escaped(options.title));
    replace_all(html, "@DATA@", data);
    return html;
}

}  // namespace chromeball
