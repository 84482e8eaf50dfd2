#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/parallel.h"
#include "map/layouts.h"
#include "render/preview.h"
#include "render/shapes.h"
#include "render/tracer.h"

// A mirror bean of 100 000 triangles at 1280x720, four samples a pixel. `items_per_second` is
// camera rays; the argument is threads, times are the clock's.

namespace chromeball {
namespace {

constexpr Size kSize{1280, 720};
constexpr int kSamples = 4, kSide = 2;
constexpr int kBlock = 4;  // a packet's pixels, across and down

Image map() {
    const Layout& layout = *find_layout("latlong");
    Image pixels(layout.picture(1024), 4);
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x)
            for (int c = 0; c < 4; ++c)
                pixels.pixel(x, y)[c] =
                    c == 3 ? 1.0F : static_cast<float>((x / 32 + y / 32 + c) % 3);
    return pixels;
}

Scene bean(Material::Kind kind = Material::Kind::mirror) {
    Scene scene;
    scene.objects.push_back({"bean", *shape("bean"), std::nullopt, {.kind = kind}});
    return scene;
}

View camera() { return View::orbit(kSize, 30, 15, 4, 35); }

constexpr std::int64_t rays() {
    return static_cast<std::int64_t>(kSize.width) * kSize.height * kSamples;
}

/// All of the picture's rays for one of its samples, in packets of 4 x 4 pixels.
std::vector<RayPacket> packets(const View& view, int sample) {
    std::vector<RayPacket> all;
    const double off_x = (sample % kSide + 0.5) / kSide, off_y = (sample / kSide + 0.5) / kSide;
    for (int y = 0; y < kSize.height; y += kBlock)
        for (int x = 0; x < kSize.width; x += kBlock) {
            RayPacket& p = all.emplace_back();
            for (int i = 0; i < RayPacket::kRays; ++i) {
                const Beam beam = view.beam(x + i % kBlock + off_x, y + i / kBlock + off_y, 1);
                p.start(i, beam.origin, beam.direction);
            }
        }
    return all;
}

void render(benchmark::State& state, Shading shading, Material::Kind kind) {
    const ThreadLimit limit(static_cast<int>(state.range(0)));
    const Scene scene = bean(kind);
    const Tracer tracer(scene);
    const Environment environment(map(), *find_layout("latlong"));
    const View view = camera();
    PreviewOptions options;
    options.shading = shading;
    options.samples = kSamples;
    for (auto _ : state) {
        const Image picture = preview(scene, tracer, environment, view, options);
        benchmark::DoNotOptimize(picture.row(0));
    }
    state.SetItemsProcessed(state.iterations() * rays());
}

/// All that happens once the mesh and the map are in memory.
void after_load(benchmark::State& state) {
    const ThreadLimit limit(static_cast<int>(state.range(0)));
    const Scene scene = bean();
    const Image pixels = map();
    const View view = camera();
    PreviewOptions options;
    options.samples = kSamples;
    for (auto _ : state) {
        const Tracer tracer(scene);
        const Environment environment(pixels, *find_layout("latlong"));
        const Image picture = preview(scene, tracer, environment, view, options);
        benchmark::DoNotOptimize(picture.row(0));
    }
    state.SetItemsProcessed(state.iterations() * rays());
}

void build(benchmark::State& state) {
    const ThreadLimit limit(static_cast<int>(state.range(0)));
    const Scene scene = bean();
    for (auto _ : state) benchmark::DoNotOptimize(Tracer(scene));
}

void map_levels(benchmark::State& state) {
    const ThreadLimit limit(static_cast<int>(state.range(0)));
    const Image pixels = map();
    for (auto _ : state) {
        const Environment environment(pixels, *find_layout("latlong"));
        benchmark::DoNotOptimize(&environment);
    }
}

/// The layer's own door to Embree.
void tracer(benchmark::State& state) {
    const ThreadLimit limit(static_cast<int>(state.range(0)));
    const Scene scene = bean();
    const Tracer tracer(scene);
    const auto all = packets(camera(), 0);
    for (auto _ : state)
        for (int s = 0; s < kSamples; ++s)
            for_each_band(static_cast<int>(all.size()), 320, [&](int first, int last) {
                Hit hits[RayPacket::kRays];
                for (int i = first; i < last; ++i) {
                    tracer.intersect(all[static_cast<std::size_t>(i)], hits);
                    benchmark::DoNotOptimize(hits);
                }
            });
    state.SetItemsProcessed(state.iterations() * rays());
}

/// The same scene for Embree alone.
class Bare {
public:
    Bare() {
        const Mesh mesh = bean().objects[0].mesh;
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        void* positions =
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    sizeof(V3f), mesh.positions.size());
        std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<V3f*>(positions));
        void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                  RTC_FORMAT_UINT3, 12, mesh.triangles.size());
        std::copy(mesh.triangles.begin(), mesh.triangles.end(),
                  static_cast<std::array<std::uint32_t, 3>*>(triangles));
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_.get(), geometry);
        rtcReleaseGeometry(geometry);
        // As the layer builds it.
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene_.get());
    }
    RTCScene scene() const { return scene_.get(); }

private:
    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };
    std::unique_ptr<RTCDeviceTy, Release> device_{rtcNewDevice("set_affinity=0")};
    std::unique_ptr<RTCSceneTy, Release> scene_{rtcNewScene(device_.get())};
};

RTCIntersectContext coherent() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
}

/// Packets that are filled already; each is copied first, since Embree writes into it.
void bare_packets(benchmark::State& state) {
    const ThreadLimit limit(static_cast<int>(state.range(0)));
    const Bare bare;
    std::vector<RTCRayHit16> all;
    for (const RayPacket& p : packets(camera(), 0)) {
        RTCRayHit16& to = all.emplace_back();
        std::copy_n(p.ox, 16, to.ray.org_x);
        std::copy_n(p.oy, 16, to.ray.org_y);
        std::copy_n(p.oz, 16, to.ray.org_z);
        std::copy_n(p.dx, 16, to.ray.dir_x);
        std::copy_n(p.dy, 16, to.ray.dir_y);
        std::copy_n(p.dz, 16, to.ray.dir_z);
        std::fill_n(to.ray.tnear, 16, 0.0F);
        std::fill_n(to.ray.tfar, 16, std::numeric_limits<float>::infinity());
        std::fill_n(to.ray.time, 16, 0.0F);
        std::fill_n(to.ray.mask, 16, ~0U);
        std::fill_n(to.ray.flags, 16, 0U);
        std::fill_n(to.hit.geomID, 16, RTC_INVALID_GEOMETRY_ID);
        std::fill_n(to.hit.instID[0], 16, RTC_INVALID_GEOMETRY_ID);
    }
    alignas(64) std::int32_t valid[16];
    std::fill_n(valid, 16, -1);
    for (auto _ : state)
        for (int s = 0; s < kSamples; ++s)
            for_each_band(static_cast<int>(all.size()), 320, [&](int first, int last) {
                RTCIntersectContext context = coherent();
                for (int i = first; i < last; ++i) {
                    RTCRayHit16 one = all[static_cast<std::size_t>(i)];
                    rtcIntersect16(valid, bare.scene(), &context, &one);
                    benchmark::DoNotOptimize(one);
                }
            });
    state.SetItemsProcessed(state.iterations() * rays());
}

std::vector<RTCRayHit> single_rays() {
    std::vector<RTCRayHit> all;
    for (const RayPacket& p : packets(camera(), 0))
        for (int i = 0; i < RayPacket::kRays; ++i) {
            RTCRayHit& to = all.emplace_back();
            to.ray.org_x = p.ox[i];
            to.ray.org_y = p.oy[i];
            to.ray.org_z = p.oz[i];
            to.ray.dir_x = p.dx[i];
            to.ray.dir_y = p.dy[i];
            to.ray.dir_z = p.dz[i];
            to.ray.tfar = std::numeric_limits<float>::infinity();
            to.ray.mask = ~0U;
            to.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            to.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        }
    return all;
}

/// Rays one by one (0), or as a stream of 1024 (1).
void bare_rays(benchmark::State& state, bool stream) {
    const ThreadLimit limit(static_cast<int>(state.range(0)));
    const Bare bare;
    const auto all = single_rays();
    for (auto _ : state)
        for (int s = 0; s < kSamples; ++s)
            for_each_band(static_cast<int>(all.size() / 1024), 5, [&](int first, int last) {
                RTCIntersectContext context = coherent();
                std::vector<RTCRayHit> some(1024);
                for (int i = first; i < last; ++i) {
                    std::copy_n(all.begin() + std::ptrdiff_t{1024} * i, 1024, some.begin());
                    if (stream)
                        rtcIntersect1M(bare.scene(), &context, some.data(), 1024,
                                       sizeof(RTCRayHit));
                    else
                        for (RTCRayHit& one : some) rtcIntersect1(bare.scene(), &context, &one);
                    benchmark::DoNotOptimize(some.data());
                }
            });
    state.SetItemsProcessed(state.iterations() * rays());
}

#define ON_ONE_AND_TWO_THREADS(bench) \
    bench->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond)
ON_ONE_AND_TWO_THREADS(BENCHMARK_CAPTURE(bare_rays, one_by_one, false));
ON_ONE_AND_TWO_THREADS(BENCHMARK_CAPTURE(bare_rays, stream, true));
ON_ONE_AND_TWO_THREADS(BENCHMARK(bare_packets));
ON_ONE_AND_TWO_THREADS(BENCHMARK(tracer));
ON_ONE_AND_TWO_THREADS(BENCHMARK_CAPTURE(render, flat, Shading::pixel, Material::Kind::flat));
ON_ONE_AND_TWO_THREADS(BENCHMARK_CAPTURE(render, mirror, Shading::pixel, Material::Kind::mirror));
ON_ONE_AND_TWO_THREADS(BENCHMARK_CAPTURE(render, mirror_raytrace, Shading::raytrace,
                                         Material::Kind::mirror));
ON_ONE_AND_TWO_THREADS(BENCHMARK(after_load));
ON_ONE_AND_TWO_THREADS(BENCHMARK(build));
ON_ONE_AND_TWO_THREADS(BENCHMARK(map_levels));
#undef ON_ONE_AND_TWO_THREADS

}  // namespace
}  // namespace chromeball
