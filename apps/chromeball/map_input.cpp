#include "map_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "color/pixels.h"
#include "core/error.h"
#include "core/names.h"
#include "io/facts.h"
#include "io/read.h"
#include "map_files.h"
#include "map_job.h"
#include "photo_job.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

/// A map that chromeball wrote as something else than it is now told to be; nothing where it fits.
std::optional<std::string> misfit(const Photo& photo, const Layout& layout) {
    const auto past = provenance_from(photo.metadata);
    if (!past || past->layout.empty() || past->layout == layout.name) return std::nullopt;
    const auto is_column = [](std::string_view name) {
        return name == "openexr" || name == "strip-v" || name == "faces";
    };
    if (is_column(past->layout) && is_column(layout.name)) return std::nullopt;
    return fmt::format("{}: was written as {}, but is read as {}", photo.name, past->layout,
                       layout.name);
}

/// One file, decoded; its space and warnings go to `input`.
Image decoded(const std::string& path, const Layout& layout, std::int64_t max_pixels,
              const ColorConfig& colors, const std::optional<std::string>& space, MapInput& input) {
    const Photo photo = read_photo(path, {max_pixels, std::nullopt});
    if (!photo.damage.empty()) input.warnings.push_back(damage_warning(photo));
    std::string warning;
    input.space = colors.input_space(photo, space, &warning);
    if (!warning.empty()) input.warnings.push_back(warning);
    // Of six faces the first one tells.
    if (auto note = misfit(photo, layout); note && input.metadata.all().empty())
        input.warnings.push_back(std::move(*note));
    std::size_t bad = 0;
    Image pixels = colors.to_working(photo, input.space, std::nullopt, &bad);
    input.bad_pixels += bad;
    input.metadata = pass_through(photo.metadata);
    return pixels;
}

Image with_alpha(const Image& pixels) {
    if (pixels.channels() == 4) return pixels;
    Image out(pixels.size(), 4);
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x) {
            std::copy_n(pixels.pixel(x, y), 3, out.pixel(x, y));
            out.pixel(x, y)[3] = 1;
        }
    return out;
}

Image joined_faces(const std::string& folder, const Layout& layout, std::int64_t max_pixels,
                   const ColorConfig& colors, const std::optional<std::string>& space,
                   MapInput& input) {
    const auto files = faces_in(folder);
    if (!files)
        throw Error(
            Error::Kind::failed,
            fmt::format("{}: no six faces in it; files named px nx py ny pz nz, posx ..., or right "
                        "left top bottom front back are looked for",
                        folder));
    Image column;
    for (int face = 0; face < 6; ++face) {
        const std::string& file = (*files)[static_cast<std::size_t>(face)];
        const Image pixels = with_alpha(decoded(file, layout, max_pixels, colors, space, input));
        if (face == 0) column = Image({pixels.width(), 6 * pixels.width()}, 4);
        if (pixels.size() != Size{column.width(), column.width()})
            throw Error(
                Error::Kind::failed,
                fmt::format("{}: {}x{} pixels, but a face must be square and as large as {}, which "
                            "is {} wide",
                            file, pixels.width(), pixels.height(), files->front(), column.width()));
        std::copy_n(pixels.row(0),
                    static_cast<std::ptrdiff_t>(pixels.width()) * pixels.height() * 4,
                    column.row(face * column.width()));
    }
    return column;
}

/// The six faces' confidence; empty where one has none.
Image joined_confidence(const std::string& folder, Size column, std::int64_t max_pixels) {
    Image all(column, 3);
    const auto files = faces_in(folder);
    for (std::size_t face = 0; face < 6; ++face) {
        const Image one = read_confidence((*files)[face], max_pixels);
        if (one.size() != Size{column.width, column.width}) return {};
        std::copy_n(one.row(0), static_cast<std::ptrdiff_t>(one.size().pixels()) * 3,
                    all.row(static_cast<int>(face) * column.width));
    }
    return all;
}

}  // namespace

Image read_confidence(const std::string& path, std::int64_t max_pixels,
                      const std::optional<Window>& region) {
    const auto photo = read_channel(path, "confidence", {max_pixels, std::nullopt});
    if (!photo) return {};
    const Window part = region ? intersection(*region, photo->window) : photo->window;
    Image values(part.size, 3);
    load_floats(stored_rows(*photo, part, 0, part.size.height), values.view());
    for (int y = 0; y < values.height(); ++y)
        for (int i = 0; i < 3 * values.width(); ++i) {
            float& v = values.row(y)[i];
            v = v > 0 ? std::min(v, 1.0F) : 0;  // NaN too
        }
    return values;
}

MapInput read_map(const std::string& path, const Layout& layout, std::int64_t max_pixels,
                  const ColorConfig& colors, const std::optional<std::string>& input_space) {
    MapInput input;
    if (layout.separate_faces && fs::is_directory(path)) {
        input.pixels = joined_faces(path, layout, max_pixels, colors, input_space, input);
        input.confidence = joined_confidence(path, input.pixels.size(), max_pixels);
    } else {
        input.pixels = decoded(path, layout, max_pixels, colors, input_space, input);
        input.confidence = read_confidence(path, max_pixels);
    }
    const Size size = input.pixels.size();
    if (size != layout.picture(size.width / layout.width_units))
        throw Error(
            Error::Kind::failed,
            fmt::format("{}: {}x{} pixels, but a {} picture is {} wide for {} high; check --from",
                        path, size.width, size.height, layout.name, layout.width_units,
                        layout.height_units));
    return input;
}

void tell(const MapInput& map, const std::string& path, const Layout& layout,
          const Console& console) {
    for (const std::string& warning : map.warnings) console.warn(warning);
    console.say(fmt::format("{}: {} of {}x{} pixels, colour space {}", path, layout.name,
                            map.pixels.width(), map.pixels.height(), map.space));
    if (map.bad_pixels > 0) console.warn(bad_pixel_warning(path, map.bad_pixels));
}

std::string unknown_shape(const std::string& name) {
    auto names = layout_names();
    names.insert(names.begin(), "photo");
    return fmt::format("--from {}: no such shape; {}", name, did_you_mean(name, names));
}

}  // namespace chromeball
