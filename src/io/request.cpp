#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "io/decoders.h"
#include "io/messages.h"

// What every decoder asks of a file. Apart from read.cpp, so that a module needs no more than this.

namespace chromeball::io {

void check_size(const std::string& path, std::int64_t width, std::int64_t height,
                std::int64_t max_pixels) {
    if (width <= 0 || height <= 0)
        throw failure(path,
                      fmt::format("claims {}x{} pixels: damaged; export it again", width, height));
    // Dividing, as the product may overflow. No side may exceed an int with room for sums.
    constexpr std::int64_t kLongestSide = std::numeric_limits<int>::max() / 16;
    if (width > kLongestSide || height > kLongestSide || height > max_pixels / width)
        throw failure(path,
                      fmt::format("{}x{} pixels are more than the {} allowed; raise --max-pixels",
                                  width, height, max_pixels));
}

std::pair<int, int> wanted_rows(const Window& stored,
                                const std::optional<std::pair<int, int>>& rows) {
    const std::pair<int, int> all{stored.y, stored.y + stored.size.height};
    if (!rows) return all;
    const int first = std::clamp(rows->first, all.first, all.second);
    return {first, std::clamp(rows->second, first, all.second)};
}

Photo band_of(const Photo& photo, int first, int last) {
    Photo band;
    band.name = photo.name;
    band.type = photo.type;
    band.channels = photo.channels;
    band.window = photo.window;
    band.window.y = first;
    band.window.size.height = last - first;
    band.display = photo.display;
    band.associated_alpha = photo.associated_alpha;
    band.pixels.resize(band.window.size.pixels() * bytes_per_value(band.type) *
                       static_cast<std::size_t>(band.channels));
    return band;
}

}  // namespace chromeball::io
