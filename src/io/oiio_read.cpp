#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <memory>

#include "io/channel_names.h"
#include "io/decoders.h"
#include "io/messages.h"
#include "io/oiio_doors.h"
#include "io/oiio_types.h"
#include "io/orient.h"

namespace chromeball::io::oiio {
namespace {

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// How files are to be opened.
ImageSpec open_hints(const FileProbe& probe) {
    ImageSpec hints;
    // Multiplying encoded colour by alpha would be wrong; `color` does it after decoding.
    hints.attribute("oiio:UnassociatedAlpha", 1);
    if (probe.raw) {
        // Scene-linear numbers in Rec.709 primaries, balanced as the camera meant, and nothing
        // brightened behind the photographer's back.
        hints.attribute("raw:ColorSpace", "sRGB-linear");
        hints.attribute("raw:auto_bright", 0);
        hints.attribute("raw:use_camera_wb", 1);
        hints.attribute("raw:adjust_maximum_thr", 0.0f);
    }
    return hints;
}

std::unique_ptr<ImageInput> open(const std::string& path, const FileProbe& probe) {
    auto input = ImageInput::create(probe.plugin);
    if (!input) {
        OIIO::geterror();  // clears it
        throw failure(path, fmt::format("this OpenImageIO reads no {} files; convert it to EXR, "
                                        "TIFF or PNG",
                                        probe.plugin));
    }
    ImageSpec spec;
    if (input->open(path, spec, open_hints(probe))) return input;
    const std::string reason = input->geterror();
    if (reason.find("limits:imagesize_MB") != std::string::npos)
        throw failure(path, "claims more pixels than can be read; damaged, or raise --max-pixels");
    throw failure(path, fmt::format("cannot be read as {}: {}; damaged or truncated: copy or "
                                    "export it again",
                                    probe.plugin, reason.empty() ? "no reason given" : reason));
}

PixelType pixel_type_of(TypeDesc format) {
    switch (format.basetype) {
        case TypeDesc::UINT8:
        case TypeDesc::INT8:
            return PixelType::u8;
        case TypeDesc::UINT16:
        case TypeDesc::INT16:
            return PixelType::u16;
        case TypeDesc::HALF:
            return PixelType::f16;
        default:
            return PixelType::f32;
    }
}

int channel_index(const ImageSpec& spec, std::string_view name) {
    for (std::size_t i = 0; i < spec.channelnames.size(); ++i)
        if (spec.channelnames[i] == name) return static_cast<int>(i);
    return -1;
}

/// The file's channels that become the photo's: grey or red, green, blue; then alpha.
std::vector<int> select_channels(const ImageSpec& spec) {
    std::vector<int> channels = {channel_index(spec, "R"), channel_index(spec, "G"),
                                 channel_index(spec, "B")};
    const bool named = std::ranges::all_of(channels, [](int c) { return c >= 0; });
    if (!named && spec.nchannels >= 3)
        channels = {0, 1, 2};
    else if (!named)
        channels = {spec.alpha_channel == 0 && spec.nchannels > 1 ? 1 : 0};
    const int alpha = spec.alpha_channel;
    if (alpha >= 0 && alpha < spec.nchannels &&
        std::ranges::find(channels, alpha) == channels.end())
        channels.push_back(alpha);
    return channels;
}

/// Where the pixels lie in the display window, if the file tells and it makes sense: headers of
/// film scanners hold junk there, so a window that does not hold the picture, or is of a size that
/// is not allowed, is none.
void place(const ImageSpec& spec, std::int64_t max_pixels, Photo& photo) {
    photo.window = {0, 0, {spec.width, spec.height}};
    photo.display = {spec.width, spec.height};
    const std::int64_t x = std::int64_t{spec.x} - spec.full_x;
    const std::int64_t y = std::int64_t{spec.y} - spec.full_y;
    const bool inside = x >= 0 && y >= 0 && x + spec.width <= spec.full_width &&
                        y + spec.height <= spec.full_height;
    if (!inside || spec.full_height > max_pixels / spec.full_width) return;
    photo.window.x = static_cast<int>(x);
    photo.window.y = static_cast<int>(y);
    photo.display = {spec.full_width, spec.full_height};
}

/// Attributes larger than this are profiles, thumbnails, makers' private notes.
constexpr std::size_t kMostText = 64 * 1024;
constexpr std::size_t kMostNumbers = 64;

std::string_view type_name(TypeDesc type, std::size_t count) {
    if (type.vecsemantics == TypeDesc::TIMECODE && count == 2) return "timecode";
    if (type.vecsemantics == TypeDesc::KEYCODE && count == 7) return "keycode";
    const bool floating = type.basetype == TypeDesc::FLOAT || type.basetype == TypeDesc::HALF ||
                          type.basetype == TypeDesc::DOUBLE;
    if (count == 1)
        return type.basetype == TypeDesc::DOUBLE ? "double" : floating ? "float" : "int";
    if (type.aggregate == TypeDesc::MATRIX44) return "m44f";
    if (type.aggregate == TypeDesc::MATRIX33) return "m33f";
    if (count == 2) return floating ? "v2f" : "v2i";
    if (count == 3) return floating ? "v3f" : "v3i";
    return floating ? "floatvector" : "";
}

std::optional<Attribute> to_attribute(const OIIO::ParamValue& value) {
    Attribute attribute{value.name().string(), {}, {}, {}};
    const TypeDesc type = value.type();
    const auto count = static_cast<std::size_t>(type.numelements() * type.aggregate) *
                       static_cast<std::size_t>(value.nvalues());
    if (type.basetype == TypeDesc::STRING) {
        if (count != 1) return std::nullopt;
        attribute.type = "string";
        attribute.text = value.get_string(0);
        if (attribute.text.size() > kMostText) return std::nullopt;
        return attribute;
    }
    const bool blob =
        type.arraylen != 0 && (type.basetype == TypeDesc::UINT8 || type.basetype == TypeDesc::INT8);
    if (blob || count == 0 || count > kMostNumbers) return std::nullopt;
    if (type.vecsemantics == TypeDesc::RATIONAL && count == 2) {
        attribute.type = "double";
        attribute.numbers = {value.get_float()};
        return attribute;
    }
    attribute.type = type_name(type, count);
    if (attribute.type.empty()) return std::nullopt;
    const auto* bytes = static_cast<const char*>(value.data());
    const auto component = [&](auto example, std::size_t i) {
        std::memcpy(&example, bytes + i * sizeof example, sizeof example);
        return static_cast<double>(example);
    };
    for (std::size_t i = 0; i < count; ++i) {
        switch (type.basetype) {
            case TypeDesc::UINT8:
                attribute.numbers.push_back(component(std::uint8_t{}, i));
                break;
            case TypeDesc::INT8:
                attribute.numbers.push_back(component(std::int8_t{}, i));
                break;
            case TypeDesc::UINT16:
                attribute.numbers.push_back(component(std::uint16_t{}, i));
                break;
            case TypeDesc::INT16:
                attribute.numbers.push_back(component(std::int16_t{}, i));
                break;
            case TypeDesc::UINT32:
                attribute.numbers.push_back(component(std::uint32_t{}, i));
                break;
            case TypeDesc::INT32:
                attribute.numbers.push_back(component(std::int32_t{}, i));
                break;
            case TypeDesc::FLOAT:
                attribute.numbers.push_back(component(float{}, i));
                break;
            case TypeDesc::DOUBLE:
                attribute.numbers.push_back(component(double{}, i));
                break;
            default:
                return std::nullopt;
        }
    }
    return attribute;
}

Metadata metadata_of(const ImageSpec& spec) {
    Metadata metadata;
    for (const OIIO::ParamValue& value : spec.extra_attribs) {
        const std::string_view name = value.name().c_str();
        // The picture is handed on upright, and its space is told in the colour tag.
        if (name == "Orientation" || name == "oiio:ColorSpace" || name == "thumbnail_image")
            continue;
        if (auto attribute = to_attribute(value)) metadata.set(std::move(*attribute));
    }
    return metadata;
}

ColorTag color_tag_of(const ImageSpec& spec, const FileProbe& probe) {
    ColorTag tag;
    if (probe.raw) {
        tag.space = "lin_rec709";  // as asked for in open_hints
        return tag;
    }
    const OIIO::ParamValue* icc = spec.find_attribute("ICCProfile");
    if (icc && icc->type().basetype == TypeDesc::UINT8)
        tag.space = icc_description({static_cast<const std::byte*>(icc->data()),
                                     static_cast<std::size_t>(icc->datasize())});
    if (tag.space.empty() && spec.get_int_attribute("Exif:ColorSpace") == 1) tag.space = "sRGB";
    if (tag.space.empty() && probe.plugin == "png" && png_says_srgb(probe.head)) tag.space = "sRGB";
    if (probe.plugin == "hdr") tag.chromaticities = radiance_header(probe.head).primaries;
    return tag;
}

/// Rows that are stored together: of tiles, or of a TIFF's strips, which are decoded alone only
/// when they are asked for whole; else 1.
int rows_together(const ImageSpec& spec) {
    if (spec.tile_width > 0) return spec.tile_height;
    const int strip = spec.get_int_attribute("tiff:RowsPerStrip", 1);
    return strip > 0 && strip <= spec.height / 4 ? strip : 1;  // else there is little to skip
}

/// The stored rows first to last, all channels, into memory of its own size.
bool read_rows(ImageInput& input, const ImageSpec& spec, int first, int last, TypeDesc type,
               PixelBytes& out, std::size_t row_bytes) {
    // Whole tiles or strips, of which the wanted rows are then cut out.
    const int together = rows_together(spec);
    const int top = first / together * together;
    const int bottom = static_cast<int>(std::min(
        std::int64_t{spec.height}, (std::int64_t{last} + together - 1) / together * together));
    out.resize(static_cast<std::size_t>(bottom - top) * row_bytes);
    const bool good =
        spec.tile_width > 0
            ? input.read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + top, spec.y + bottom,
                               spec.z, spec.z + 1, 0, spec.nchannels, type, out.data())
            : input.read_scanlines(0, 0, spec.y + top, spec.y + bottom, 0, 0, spec.nchannels, type,
                                   out.data());
    if (!good) return false;
    out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(
                                             static_cast<std::size_t>(first - top) * row_bytes));
    out.resize(static_cast<std::size_t>(last - first) * row_bytes);
    return true;
}

/// Keeps the chosen ones of `stored` interleaved channels, in place.
void keep_channels(PixelBytes& pixels, const std::vector<int>& chosen, int stored,
                   std::size_t value) {
    const std::size_t from = value * static_cast<std::size_t>(stored);
    const std::size_t to = value * chosen.size();
    const std::size_t count = pixels.size() / from;
    std::vector<std::byte> pixel(from);
    for (std::size_t i = 0; i < count; ++i) {
        std::memcpy(pixel.data(), pixels.data() + i * from, from);
        for (std::size_t c = 0; c < chosen.size(); ++c)
            std::memcpy(pixels.data() + i * to + c * value,
                        pixel.data() + static_cast<std::size_t>(chosen[c]) * value, value);
    }
    pixels.resize(count * to);
}

bool keeps_all(const std::vector<int>& chosen, int stored) {
    for (std::size_t i = 0; i < chosen.size(); ++i)
        if (chosen[i] != static_cast<int>(i)) return false;
    return static_cast<int>(chosen.size()) == stored;
}

/// The channel of a file without names for them that chromeball called so when it wrote it; none
/// where it has none, or where the file has been given others since.
std::vector<int> own_channel(const ImageSpec& spec, const std::string& name) {
    const auto names = channel_names(metadata_of(spec));
    const auto found = std::ranges::find(names, name);
    const auto index = static_cast<int>(found - names.begin());
    if (found == names.end() || static_cast<int>(names.size()) != spec.nchannels ||
        index == spec.alpha_channel)
        return {};
    return {index};
}

/// `channels` are the file's that become the photo's.
Photo describe(const std::string& path, const FileProbe& probe, const ImageSpec& spec,
               const std::vector<int>& channels, std::int64_t max_pixels) {
    Photo photo;
    photo.name = path;
    photo.type = pixel_type_of(spec.format);
    photo.channels = static_cast<int>(channels.size());
    place(spec, max_pixels, photo);
    photo.associated_alpha = spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
    photo.color = color_tag_of(spec, probe);
    photo.metadata = metadata_of(spec);
    if (probe.plugin == "hdr")
        if (auto text = radiance_header(probe.head).provenance; !text.empty())
            photo.metadata.set("chromeball", std::move(text));
    return photo;
}

void check_spec(const std::string& path, const ImageSpec& spec, std::int64_t max_pixels) {
    check_size(path, spec.width, spec.height, max_pixels);
    constexpr int kMostChannels = 64;
    if (spec.nchannels < 1 || spec.nchannels > kMostChannels || spec.deep || spec.depth > 1)
        throw failure(path, fmt::format("has {} channels and {} layers of depth; a flat picture "
                                        "with 1 to {} channels is needed",
                                        spec.nchannels, spec.depth, kMostChannels));
    if (std::int64_t{spec.tile_width} * spec.tile_height > max_pixels)
        throw failure(path, "claims tiles larger than the pixels allowed; damaged");
}

void check_decoded(const std::string& path, const ImageInput& input, bool good) {
    const std::string reason = input.geterror();
    if (!good || !reason.empty())
        throw failure(path, fmt::format("truncated or damaged: {}; copy or export it again",
                                        reason.empty() ? "its pixels cannot be decoded" : reason));
}

/// A file that ends early is refused whichever rows are wanted. Where a look at its structure has
/// not told that, its outermost rows do, the last one first: decoders that go from the top reach it
/// over all others.
void check_outermost_rows(const std::string& path, const FileProbe& probe, ImageInput& input,
                          const ImageSpec& spec) {
    if (probe.plugin == "tiff" || probe.plugin == "jpeg" || probe.plugin == "png") return;
    PixelBytes row;
    for (const int y : {spec.height - 1, 0})
        check_decoded(path, input,
                      read_rows(input, spec, y, y + 1, spec.format, row, spec.scanline_bytes()));
}

void decode_pixels(const std::string& path, ImageInput& input, const ImageSpec& spec,
                   const std::vector<int>& chosen, int first, int last, Photo& photo) {
    const std::size_t value = bytes_per_value(photo.type);
    const std::size_t row_bytes =
        value * static_cast<std::size_t>(spec.nchannels) * static_cast<std::size_t>(spec.width);
    const bool good =
        read_rows(input, spec, first, last, type_desc_of(photo.type), photo.pixels, row_bytes);
    check_decoded(path, input, good);
    if (!keeps_all(chosen, spec.nchannels))
        keep_channels(photo.pixels, chosen, spec.nchannels, value);
}

/// The photo's window, from the stored row `top` on, in whole tiles or strips.
void decode_bands(const std::string& path, ImageInput& input, const ImageSpec& spec,
                  const std::vector<int>& chosen, int top, const Photo& photo,
                  const std::function<void(const Photo& band)>& take) {
    const int together = rows_together(spec);
    const int rows = (kBandRows + together - 1) / together * together;
    const int last = photo.window.y + photo.window.size.height;
    for (int y = photo.window.y; y < last;) {
        const int end = std::min(last, top + ((y - top) / rows + 1) * rows);
        Photo band = band_of(photo, y, end);
        decode_pixels(path, input, spec, chosen, y - top, end - top, band);
        take(band);
        y = end;
    }
}

}  // namespace

Photo decode(const std::string& path, const FileProbe& probe, const DecodeRequest& request) {
    if (const auto claimed = claimed_size(probe))
        check_size(path, claimed->first, claimed->second, request.max_pixels);
    if (probe.plugin == "jpeg" && !request.header_only) check_jpeg_is_whole(path, probe.size);
    if (probe.plugin == "png" && !request.header_only) check_png_is_whole(path);
    if (probe.plugin == "tiff" && !request.header_only) check_tiff_is_whole(path, probe.size);
    const auto input = open(path, probe);
    const ImageSpec spec = input->spec();
    check_spec(path, spec, request.max_pixels);
    const std::vector<int> chosen =
        request.channel.empty() ? select_channels(spec) : own_channel(spec, request.channel);
    if (chosen.empty()) return {};
    Photo photo = describe(path, probe, spec, chosen, request.max_pixels);
    const int orientation = spec.get_int_attribute("Orientation", 1);
    const auto rows = stored_rows(request.rows, orientation, photo.display.height);
    const auto [first, last] = wanted_rows(photo.window, rows);
    const int top = photo.window.y;
    photo.window.y = first;
    photo.window.size.height = last - first;
    // RAW is developed as a whole anyway.
    const bool in_bands = request.bands && orientation == 1 && !probe.raw;
    if (!request.header_only && in_bands)
        decode_bands(path, *input, spec, chosen, top, photo, request.bands);
    else if (!request.header_only && first < last)
        decode_pixels(path, *input, spec, chosen, first - top, last - top, photo);
    if (!request.header_only && last - first < spec.height)
        check_outermost_rows(path, probe, *input, spec);
    make_upright(photo, orientation);
    return photo;
}

}  // namespace chromeball::io::oiio
