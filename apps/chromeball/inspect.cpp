#include "inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "io/facts.h"
#include "io/read.h"
#include "map_files.h"
#include "map_input.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

struct Guess {
    const Layout* layout = nullptr;
    std::string sureness;
};

std::string_view type_name(PixelType type) {
    switch (type) {
        case PixelType::u8:
            return "8-bit integers";
        case PixelType::u16:
            return "16-bit integers";
        case PixelType::f16:
            return "half floats";
        case PixelType::f32:
            return "32-bit floats";
    }
    return "";
}

/// Whether all of a picture's parts that a layout leaves empty are black or transparent.
bool empty_parts_are_empty(const Image& pixels, const Layout& layout) {
    std::size_t empty = 0, dark = 0;
    for (int y = 0; y < pixels.height(); y += std::max(1, pixels.height() / 256))
        for (int x = 0; x < pixels.width(); x += std::max(1, pixels.width() / 256)) {
            // Half a pixel and a bit away from what is filled.
            const V2d p((x + 0.5) / pixels.width(), (y + 0.5) / pixels.height());
            const double margin = 2.0 / pixels.width();
            bool outside = true;
            for (const auto& off : std::array{V2d(0, 0), V2d(margin, 0), V2d(-margin, 0),
                                              V2d(0, margin), V2d(0, -margin)})
                outside = outside &&
                          std::visit([&](const auto& s) { return s.solid_angle(p + off) == 0; },
                                     layout.projection);
            if (!outside) continue;
            ++empty;
            const float* v = pixels.pixel(x, y);
            dark += (pixels.channels() > 3 && v[3] == 0) ||
                    (v[0] < 1e-3F && v[1] < 1e-3F && v[2] < 1e-3F);
        }
    return empty > 0 && dark == empty;
}

Guess guess_layout(const Photo& photo, const Image& pixels) {
    const auto past = provenance_from(photo.metadata);
    if (past && !past->layout.empty())
        if (const Layout* layout = find_layout(past->layout.substr(0, past->layout.find(' '))))
            if (pixels.size() == layout->picture(pixels.width() / layout->width_units))
                return {layout, "certain: chromeball wrote it"};
    const Size size = pixels.size();
    const auto fits = [&](std::string_view name) {
        const Layout* layout = find_layout(name);
        return size == layout->picture(size.width / layout->width_units) &&
               size.width >= layout->width_units;
    };
    if (const Attribute* envmap = photo.metadata.find("envmap")) {
        const bool cube = !envmap->numbers.empty() ? envmap->numbers.front() == 1
                                                   : envmap->text.find("cube") != std::string::npos;
        const std::string_view name = cube ? "openexr" : "latlong";
        if (fits(name)) return {find_layout(name), "certain: its envmap attribute says so"};
    }
    if (fits("latlong")) return {find_layout("latlong"), "likely: twice as wide as high"};
    if (fits("openexr")) return {find_layout("openexr"), "likely: six squares in a column"};
    if (fits("strip-h")) return {find_layout("strip-h"), "likely: six squares in a row"};
    for (const std::string_view name : {"cross-h", "cross-v"})
        if (fits(name) && empty_parts_are_empty(pixels, *find_layout(name)))
            return {find_layout(name),
                    "likely: by its shape, and the corners of the cross are empty"};
    if (size.width == size.height && size.width > 1) {
        if (empty_parts_are_empty(pixels, *find_layout("angular")))
            return {find_layout("angular"),
                    "a guess: a disk in a square, angular map or mirror ball"};
        return {nullptr, "not known: a square may be one face, or a photo of a ball"};
    }
    return {nullptr, "none: a photo, by its shape"};
}

double luminance(const float* p) { return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]; }

/// Range, mean and coverage; weighted by solid angle where the layout is known.
void measure(const Image& pixels, const Layout* layout, InfoReport& report) {
    double low = std::numeric_limits<double>::infinity(), high = 0, covered = 0, whole = 0;
    std::array<double, 3> sum{};
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x) {
            double weight = 1;
            if (layout) {
                const V2d p((x + 0.5) / pixels.width(), (y + 0.5) / pixels.height());
                weight = std::visit([&](const auto& shape) { return shape.solid_angle(p); },
                                    layout->projection);
            }
            whole += weight;
            const float* v = pixels.pixel(x, y);
            const double alpha = pixels.channels() > 3 ? static_cast<double>(v[3]) : 1;
            if (weight == 0 || alpha <= 0) continue;
            covered += weight * alpha;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * v[c];
            const double light = luminance(v) / alpha;
            if (light > 0) low = std::min(low, light);
            high = std::max(high, light);
        }
    if (covered > 0)
        for (std::size_t c = 0; c < 3; ++c) report.mean_radiance[c] = sum[c] / covered;
    if (high > 0) report.range_stops = std::log2(high / low);
    report.maximum = high;
    report.over_sphere = layout != nullptr;
    // Solid angles taken at pixels' centres add up to 4 pi only nearly.
    if (layout && whole > 0) report.covered_steradians = 4 * std::numbers::pi * covered / whole;
}

}  // namespace

InfoReport inspect(const std::string& path, const std::optional<std::string>& from,
                   std::int64_t max_pixels, const ColorConfig& colors,
                   const std::optional<std::string>& input_space) {
    const Layout* told = nullptr;
    if (from) {
        told = find_layout(*from);
        if (!told) throw Error(Error::Kind::usage, unknown_shape(*from));
    }
    std::optional<std::array<std::string, 6>> faces;
    if (fs::is_directory(path)) {
        faces = faces_in(path);
    }
    const Photo photo = read_photo(faces ? faces->front() : path, {max_pixels, std::nullopt});
    const auto past = provenance_from(photo.metadata);
    std::string folder_sureness = "six files in a folder";
    if (faces && !told) {
        told = find_layout("faces");
        const Layout* noted = past ? find_layout(past->layout) : nullptr;
        if (noted && noted->separate_faces) {
            told = noted;
            folder_sureness = "certain: chromeball wrote it";
        }
    }

    InfoReport report;
    report.file = path;
    report.channels = photo.channels;
    report.type = type_name(photo.type);
    Image pixels;
    if (told) {
        MapInput map = read_map(path, *told, max_pixels, colors, input_space);
        pixels = std::move(map.pixels);
        report.color_space = map.space;
        report.bad_pixels = map.bad_pixels;
        report.notes = map.warnings;
        report.layout = told->name;
        report.layout_sureness = from ? "as told" : folder_sureness;
    } else {
        std::string warning;
        report.color_space = colors.input_space(photo, input_space, &warning);
        if (!warning.empty()) report.notes.push_back(warning);
        pixels = colors.to_working(photo, report.color_space, std::nullopt, &report.bad_pixels);
        const Guess guess = guess_layout(photo, pixels);
        told = guess.layout;
        report.layout = told ? told->name : "";
        report.layout_sureness = guess.sureness;
    }
    report.size = pixels.size();
    measure(pixels, told, report);
    if (past) report.provenance = to_attribute(*past).text;
    if (report.layout == "angular" && report.layout_sureness.starts_with("a guess"))
        report.notes.push_back(
            "a \"light probe\" in a disk is an angular map more often than a mirror ball: compare "
            "what lies at half the "
            "radius, 90 degrees from the middle in an angular map, 60 in a mirror ball; then say "
            "--from angular or "
            "--from mirror-ball");
    return report;
}

}  // namespace chromeball
