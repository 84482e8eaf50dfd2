#include "io/read.h"

#include <fmt/format.h>

#include <exception>
#include <new>

#include "io/decoders.h"
#include "io/messages.h"

namespace chromeball {
namespace {

Photo read(const std::string& path, const io::DecodeRequest& request) {
    const io::FileProbe probe = io::probe_file(path);
    try {
        if (probe.exr) return io::decode_exr(path, probe, request);
        if (probe.plugin == "png")
            if (auto photo = io::decode_png(path, probe, request)) return std::move(*photo);
        if (probe.plugin == "jpeg")
            if (auto photo = io::decode_jpeg(path, probe, request)) return std::move(*photo);
        return io::decode_with_oiio(path, probe, request);
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
    return read(path, {options.max_pixels, options.rows, true, nullptr});
}

Photo read_photo(const std::string& path, const ReadOptions& options) {
    Photo photo = read(path, {options.max_pixels, options.rows, false, options.bands});
    if (!options.bands || photo.pixels.empty()) return photo;
    options.bands(photo);
    photo.pixels = PixelBytes();
    return photo;
}

std::optional<Photo> read_channel(const std::string& path, const std::string& channel,
                                  const ReadOptions& options) {
    const io::FileProbe probe = io::probe_file(path);
    if (!probe.exr && probe.plugin != "tiff") return std::nullopt;
    Photo photo = read(path, {options.max_pixels, options.rows, false, nullptr, channel});
    if (photo.channels == 0) return std::nullopt;
    return photo;
}

}  // namespace chromeball
