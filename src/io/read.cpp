#include "io/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <new>

#include "io/decoders.h"
#include "io/messages.h"

namespace chromeball {
namespace io {

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

}  // namespace io

namespace {

Photo read(const std::string& path, const io::DecodeRequest& request) {
    const io::FileProbe probe = io::probe_file(path);
    try {
        return probe.exr ? io::decode_exr(path, probe, request)
                         : io::decode_with_oiio(path, probe, request);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw io::failure(path,
                          "not enough memory for its pixels; lower --max-pixels to refuse "
                          "such files or use a machine with more");
    } catch (const std::exception& e) {
        throw io::failure(path,
                          fmt::format("cannot be read: {}; copy or export it again", e.what()));
    }
}

}  // namespace

Photo read_header(const std::string& path, const ReadOptions& options) {
    return read(path, {options.max_pixels, options.rows, true});
}

Photo read_photo(const std::string& path, const ReadOptions& options) {
    return read(path, {options.max_pixels, options.rows, false});
}

}  // namespace chromeball
