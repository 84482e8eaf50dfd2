// What a shot cannot do without: the ball's rows of every frame decoded twice (once to find the
// ball, once to convert it) and a picture as large as a map encoded and written.
//
//     shot_floor PATTERN FIRST LAST ROW_FROM ROW_TO HEIGHT OUT_PATTERN
//
// One thread; CPU time is what counts. PATTERN: plates/p.####.exr.

#include <Imath/half.h>
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <string>

#include "core/image.h"
#include "io/read.h"
#include "io/threads.h"
#include "io/write.h"
#include "shot/pattern.h"

namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A map of a size, from the beginning of the rows, so that it compresses as pictures do.
chromeball::Image map_from(const chromeball::Photo& rows, int height) {
    chromeball::Image map({2 * height, height}, 4);
    const auto* values = reinterpret_cast<const Imath::half*>(rows.pixels.data());
    const std::size_t channels = static_cast<std::size_t>(rows.channels);
    const std::size_t count = rows.window.size.pixels();
    for (std::size_t i = 0; i < map.size().pixels(); ++i) {
        float* pixel = map.row(0) + 4 * i;
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = values[(i % count) * channels + c];
        pixel[3] = 1;
    }
    return map;
}

}  // namespace

int main(int count, char** words) {
    using namespace chromeball;
    if (count != 8) {
        fmt::print(stderr,
                   "usage: shot_floor PATTERN FIRST LAST ROW_FROM ROW_TO HEIGHT OUT_PATTERN\n");
        return 2;
    }
    const auto plates = FramePattern::parse(words[1]), maps = FramePattern::parse(words[7]);
    const int first = std::atoi(words[2]), last = std::atoi(words[3]);
    const std::pair rows{std::atoi(words[4]), std::atoi(words[5])};
    if (!plates || !maps || last < first) return 2;
    set_coding_threads(1);
    ReadOptions options;
    options.rows = rows;
    double decoding = 0, encoding = 0;
    for (int frame = first; frame <= last; ++frame) {
        const double start = cpu_seconds();
        read_photo(plates->path(frame), options);
        const Photo photo = read_photo(plates->path(frame), options);
        const double decoded = cpu_seconds();
        if (photo.type != PixelType::f16) return 1;
        write_image(maps->path(frame), map_from(photo, std::atoi(words[6])).view(), {});
        encoding += cpu_seconds() - decoded;
        decoding += decoded - start;
    }
    const double frames = last - first + 1;
    fmt::print("{{\"cpu_ms_decoding_twice\": {:.2f}, \"cpu_ms_encoding\": {:.2f}}}\n",
               1e3 * decoding / frames, 1e3 * encoding / frames);
}
