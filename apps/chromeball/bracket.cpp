#include "bracket.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "color/pixels.h"
#include "core/error.h"
#include "io/facts.h"
#include "io/read.h"
#include "photo_job.h"

namespace chromeball {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw Error(Error::Kind::failed, why); }

/// Rows of the display window; NaN where the photo has no pixels.
void read_rows(const Photo& photo, int first, int last, ImageView<float> out) {
    const Window& w = photo.window;
    const int channels = photo.channels == 2 || photo.channels == 4 ? 4 : 3;
    const int top = std::clamp(first, w.y, w.y + w.size.height);
    const int bottom = std::clamp(last, top, w.y + w.size.height);
    const bool whole = w.x == 0 && w.size.width == out.size.width && top == first && bottom == last;
    if (!whole)
        for (int y = 0; y < out.size.height; ++y)
            std::fill_n(out.row(y), out.size.width * 3, std::numeric_limits<float>::quiet_NaN());
    if (bottom <= top) return;
    Image rows({w.size.width, bottom - top}, channels);
    load_floats(stored_rows(photo, w, top - w.y, bottom - w.y), rows.view());
    for (int y = top; y < bottom; ++y) {
        const float* from = rows.row(y - top);
        float* to = out.pixel(w.x, y - first);
        for (int x = 0; x < w.size.width; ++x, from += channels, to += 3) std::copy_n(from, 3, to);
    }
}

}  // namespace

ExposedPhoto exposed(std::shared_ptr<const Photo> photo, const ExposureTags& tags, bool linear) {
    ExposedPhoto e;
    e.name = photo->name;
    e.size = photo->display;
    e.step = photo->type == PixelType::u8    ? 1.0 / 255
             : photo->type == PixelType::u16 ? 1.0 / 65535
                                             : 0;
    e.iso = tags.iso.value_or(100);
    // Linear integers come out of a RAW file, balanced and turned into other primaries.
    e.mixed = linear && is_integer(photo->type);
    e.read = [photo](int first, int last, ImageView<float> rows) {
        read_rows(*photo, first, last, rows);
    };
    return e;
}

namespace {

/// Grey or coloured stored numbers in the working space.
Image decoded(const std::vector<std::array<float, 3>>& stored, const std::string& space,
              const ColorConfig& colors) {
    Photo photo;
    photo.type = PixelType::f32;
    photo.channels = 3;
    photo.display = {static_cast<int>(stored.size()), 1};
    photo.window = {0, 0, photo.display};
    photo.pixels.resize(stored.size() * sizeof stored[0]);
    std::memcpy(photo.pixels.data(), stored.data(), photo.pixels.size());
    return colors.to_working(photo, space);
}

/// A space as a curve for all channels and a matrix behind it; nothing where it is neither.
bool take_apart(Bracket& bracket, bool linear, const ColorConfig& colors) {
    constexpr int kNodes = 16 * 255 + 1;
    std::vector<std::array<float, 3>> stored;
    for (int i = 0; i < kNodes; ++i) {
        const float z = static_cast<float>(i) / (kNodes - 1);
        stored.push_back({z, z, z});
    }
    stored.insert(stored.end(), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.7f, 0.3f, 0.5f}});
    const Image light = decoded(stored, bracket.space, colors);
    const auto at = [&](int i, int c) { return static_cast<double>(light.pixel(i, 0)[c]); };
    const auto grey = [&](int i) { return (at(i, 0) + at(i, 1) + at(i, 2)) / 3; };
    const double top = grey(kNodes - 1), bottom = grey(0);
    if (!(top > bottom)) return false;
    std::vector<float> nodes;
    for (int i = 0; i < kNodes; ++i) {
        nodes.push_back(static_cast<float>(grey(i)));
        if (i > 0 && nodes[static_cast<std::size_t>(i)] < nodes[static_cast<std::size_t>(i) - 1])
            return false;
    }
    bracket.response = linear ? Response::linear() : Response(std::move(nodes));
    for (int row = 0; row < 3; ++row)
        for (int c = 0; c < 3; ++c)
            bracket.to_working[static_cast<std::size_t>(3 * row + c)] =
                (at(kNodes + c, row) - at(0, row)) / (top - bottom) * top;
    // A colour that no part of that was made from tells whether it holds.
    for (int row = 0; row < 3; ++row) {
        double made = 0;
        for (std::size_t c = 0; c < 3; ++c)
            made += bracket.to_working[static_cast<std::size_t>(3 * row) + c] *
                    static_cast<double>(bracket.response.light(stored.back()[c]));
        if (!(std::abs(made - at(kNodes + 3, row)) < 0.01 * top)) return false;
    }
    return true;
}

void check_like_first(const Photo& photo, const Photo& first) {
    const Size a = first.display, b = photo.display;
    if (a == b) {
        if (is_integer(photo.type) == is_integer(first.type)) return;
        refuse(fmt::format("{}: holds {} but {} holds {}; photos of a bracket must be of one kind",
                           photo.name, is_integer(photo.type) ? "integers" : "floats", first.name,
                           is_integer(first.type) ? "integers" : "floats"));
    }
    const bool turned = a.width == b.height && a.height == b.width;
    refuse(fmt::format("{}: is {}x{} pixels, but {} is {}x{}; {}", photo.name, b.width, b.height,
                       first.name, a.width, a.height,
                       turned ? "one of them is turned: set its EXIF orientation or turn it back"
                              : "photos of a bracket must be of one size: export them uncropped"));
}

}  // namespace

ExposureTags tags_of(const Metadata& metadata) { return exposure_tags(pass_through(metadata)); }

std::string missing_tags(const Bracket& bracket, std::size_t photo) {
    const ExposureTags& t = bracket.tags[photo];
    const auto others = [&](auto member) {
        return std::ranges::any_of(bracket.tags,
                                   [&](const ExposureTags& o) { return (o.*member).has_value(); });
    };
    std::string missing;
    const auto add = [&](const char* name) {
        missing += missing.empty() ? name : fmt::format(", {}", name);
    };
    if (!t.time) add("time");
    if (!t.aperture && others(&ExposureTags::aperture)) add("f-number");
    if (!t.iso && others(&ExposureTags::iso)) add("ISO");
    return missing;
}

Bracket read_bracket(const std::vector<std::string>& files, const std::vector<double>& times,
                     const std::optional<std::string>& input_space, std::int64_t max_pixels,
                     const ColorConfig& colors, const Console& console) {
    Bracket bracket;
    bool linear = false;
    for (const std::string& file : files) {
        auto photo = std::make_shared<Photo>(read_photo(file, {.max_pixels = max_pixels}));
        console.watch("").check();
        if (!photo->damage.empty()) console.warn(damage_warning(*photo));
        if (!bracket.photos.empty()) check_like_first(*photo, *bracket.photos.front());
        std::string warning;
        const std::string space = colors.input_space(*photo, input_space, &warning);
        if (!warning.empty()) console.warn(warning);
        if (bracket.photos.empty()) {
            bracket.space = space;
            linear = colors.is_linear(space);
            if (!linear && !is_integer(photo->type))
                refuse(
                    fmt::format("{}: floats in {}; only linear floats are merged: name the "
                                "space they are in with --input-space",
                                file, space));
        } else if (space != bracket.space) {
            refuse(fmt::format("{}: is in {}, but {} is in {}; name one with --input-space", file,
                               space, files.front(), bracket.space));
        }
        ExposureTags tags = tags_of(photo->metadata);
        if (!times.empty()) tags.time = times[bracket.photos.size()];
        bracket.tags.push_back(tags);
        bracket.exposed.push_back(exposed(photo, tags, linear));
        bracket.photos.push_back(std::move(photo));
    }
    if (!take_apart(bracket, linear, colors))
        refuse(
            fmt::format("{}: {} is no curve and matrix, so exposures in it cannot be merged; "
                        "give --input-space",
                        files.front(), bracket.space));
    const double white = clip_level(bracket.exposed, is_integer(bracket.photos.front()->type));
    for (ExposedPhoto& photo : bracket.exposed) photo.white = white;
    for (std::size_t k = 0; k < files.size(); ++k) {
        const auto exposure = exposure_of(bracket.tags[k]);
        bracket.told.push_back(
            missing_tags(bracket, k).empty() ? std::optional(std::log2(*exposure)) : std::nullopt);
    }
    return bracket;
}

}  // namespace chromeball
