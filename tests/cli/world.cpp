#include "cli/world.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <vector>

#include "io/write.h"

namespace chromeball::test {
namespace {

float encoded_srgb(float linear) {
    const float v = std::clamp(linear, 0.0F, 1.0F);
    return v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
}

void write_plain_exr(const std::string& path, const Image& image,
                     const std::vector<std::string>& channels) {
    OIIO::ImageSpec spec(image.width(), image.height(), image.channels(), OIIO::TypeDesc::FLOAT);
    spec.channelnames = channels;
    spec.alpha_channel = -1;
    const auto output = OIIO::ImageOutput::create("openexr");
    if (!output || !output->open(path, spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, image.row(0)) || !output->close())
        throw std::runtime_error(path + " cannot be painted");
}

}  // namespace

V3d world_color(V3d direction) { return (direction + V3d(1)) * 0.5; }

Image ball_photo(Size size, const MirrorBall& ball, double background) {
    constexpr int kSide = 3;
    Image photo(size, 3);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            V3d sum(0);
            for (int i = 0; i < kSide * kSide; ++i) {
                const auto d = ball.to_direction(
                    V2d(x + (i % kSide + 0.5) / kSide, y + (i / kSide + 0.5) / kSide));
                sum += d ? world_color(*d) : V3d(background);
            }
            for (int c = 0; c < 3; ++c)
                photo.pixel(x, y)[c] = static_cast<float>(sum[c] / (kSide * kSide));
        }
    return photo;
}

MirrorBall distant_ball(double cx, double cy, double r) {
    return MirrorBall(Outline{cx, cy, r, r, 0});
}

MirrorBall near_ball(Size photo, V3d axis, double distance, double focal) {
    Camera camera;
    camera.focal = focal;
    camera.principal = V2d(0.5 * photo.width, 0.5 * photo.height);
    return MirrorBall(camera, Cone{axis.normalized(), std::asin(1 / distance)});
}

void write_exr(const std::string& path, const Image& image, const Metadata& metadata) {
    WriteOptions options;
    options.full_float = true;
    options.metadata = metadata;
    write_image(path, image.view(), options);
}

void write_unrepaired_exr(const std::string& path, const Image& image) {
    write_plain_exr(path, image, {"R", "G", "B"});
}

void write_grey_alpha(const std::string& path, const Image& image) {
    Image two(image.size(), 2);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            two.pixel(x, y)[0] = image.pixel(x, y)[0];
            two.pixel(x, y)[1] = image.pixel(x, y)[3];
        }
    write_plain_exr(path, two, {"Y", "A"});
}

void write_picture(const std::string& path, const Image& image) {
    Image encoded = image;
    for (int y = 0; y < image.height(); ++y)
        for (int i = 0; i < image.width() * image.channels(); ++i)
            encoded.row(y)[i] = encoded_srgb(image.row(y)[i]);
    write_encoded(path, encoded);
}

void write_encoded(const std::string& path, const Image& encoded) {
    WriteOptions options;
    options.format = *format_from_extension(std::filesystem::path(path).extension().string());
    options.bits = 8;
    write_image(path, encoded.view(), options);
}

Image shrunk(const Image& image, int factor) {
    Image small({image.width() / factor, image.height() / factor}, image.channels());
    const auto channels = static_cast<std::size_t>(image.channels());
    for (int y = 0; y < small.height() * factor; ++y)
        for (int x = 0; x < small.width() * factor; ++x)
            for (std::size_t c = 0; c < channels; ++c)
                small.pixel(x / factor, y / factor)[c] +=
                    image.pixel(x, y)[c] / static_cast<float>(factor * factor);
    return small;
}

Image world_map(const Layout& layout, int size) {
    Image map(layout.picture(size), 4);
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const V2d p((x + 0.5) / map.width(), (y + 0.5) / map.height());
            const auto d = std::visit([&](const auto& shape) { return shape.to_direction(p); },
                                      layout.projection);
            if (!d) continue;
            const V3d color = world_color(d->normalized());
            for (int c = 0; c < 3; ++c) map.pixel(x, y)[c] = static_cast<float>(color[c]);
            map.pixel(x, y)[3] = 1;
        }
    return map;
}

Image read_floats(const std::string& path) {
    const OIIO::ImageSpec as_stored = [] {
        OIIO::ImageSpec spec;
        spec["oiio:UnassociatedAlpha"] = 1;
        return spec;
    }();
    const auto input = OIIO::ImageInput::open(path, &as_stored);
    if (!input) throw std::runtime_error(OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    Image image({spec.width, spec.height}, spec.nchannels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.row(0)))
        throw std::runtime_error(input->geterror());
    return image;
}

Difference difference(const Image& map, const Layout& layout, const Rotation& camera_to_output,
                      double lowest_z) {
    const Rotation back = camera_to_output.inverse();
    Difference result;
    double alpha_sum = 0, directed = 0;
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const V2d p((x + 0.5) / map.width(), (y + 0.5) / map.height());
            const auto d = std::visit([&](const auto& shape) { return shape.to_direction(p); },
                                      layout.projection);
            if (!d) continue;
            const float* v = map.pixel(x, y);
            const double alpha = map.channels() > 3 ? static_cast<double>(v[3]) : 1;
            alpha_sum += alpha;
            ++directed;
            if (alpha < 0.99) continue;
            const V3d seen = back * d->normalized();
            if (seen.z < lowest_z) continue;
            const V3d color = world_color(seen);
            for (int c = 0; c < 3; ++c)
                result.worst = std::max(result.worst, std::abs(v[c] - color[c]));
            ++result.compared;
        }
    result.covered = directed > 0 ? alpha_sum / directed : 0;
    return result;
}

double largest_difference(const Image& a, const Image& b) {
    if (a.size() != b.size() || a.channels() != b.channels())
        return std::numeric_limits<double>::infinity();
    double worst = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int i = 0; i < a.width() * a.channels(); ++i)
            worst = std::max(worst, std::abs(static_cast<double>(a.row(y)[i]) - b.row(y)[i]));
    return worst;
}

}  // namespace chromeball::test
