#include <OpenEXR/IexBaseExc.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTileDescription.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "core/names.h"
#include "io/decoders.h"
#include "io/exr_attributes.h"
#include "io/exr_chunks.h"
#include "io/exr_zip.h"
#include "io/messages.h"

namespace chromeball::io {
namespace {

/// Which channels of a part become the photo's, in its order.
struct Selection {
    std::vector<std::string> names;  ///< one, two (grey, alpha), three or four
    bool luminance_chroma = false;   ///< stored as Y, RY, BY: OpenEXR reconstructs RGB
    bool empty() const { return names.empty() && !luminance_chroma; }
};

/// "diffuse." of "diffuse.R", "" of "R".
std::string layer_of(const std::string& channel) {
    const auto dot = channel.rfind('.');
    return dot == std::string::npos ? std::string() : channel.substr(0, dot + 1);
}

std::string lower_case(std::string text) {
    std::ranges::transform(text, text.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// The channel of a layer that is called one of the names, ignoring case; empty where none is.
std::string channel_named(const std::vector<std::string>& channels, const std::string& layer,
                          std::initializer_list<std::string_view> names) {
    for (const std::string& channel : channels) {
        if (layer_of(channel) != layer) continue;
        const std::string last = lower_case(channel.substr(layer.size()));
        if (std::ranges::find(names, last) != names.end()) return channel;
    }
    return {};
}

std::vector<std::string> colors_of_layer(const std::vector<std::string>& channels,
                                         const std::string& layer) {
    std::vector<std::string> names = {channel_named(channels, layer, {"r", "red"}),
                                      channel_named(channels, layer, {"g", "green"}),
                                      channel_named(channels, layer, {"b", "blue"})};
    if (std::ranges::any_of(names, &std::string::empty)) {
        names = {channel_named(channels, layer, {"y", "l", "luminance"})};
        if (names[0].empty()) return {};
    }
    const std::string alpha = channel_named(channels, layer, {"a", "alpha"});
    if (!alpha.empty()) names.push_back(alpha);
    return names;
}

/// 0 for the unnamed layer, 1 for the usual names of the final picture ("rgba", Blender's
/// "View Layer.Combined"), 2 for any other.
int rank_of_layer(const std::string& layer) {
    if (layer.empty()) return 0;
    std::string last = layer.substr(0, layer.size() - 1);
    last = lower_case(last.substr(last.rfind('.') + 1));
    constexpr std::string_view kFinal[] = {"rgba", "rgb", "beauty", "combined"};
    return std::ranges::find(kFinal, last) == std::end(kFinal) ? 2 : 1;
}

std::vector<std::string> layers_by_preference(const std::vector<std::string>& channels) {
    std::vector<std::string> layers;
    for (const std::string& channel : channels)
        if (std::ranges::find(layers, layer_of(channel)) == layers.end())
            layers.push_back(layer_of(channel));
    std::ranges::stable_sort(layers, {}, rank_of_layer);
    return layers;
}

std::vector<std::string> channel_names(const Imf::ChannelList& list) {
    std::vector<std::string> names;
    for (auto i = list.begin(); i != list.end(); ++i) names.emplace_back(i.name());
    return names;
}

Selection select_channels(const Imf::ChannelList& list) {
    if (list.findChannel("Y") && list.findChannel("RY") && list.findChannel("BY"))
        return {{}, true};
    const std::vector<std::string> channels = channel_names(list);
    for (const std::string& layer : layers_by_preference(channels)) {
        const auto names = colors_of_layer(channels, layer);
        if (!names.empty()) return {names, false};
    }
    if (channels.size() == 1) return {channels, false};  // whatever its name: grey
    return {};
}

struct PartChoice {
    int part = 0;
    Selection selection;
};

/// The first part that holds a flat picture.
PartChoice choose_part(const std::string& path, const Imf::MultiPartInputFile& file) {
    bool deep = false;
    std::vector<std::string> found;
    for (int part = 0; part < file.parts(); ++part) {
        const Imf::Header& header = file.header(part);
        if (header.hasType() && Imf::isDeepData(header.type())) {
            deep = true;
            continue;
        }
        const Selection selection = select_channels(header.channels());
        if (!selection.empty()) return {part, selection};
        for (const std::string& name : channel_names(header.channels())) found.push_back(name);
    }
    if (deep && found.empty()) throw failure(path, "holds deep pixels only; flatten it first");
    found.resize(std::min<std::size_t>(found.size(), 8));
    throw failure(path, fmt::format("holds no colour among its channels {}; R, G, B or Y are "
                                    "needed, alone or in a layer",
                                    quoted_list(found)));
}

/// The first part that has a channel; nothing where none has.
std::optional<PartChoice> part_with(const Imf::MultiPartInputFile& file,
                                    const std::string& channel) {
    for (int part = 0; part < file.parts(); ++part) {
        const Imf::Header& header = file.header(part);
        if (header.hasType() && Imf::isDeepData(header.type())) continue;
        if (header.channels().findChannel(channel)) return PartChoice{part, {{channel}, false}};
    }
    return std::nullopt;
}

struct Frame {
    Imath::Box2i data;
    Imath::V2i origin;  ///< of the display window
};

/// Sizes and facts, everything but pixels.
Photo describe(const std::string& path, const Imf::Header& header, const Selection& selection,
               std::int64_t max_pixels, Frame& frame) {
    const auto extent = [](const Imath::Box2i& box) {
        return std::pair{std::int64_t{box.max.x} - box.min.x + 1,
                         std::int64_t{box.max.y} - box.min.y + 1};
    };
    frame = {header.dataWindow(), header.displayWindow().min};
    const auto [width, height] = extent(frame.data);
    const auto [display_width, display_height] = extent(header.displayWindow());
    check_size(path, width, height, max_pixels);
    check_size(path, display_width, display_height, max_pixels);
    Photo photo;
    photo.name = path;
    photo.display = {static_cast<int>(display_width), static_cast<int>(display_height)};
    const std::int64_t x = std::int64_t{frame.data.min.x} - frame.origin.x;
    const std::int64_t y = std::int64_t{frame.data.min.y} - frame.origin.y;
    constexpr std::int64_t kFarthest = 1 << 30;  // so that sums of coordinates stay ints
    if (std::max(std::abs(x), std::abs(y)) > kFarthest)
        throw failure(path, "its data window lies too far from its display window: damaged");
    photo.window = {static_cast<int>(x),
                    static_cast<int>(y),
                    {static_cast<int>(width), static_cast<int>(height)}};
    photo.type = PixelType::f16;
    photo.channels = static_cast<int>(selection.names.size());
    if (selection.luminance_chroma) photo.channels = header.channels().findChannel("A") ? 4 : 3;
    for (const std::string& name : selection.names) {
        const Imf::Channel& channel = header.channels()[name];
        if (channel.type != Imf::HALF) photo.type = PixelType::f32;
        if (channel.xSampling != 1 || channel.ySampling != 1)
            throw failure(path, fmt::format("its channel {} is stored at a lower resolution, which "
                                            "is read for Y, RY, BY only; save it as plain RGB",
                                            name));
    }
    photo.associated_alpha = true;
    photo.color = color_tag_of(header);
    photo.metadata = metadata_of(header);
    return photo;
}

std::size_t pixel_bytes(const Photo& photo) {
    return bytes_per_value(photo.type) * static_cast<std::size_t>(photo.channels);
}

/// Decodes the rows of a photo, or of a band of it, into its pixels.
void decode_rows(Imf::InputPart& part, const Selection& selection, const Frame& frame,
                 Photo& photo) {
    const std::size_t value = bytes_per_value(photo.type);
    const Imf::PixelType type = photo.type == PixelType::f16 ? Imf::HALF : Imf::FLOAT;
    const int first = photo.window.y + frame.origin.y;
    const Size size = photo.window.size;
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < selection.names.size(); ++i)
        buffer.insert(selection.names[i],
                      Imf::Slice::Make(type, photo.pixels.data() + i * value,
                                       Imath::V2i(frame.data.min.x, first), size.width, size.height,
                                       pixel_bytes(photo),
                                       pixel_bytes(photo) * static_cast<std::size_t>(size.width)));
    part.setFrameBuffer(buffer);
    part.readPixels(first, first + size.height - 1);
}

/// Rows to decode at a time: enough for all threads, and whole chunks of all but DWAB files, whose
/// last chunk the library keeps.
int band_rows(const Imf::Header& header) {
    const int rows = kBandRows * std::max(1, Imf::globalThreadCount());
    if (!header.hasTileDescription()) return rows;
    const auto tile = static_cast<int>(std::min<unsigned>(header.tileDescription().ySize, 1 << 16));
    return std::max(1, rows / tile) * tile;
}

void decode_channels(Imf::MultiPartInputFile& file, const PartChoice& choice, const Frame& frame,
                     const std::function<void(const Photo& band)>& bands, Photo& photo) {
    Imf::InputPart part(file, choice.part);
    if (!bands) {
        decode_rows(part, choice.selection, frame, photo);
        return;
    }
    const int together = band_rows(file.header(choice.part));
    const int top = frame.data.min.y - frame.origin.y;
    const int end = photo.window.y + photo.window.size.height;
    for (int first = photo.window.y; first < end;) {
        const int last = std::min(end, first + together - (first - top) % together);
        Photo band = band_of(photo, first, last);
        decode_rows(part, choice.selection, frame, band);
        bands(band);
        first = last;
    }
}

/// OpenEXR's own reconstruction of luminance and chroma, which reads the first part only.
void decode_luminance_chroma(const std::string& path, const Frame& frame, Photo& photo) {
    Imf::RgbaInputFile file(path.c_str());
    const Size size = photo.window.size;
    const auto channels = static_cast<std::size_t>(photo.channels);
    const int first = photo.window.y + frame.origin.y;
    std::vector<Imf::Rgba> row(static_cast<std::size_t>(size.width));
    auto* out = reinterpret_cast<std::uint16_t*>(photo.pixels.data());
    for (int y = first; y < first + size.height; ++y) {
        // One row of memory for all: no stride from row to row.
        file.setFrameBuffer(row.data() - frame.data.min.x, 1, 0);
        file.readPixels(y);
        for (const Imf::Rgba& pixel : row) {
            const std::array values = {pixel.r.bits(), pixel.g.bits(), pixel.b.bits(),
                                       pixel.a.bits()};
            out = std::copy_n(values.begin(), channels, out);
        }
    }
}

Photo decode(const std::string& path, const FileProbe& probe, const DecodeRequest& request) {
    Imf::MultiPartInputFile file(path.c_str());
    std::optional<PartChoice> extra;
    if (!request.channel.empty() && !(extra = part_with(file, request.channel))) return {};
    const PartChoice choice = extra ? *extra : choose_part(path, file);
    Frame frame;
    Photo photo =
        describe(path, file.header(choice.part), choice.selection, request.max_pixels, frame);
    const auto [first, last] = wanted_rows(photo.window, request.rows);
    photo.window.y = first;
    photo.window.size.height = last - first;
    if (!file.partComplete(choice.part))
        throw failure(path, "truncated: rows of pixels are missing; copy or render it again");
    const auto chunks = checked_chunks(path, probe, file, choice.part);
    if (request.header_only || first == last) return photo;
    const Imf::Header& header = file.header(choice.part);
    const bool zip = chunks && !choice.selection.luminance_chroma &&
                     can_decode_zip(header, choice.selection.names, photo.type);
    if (!request.bands || choice.selection.luminance_chroma)
        photo.pixels.resize(photo.window.size.pixels() * pixel_bytes(photo));
    if (zip) {
        decode_zip(header, *chunks, choice.selection.names, first + frame.origin.y, request.bands,
                   photo);
        return photo;
    }
    if (choice.selection.luminance_chroma && choice.part != 0)
        throw failure(path, "its luminance and chroma are not in the first part; save it as RGB");
    if (choice.selection.luminance_chroma)
        decode_luminance_chroma(path, frame, photo);
    else
        decode_channels(file, choice, frame, request.bands, photo);
    return photo;
}

/// OpenEXR's words without the file's name, which they repeat.
std::string reason_of(const std::exception& e) {
    const std::string text = e.what();
    const auto named = text.find("\". ");
    return named == std::string::npos ? text : text.substr(named + 3);
}

}  // namespace

Photo decode_exr(const std::string& path, const FileProbe& probe, const DecodeRequest& request) {
    // The library reads the table of contents, as long as the picture is high, before anything.
    if (const auto claimed = claimed_size(probe))
        check_size(path, claimed->first, claimed->second, request.max_pixels);
    try {
        return decode(path, probe, request);
    } catch (const Iex::BaseExc& e) {
        const std::string reason = reason_of(e);
        const bool ends_early = reason.find("nd of file") != std::string::npos;
        throw failure(path, fmt::format("{}: {}; copy or render it again",
                                        ends_early ? "truncated" : "damaged", reason));
    }
}

}  // namespace chromeball::io
