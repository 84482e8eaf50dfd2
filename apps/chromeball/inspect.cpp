#include "inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/error.h"
#include "io/facts.h"
#include "io/read.h"
#include "map_files.h"
#include "map_input.h"
#include "resample/measure.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

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

/// What `info` tells of a measured picture.
void tell(const MapMeasure& measure, InfoReport& report) {
    report.mean_radiance = measure.mean;
    if (measure.highest > 0) report.range_stops = std::log2(measure.highest / measure.lowest);
    report.maximum = measure.highest;
    report.over_sphere = measure.covered_steradians.has_value();
    report.covered_steradians = measure.covered_steradians;
}

}  // namespace

LayoutGuess guess_layout(const Photo& photo, const Image* pixels) {
    const Size size = pixels ? pixels->size() : photo.display;
    const auto past = provenance_from(photo.metadata);
    if (past && !past->layout.empty())
        if (const Layout* layout = find_layout(past->layout.substr(0, past->layout.find(' '))))
            if (size == layout->picture(size.width / layout->width_units))
                return {layout, "certain: chromeball wrote it"};
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
        if (pixels && fits(name) && empty_parts_are_empty(*pixels, *find_layout(name)))
            return {find_layout(name),
                    "likely: by its shape, and the corners of the cross are empty"};
    if (pixels && size.width == size.height && size.width > 1) {
        if (empty_parts_are_empty(*pixels, *find_layout("angular")))
            return {find_layout("angular"),
                    "a guess: a disk in a square, angular map or mirror ball"};
        return {nullptr, "not known: a square may be one face, or a photo of a ball"};
    }
    return {nullptr, "none: a photo, by its shape"};
}

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
        const LayoutGuess guess = guess_layout(photo, &pixels);
        told = guess.layout;
        report.layout = told ? told->name : "";
        report.layout_sureness = guess.sureness;
    }
    report.size = pixels.size();
    tell(measure(pixels, told), report);
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
