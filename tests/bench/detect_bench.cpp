#include <benchmark/benchmark.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "core/parallel.h"
#include "detect/detect.h"
#include "io/read.h"
#include "io/write.h"

// What finding the ball costs in a 12-megapixel JPEG, decoding included, on one thread of a process
// that takes many, beside OpenCV's HoughCircles on the same picture at full size.

namespace chromeball {
namespace {

namespace fs = std::filesystem;

/// A JPEG of 4000x3000 pixels, written once: a photograph of the repository, cut to that shape and
/// enlarged.
const std::string& jpeg() {
    static const std::string path = [] {
        const Photo photo = read_photo(CHROMEBALL_DATA "/photos/city.jpg");
        const Size size = photo.window.size;
        const cv::Mat whole(size.height, size.width, CV_8UC3,
                            const_cast<std::byte*>(photo.pixels.data()));
        const int width = size.height * 4 / 3;
        cv::Mat large;
        cv::resize(whole(cv::Rect((size.width - width) / 2, 0, width, size.height)), large,
                   cv::Size(4000, 3000), 0, 0, cv::INTER_CUBIC);
        Image image({large.cols, large.rows}, 3);
        for (std::size_t i = 0; i < 3 * image.size().pixels(); ++i)
            image.row(0)[i] = static_cast<float>(large.data[i]) / 255;
        const fs::path file = fs::temp_directory_path() / "chromeball-bench.jpg";
        WriteOptions write;
        write.format = FileFormat::jpg;
        write.bits = 8;
        write_image(file.string(), image.view(), write);
        return file.string();
    }();
    return path;
}

/// Of the process since forget_peak(); 0 where the system does not tell.
double peak_mib() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (double kib = 0; word == "VmHWM:" && status >> kib) return kib / 1024;
    return 0;
}

void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

void decoding(benchmark::State& state) {
    const ThreadLimit one(1);
    jpeg();
    for (auto _ : state) benchmark::DoNotOptimize(read_photo(jpeg()).pixels.data());
}

void decoding_and_finding(benchmark::State& state) {
    const ThreadLimit one(1);
    double confidence = 0;
    jpeg();
    forget_peak();
    for (auto _ : state) {
        const auto balls = find_balls(read_photo(jpeg()));
        confidence = balls.empty() ? 0 : balls.front().confidence;
    }
    state.counters["confidence"] = confidence;
    state.counters["peak_MiB"] = peak_mib();
}

void decoding_and_hough_circles(benchmark::State& state) {
    cv::setNumThreads(1);
    std::size_t count = 0;
    for (auto _ : state) {
        const Photo photo = read_photo(jpeg());
        const cv::Mat rgb(photo.window.size.height, photo.window.size.width, CV_8UC3,
                          const_cast<std::byte*>(photo.pixels.data()));
        cv::Mat grey;
        cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
        cv::medianBlur(grey, grey, 5);
        std::vector<cv::Vec3f> circles;
        const int longest = std::max(grey.cols, grey.rows);
        cv::HoughCircles(grey, circles, cv::HOUGH_GRADIENT, 1, longest / 8.0, 150, 40,
                         longest * 3 / 100, longest * 6 / 10);
        count = circles.size();
    }
    state.counters["circles"] = static_cast<double>(count);
}

BENCHMARK(decoding)->Unit(benchmark::kMillisecond);
BENCHMARK(decoding_and_finding)->Unit(benchmark::kMillisecond);
// Takes its time.
BENCHMARK(decoding_and_hough_circles)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace chromeball
