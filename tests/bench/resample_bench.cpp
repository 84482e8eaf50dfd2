#include <benchmark/benchmark.h>

#include "core/parallel.h"
#include "resample/resample.h"

// What the resampler costs for a pixel of output, on one thread: `items_per_second` is pixels.

namespace chromeball {
namespace {

/// A ball that fills a square of pixels; what they hold does not matter for speed.
Image ball_photo(int diameter) {
    Image photo({diameter, diameter}, 3);
    for (int y = 0; y < diameter; ++y)
        for (int x = 0; x < diameter; ++x) photo.pixel(x, y)[x % 3] = static_cast<float>(y);
    return photo;
}

MirrorBall ball(int diameter, double distance) {
    const double r = 0.5 * diameter;
    const Outline outline{r, r, r, r, 0};
    if (distance == 0) return MirrorBall(outline);
    const Camera camera{focal_from_distance(outline, V2d(r, r), distance), V2d(r, r)};
    return {camera, cone_of(outline, camera)};
}

void convert(benchmark::State& state, const char* layout, Filter filter, double distance) {
    const ThreadLimit one(1);
    const auto diameter = static_cast<int>(state.range(0)), size = static_cast<int>(state.range(1));
    const Source source = ball_source(ball_photo(diameter), ball(diameter, distance), {});
    ResampleOptions options;
    options.filter = filter;
    std::int64_t pixels = 0;
    for (auto _ : state) {
        const Image map = resample(source, *find_layout(layout), size, options);
        benchmark::DoNotOptimize(map.row(0));
        pixels += static_cast<std::int64_t>(map.size().pixels());
    }
    state.SetItemsProcessed(pixels);
}

void prepare(benchmark::State& state) {
    const auto diameter = static_cast<int>(state.range(0));
    const Image photo = ball_photo(diameter);
    for (auto _ : state) {
        const Source source = ball_source(photo, ball(diameter, 0), {});
        benchmark::DoNotOptimize(source.pixels.row(0));
    }
    state.SetItemsProcessed(state.iterations() * diameter * diameter);
}

const std::vector<std::vector<std::int64_t>> kSizes{{512, 2048}, {256, 512}};  // diameters, sizes

BENCHMARK_CAPTURE(convert, faces_adaptive, "openexr", Filter::adaptive, 0)->ArgsProduct(kSizes);
BENCHMARK_CAPTURE(convert, faces_fast, "openexr", Filter::fast, 0)->ArgsProduct(kSizes);
BENCHMARK_CAPTURE(convert, near_faces_adaptive, "openexr", Filter::adaptive, 10)
    ->ArgsProduct(kSizes);
BENCHMARK_CAPTURE(convert, latlong_adaptive, "latlong", Filter::adaptive, 0)->ArgsProduct(kSizes);
BENCHMARK(prepare)->Arg(2048);

}  // namespace
}  // namespace chromeball
