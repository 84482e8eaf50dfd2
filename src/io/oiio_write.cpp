#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "io/channel_names.h"
#include "io/encoders.h"
#include "io/fact_names.h"
#include "io/messages.h"
#include "io/oiio_doors.h"
#include "io/oiio_types.h"

namespace chromeball::io::oiio {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// The attribute that holds chromeball's own provenance, and its place in formats that know
/// only a description.
constexpr std::string_view kOwn = "chromeball";

std::string_view plugin_of(FileFormat format) {
    switch (format) {
        case FileFormat::hdr:
            return "hdr";
        case FileFormat::jpg:
            return "jpeg";
        default:
            return "tiff";
    }
}

void name_channels(ImageSpec& spec, const Values& values) {
    spec.channelnames = values.colors == 1 ? std::vector<std::string>{"Y"}
                                           : std::vector<std::string>{"R", "G", "B"};
    spec.alpha_channel = -1;
    if (values.alpha) {
        spec.alpha_channel = values.colors;
        spec.channelnames.emplace_back("A");
    }
    if (static_cast<int>(spec.channelnames.size()) < values.channels)
        spec.channelnames.emplace_back("confidence");
}

/// The facts that have a place of their own in these formats, under their names there.
void add_facts(ImageSpec& spec, const Metadata& metadata) {
    for (const FactName& fact : fact_names()) {
        const Attribute* attribute = metadata.find(fact.exr);
        const std::string other(fact.other);
        if (!attribute || other.empty() || spec.find_attribute(other)) continue;
        // DPX names have no place in these formats; a date is the photo's, not the file's.
        if (other.starts_with("dpx:") || other.starts_with("smpte:") || other == "DateTime")
            continue;
        if (attribute->type == "string")
            spec.attribute(other, attribute->text);
        else if (attribute->numbers.size() == 1)
            spec.attribute(other, static_cast<float>(attribute->numbers[0]));
    }
}

ImageSpec spec_of(const Values& values, const WriteOptions& options) {
    ImageSpec spec(values.size.width, values.size.height, values.channels,
                   type_desc_of(values.type));
    name_channels(spec, values);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (options.format == FileFormat::jpg) {
        spec.attribute("CompressionQuality", 95);
        spec.attribute("jpeg:subsampling", "4:4:4");
    }
    if (options.format == FileFormat::tif) {
        // OpenImageIO puts the time of day where there is no date, and its EXIF directory
        // overwrites the picture's when it writes to memory.
        spec.attribute("DateTime", "");
        spec.attribute("tiff:write_exif", 0);
        spec.attribute("compression", "zip");
    }
    if (options.format != FileFormat::hdr) add_facts(spec, options.metadata);
    if (options.format == FileFormat::jpg && is_encoded_srgb(options.color))
        spec.attribute("Exif:ColorSpace", 1);
    auto own = options.metadata.text(kOwn);
    if (options.confidence && options.format == FileFormat::tif)
        own = with_channel_names(own.value_or(""), spec.channelnames);
    if (own) spec.attribute("ImageDescription", fmt::format("{} {}", kOwn, *own));
    return spec;
}

/// Radiance's header is lines of text after its first one; OpenImageIO writes none of its own.
void add_radiance_lines(Bytes& file, const WriteOptions& options) {
    std::string lines;
    if (options.color.chromaticities) {
        lines += "PRIMARIES=";
        for (const double number : *options.color.chromaticities)
            lines += fmt::format(" {:.6g}", number);
        lines += '\n';
    }
    // Short lines, as some readers have small buffers.
    constexpr std::size_t kLineLength = 80;
    const std::string own = options.metadata.text(kOwn).value_or("");
    for (std::size_t at = 0; at < own.size(); at += kLineLength)
        lines += fmt::format("# {}: {}\n", kOwn, own.substr(at, kLineLength));
    const auto first = std::ranges::find(file, std::byte{'\n'});
    if (first == file.end()) return;
    const auto bytes = std::as_bytes(std::span(lines));
    file.insert(first + 1, bytes.begin(), bytes.end());
}

}  // namespace

Bytes encode(const std::string& path, const Values& values, const WriteOptions& options,
             WriteReport& report) {
    const std::string plugin(plugin_of(options.format));
    const auto give_up = [&](const std::string& reason) {
        return failure(path, fmt::format("cannot be encoded as {}: {}; try another format or size",
                                         plugin, reason));
    };
    OIIO::Filesystem::IOVecOutput memory;
    const auto output = OIIO::ImageOutput::create(plugin);
    if (!output || !output->supports("ioproxy") || !output->set_ioproxy(&memory)) {
        OIIO::geterror();  // clears it
        throw give_up("this OpenImageIO does not write it");
    }
    const ImageSpec spec = spec_of(values, options);
    Bytes pixels(values.row_bytes() * static_cast<std::size_t>(values.size.height));
    store_rows(values, 0, values.size.height, pixels.data(), report);
    const bool good = output->open(path, spec) && output->write_image(spec.format, pixels.data()) &&
                      output->close();
    if (!good) throw give_up(output->geterror());
    const auto bytes = std::as_bytes(std::span(memory.buffer()));
    Bytes file(bytes.begin(), bytes.end());
    if (options.format == FileFormat::hdr) add_radiance_lines(file, options);
    return file;
}

}  // namespace chromeball::io::oiio
