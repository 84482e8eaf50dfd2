#include "render/preview.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "render/shapes.h"

namespace chromeball {
namespace {

constexpr int kBlock = 4;  // a packet of rays is a block of pixels, one sample each
constexpr int kTile = 32;
static_assert(kBlock * kBlock == RayPacket::kRays);

/// Sums over the samples of a block's pixels.
struct Block {
    float sum[RayPacket::kRays][4] = {};
    double mean[RayPacket::kRays] = {}, square[RayPacket::kRays] = {};  // of rounds, compressed
    int rounds = 0;
};

class Picture {
public:
    Picture(const Scene& scene, const Tracer& tracer, const Environment& environment,
            const View& view, const PreviewOptions& options)
        : tracer_(tracer),
          environment_(environment),
          view_(view),
          options_(options),
          shader_(scene, tracer, environment, options.shading, options.reflected) {
        if (options.shading == Shading::vertex) shader_.shade_vertices(view);
        const int rounds = options.noise > 0 ? options.most_rounds : 1;
        for (int i = 0; i < rounds; ++i)
            samples_.push_back(
                pixel_samples(options.filter, options.samples, static_cast<std::uint32_t>(i)));
    }

    std::size_t draw_tile(Image& out, int tile_x, int tile_y) const {
        std::size_t rays = 0;
        const int right = std::min(tile_x + kTile, out.width());
        const int bottom = std::min(tile_y + kTile, out.height());
        for (int y = tile_y; y < bottom; y += kBlock)
            for (int x = tile_x; x < right; x += kBlock) rays += draw_block(out, x, y);
        return rays;
    }

private:
    std::size_t draw_block(Image& out, int x, int y) const {
        Block block;
        for (const PixelSamples& samples : samples_) {
            add_round(block, samples, out.size(), x, y);
            if (options_.noise > 0 && settled(block)) break;
        }
        const float scale = 1 / static_cast<float>(block.rounds * options_.samples);
        for (int i = 0; i < RayPacket::kRays; ++i) {
            const int px = x + i % kBlock, py = y + i / kBlock;
            if (px >= out.width() || py >= out.height()) continue;
            for (int c = 0; c < 4; ++c) out.pixel(px, py)[c] = block.sum[i][c] * scale;
        }
        return static_cast<std::size_t>(block.rounds * options_.samples) * RayPacket::kRays;
    }

    void add_round(Block& block, const PixelSamples& samples, Size size, int x, int y) const {
        double round[RayPacket::kRays] = {};
        for (std::size_t k = 0; k < samples.offsets.size(); ++k) {
            Beam beams[RayPacket::kRays];
            RayPacket rays;
            for (int i = 0; i < RayPacket::kRays; ++i) {
                const int px = x + i % kBlock, py = y + i / kBlock;
                const Beam beam =
                    view_.beam(px + static_cast<double>(samples.offsets[k].x),
                               py + static_cast<double>(samples.offsets[k].y), samples.step);
                rays.start(i, beam.origin, beam.direction);
                if (px >= size.width || py >= size.height) rays.valid[i] = 0;
                if (options_.clip) clip(rays, i, beam);
                beams[i] = beam;
            }
            Hit hits[RayPacket::kRays];
            tracer_.intersect(rays, hits);
            const auto index = static_cast<std::uint32_t>(
                static_cast<std::size_t>(block.rounds * options_.samples) + k);
            for (int i = 0; i < RayPacket::kRays; ++i) {
                if (!hits[i] && !options_.background) continue;
                const int px = x + i % kBlock, py = y + i / kBlock;
                if (px >= size.width || py >= size.height) continue;
                const std::uint32_t pixel =
                    hashed(static_cast<std::uint32_t>(px) + hashed(static_cast<std::uint32_t>(py)));
                const V3f light =
                    hits[i] ? shader_.seen(beams[i], hits[i], {pixel, index, options_.samples})
                            : environment_.radiance(beams[i].direction, beams[i].direction_x,
                                                    beams[i].direction_y);
                for (int c = 0; c < 3; ++c) block.sum[i][c] += light[c];
                block.sum[i][3] += 1;
                const auto bright = static_cast<double>((light.x + light.y + light.z) / 3);
                round[i] += bright / (1 + bright);
            }
        }
        ++block.rounds;
        for (int i = 0; i < RayPacket::kRays; ++i) {
            const double value = round[i] / options_.samples;
            const double off = value - block.mean[i];
            block.mean[i] += off / block.rounds;
            block.square[i] += off * (value - block.mean[i]);
        }
    }

    /// Starts a ray where it comes through the plane; one that never does meets nothing.
    void clip(RayPacket& rays, int i, const Beam& beam) const {
        const V3d &n = options_.clip->normal, o(beam.origin), d(beam.direction);
        const double below = (options_.clip->point - o).dot(n), rise = d.dot(n);
        if (below <= 0) return;
        if (rise > 0)
            rays.from[i] = static_cast<float>(below / rise);
        else
            rays.valid[i] = 0;
    }

    /// Whether all pixels' means are known well enough.
    bool settled(const Block& block) const {
        constexpr int kFewest = 4;
        if (block.rounds < kFewest) return false;
        const double n = block.rounds;
        return std::all_of(std::begin(block.square), std::end(block.square), [&](double square) {
            return square / (n - 1) / n <= options_.noise * options_.noise;
        });
    }

    const Tracer& tracer_;
    const Environment& environment_;
    const View& view_;
    const PreviewOptions& options_;
    Shader shader_;
    std::vector<PixelSamples> samples_;
};

}  // namespace

Image preview(const Scene& scene, const Tracer& tracer, const Environment& environment,
              const View& view, const PreviewOptions& options, PreviewStatistics* statistics,
              const Watch& watch) {
    const Picture picture(scene, tracer, environment, view, options);
    Image out(view.size(), 4);
    const int across = (out.width() + kTile - 1) / kTile, down = (out.height() + kTile - 1) / kTile;
    std::atomic<std::size_t> rays = 0;
    for_each_band(
        across * down, 1,
        [&](int first, int last) {
            for (int i = first; i < last; ++i)
                rays += picture.draw_tile(out, i % across * kTile, i / across * kTile);
        },
        watch);
    if (statistics) statistics->camera_rays = rays;
    return out;
}

Scene with_meshes_only(Scene scene) {
    for (Object& object : scene.objects) {
        if (!object.ball) continue;
        // As coarse as models in scenes are.
        object.mesh = tessellated_sphere(64, 32);
        for (V3f& p : object.mesh.positions)
            p = V3f(object.ball->center + V3d(p) * object.ball->radius);
        object.ball.reset();
    }
    return scene;
}

}  // namespace chromeball
