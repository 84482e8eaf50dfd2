#include <benchmark/benchmark.h>

#include <cmath>

#include "core/parallel.h"
#include "resample/resample.h"

// What the resampler costs for a pixel of output: `items_per_second` is pixels. CPU time on one
// thread, into pixels that are there already, unless said otherwise.

namespace chromeball {
namespace {

/// A ball that fills a square of pixels; what they hold does not matter for speed.
Image ball_photo(int diameter) {
    Image photo({diameter, diameter}, 3);
    for (int y = 0; y < diameter; ++y)
        for (int x = 0; x < diameter; ++x) photo.pixel(x, y)[x % 3] = static_cast<float>(y);
    return photo;
}

/// distance 0: distant. A near ball stands `off` pixels right of the picture's middle.
MirrorBall ball(int diameter, double distance, double off = 0) {
    const double r = 0.5 * diameter;
    const Outline outline{r, r, r, r, 0};
    if (distance == 0) return MirrorBall(outline);
    Camera camera;
    camera.principal = V2d(r - off, r);
    camera.focal = r * std::sqrt(distance * distance - 1);
    return {camera, cone_of(outline, camera)};
}

void draw(benchmark::State& state, const Source& source, const Layout& layout, Filter filter) {
    const auto size = static_cast<int>(state.range(1));
    ResampleOptions options;
    options.filter = filter;
    Image map(layout.picture(size), 4);
    resample(source, layout, map.view(), options);  // its pages are the system's until then
    std::int64_t pixels = 0;
    for (auto _ : state) {
        resample(source, layout, map.view(), options);
        benchmark::DoNotOptimize(map.row(0));
        pixels += static_cast<std::int64_t>(map.size().pixels());
    }
    state.SetItemsProcessed(pixels);
}

/// Arguments: diameter of the ball, size of the map.
void convert(benchmark::State& state, const char* layout, Filter filter, double distance,
             double off) {
    const ThreadLimit one(1);
    const auto diameter = static_cast<int>(state.range(0));
    draw(state, ball_source(ball_photo(diameter), ball(diameter, distance, off), {}),
         *find_layout(layout), filter);
}

/// Wall time on so many threads.
void threads(benchmark::State& state, int count) {
    const ThreadLimit limit(count);
    const auto diameter = static_cast<int>(state.range(0));
    draw(state, ball_source(ball_photo(diameter), ball(diameter, 0), {}), *find_layout("openexr"),
         Filter::adaptive);
}

void from_map(benchmark::State& state, const char* from, const char* to) {
    const ThreadLimit one(1);
    const Layout& layout = *find_layout(from);
    const Image map(layout.picture(static_cast<int>(state.range(0))), 3);
    draw(state, map_source(map, layout), *find_layout(to), Filter::adaptive);
}

void prepare(benchmark::State& state) {
    const ThreadLimit one(1);
    const auto diameter = static_cast<int>(state.range(0));
    const Image photo = ball_photo(diameter);
    for (auto _ : state) {
        const Source source = ball_source(photo, ball(diameter, 0), {});
        benchmark::DoNotOptimize(source.pixels.row(0));
    }
    state.SetItemsProcessed(state.iterations() * diameter * diameter);
}

using Sizes = std::vector<std::int64_t>;

BENCHMARK_CAPTURE(convert, faces, "openexr", Filter::adaptive, 0, 0)
    ->Args({2048, 1024})
    ->Args({2048, 512});
BENCHMARK_CAPTURE(convert, faces_fast, "openexr", Filter::fast, 0, 0)->Args({2048, 1024});
BENCHMARK_CAPTURE(convert, faces_near, "openexr", Filter::adaptive, 10, 0)->Args({2048, 1024});
BENCHMARK_CAPTURE(convert, faces_off_axis, "openexr", Filter::adaptive, 6, 4000)
    ->Args({2048, 1024});
BENCHMARK_CAPTURE(convert, latlong, "latlong", Filter::adaptive, 0, 0)
    ->Args({2048, 1024})
    ->Args({512, 512});
// Growth: faces as fine as the ball; one ball and all faces; all balls and one size of faces.
BENCHMARK_CAPTURE(convert, growth_of_both, "openexr", Filter::adaptive, 0, 0)
    ->Args({200, 100})
    ->Args({512, 256})
    ->Args({1024, 512})
    ->Args({2048, 1024})
    ->Args({4000, 2000});
BENCHMARK_CAPTURE(convert, growth_of_faces, "openexr", Filter::adaptive, 0, 0)
    ->ArgsProduct({Sizes{2048}, Sizes{256, 512, 1024, 2048, 4096}});
BENCHMARK_CAPTURE(convert, growth_of_balls, "openexr", Filter::adaptive, 0, 0)
    ->ArgsProduct({Sizes{200, 500, 1000, 2000, 4000}, Sizes{1024}});
BENCHMARK_CAPTURE(threads, one, 1)->Args({2048, 1024})->UseRealTime();
BENCHMARK_CAPTURE(threads, two, 2)->Args({2048, 1024})->UseRealTime();
BENCHMARK_CAPTURE(from_map, latlong_to_faces, "latlong", "openexr")->Args({1024, 512});
BENCHMARK_CAPTURE(from_map, faces_to_latlong, "openexr", "latlong")->Args({512, 1024});
BENCHMARK(prepare)->Arg(512)->Arg(2048)->Arg(4000);

}  // namespace
}  // namespace chromeball
