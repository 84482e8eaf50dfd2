#pragma once

#include <functional>

#include "map/layouts.h"
#include "resample/source.h"
#include "support/balls.h"

namespace chromeball {

/// The light that comes from a direction.
using World = std::function<V3d(V3d)>;

/// Directions as colours: rgb = (d + 1) / 2.
inline V3d direction_as_color(V3d d) { return (d + V3d(1, 1, 1)) * 0.5; }
/// And back, of a pixel whose colour is multiplied by alpha.
inline V3d color_as_direction(const float* rgba) {
    const double scale = 2.0 / static_cast<double>(rgba[3]);
    return V3d(rgba[0] * scale - 1, rgba[1] * scale - 1, rgba[2] * scale - 1).normalized();
}

/// Smooth, with second-degree terms; its mean over the sphere is 1 in every channel.
inline V3d smooth_world(V3d d) {
    return {1 + 0.5 * d.x * d.y + 0.3 * d.z, 1 + 0.6 * d.y * d.z - 0.2 * d.x,
            1 + 0.75 * (d.z * d.z - 1.0 / 3) + 0.25 * d.y};
}

/// The picture that a projection gives of a world, 4 channels, alpha 1: every pixel the mean of
/// samples x samples points, those without a direction in the colour of the background.
template <class P>
Image painted(const P& projection, Size size, const Affine& from_pixels, const World& world,
              V3d background = V3d(0, 0, 0), int samples = 4) {
    Image image(size, 4);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            V3d sum(0, 0, 0);
            for (int k = 0; k < samples * samples; ++k) {
                const V2d p = from_pixels(
                    V2d(x + (k % samples + 0.5) / samples, y + (k / samples + 0.5) / samples));
                const auto d = projection.to_direction(p);
                sum += d ? world(*d) : background;
            }
            float* pixel = image.pixel(x, y);
            for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(sum[c] / (samples * samples));
            pixel[3] = 1;
        }
    return image;
}

/// An environment map of a world.
inline Image painted_map(const Layout& layout, int size, const World& world) {
    const Size picture = layout.picture(size);
    return std::visit(
        [&](const auto& projection) {
            return painted(projection, picture, scale(1.0 / picture.width, 1.0 / picture.height),
                           world);
        },
        layout.projection);
}

/// The part of a photo that shows a ball, with a margin.
struct BallPhoto {
    MirrorBall ball;
    Window window;
    Image pixels;

    BallPhoto(const MirrorBall& b, const World& world, V3d background = V3d(0, 0, 0))
        : ball(b), window(needed_window(b.outline(), {-100000, -100000, {200000, 200000}})) {
        pixels = painted(ball, window.size, to_pixels().inverse(), world, background);
    }
    Affine to_pixels() const { return shift(-window.x, -window.y); }
    Source source(double rim_blur = 0) const {
        return ball_source(pixels, ball, to_pixels(), rim_blur);
    }
};

/// What a pixel of a map shows: the mean over its middle and around it.
struct Shown {
    std::optional<V3d> direction;  ///< of the pixel's middle
    V3d color{0, 0, 0};            ///< mean over those parts that have directions
    double solid_angle = 0;
    bool whole = true;  ///< all of it has directions
};

inline Shown shown_by_pixel(const Layout& layout, Size size, int x, int y, const World& world) {
    return std::visit(
        [&](const auto& projection) {
            constexpr int kSamples = 4;
            Shown shown;
            const auto at = [&](double dx, double dy) {
                return V2d((x + dx) / size.width, (y + dy) / size.height);
            };
            shown.direction = projection.to_direction(at(0.5, 0.5));
            int count = 0;
            for (int k = 0; k < kSamples * kSamples; ++k) {
                const V2d p = at((k % kSamples + 0.5) / kSamples, (k / kSamples + 0.5) / kSamples);
                const auto d = projection.to_direction(p);
                if (!d) continue;
                ++count;
                shown.color += world(*d);
                shown.solid_angle += projection.solid_angle(p);
            }
            shown.whole = count == kSamples * kSamples;
            if (count > 0) shown.color /= count;
            const double area = static_cast<double>(size.width) * size.height;
            shown.solid_angle /= kSamples * kSamples * area;
            return shown;
        },
        layout.projection);
}

/// What a map holds over the sphere.
struct Energy {
    V3d light{0, 0, 0};  ///< integral of radiance
    double covered = 0;  ///< steradians
    V3d mean() const { return light / covered; }
};

inline Energy energy_of(const Image& map, const Layout& layout) {
    Energy energy;
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const float* p = map.pixel(x, y);
            if (p[3] == 0) continue;
            // A pixel that is partly outside the picture has that part in its alpha: the solid
            // angle per area is that of the parts inside.
            const Shown shown =
                shown_by_pixel(layout, map.size(), x, y, [](V3d) { return V3d(1, 1, 1); });
            energy.light += V3d(p[0], p[1], p[2]) * shown.solid_angle;
            energy.covered += p[3] * shown.solid_angle;
        }
    return energy;
}

}  // namespace chromeball
