#include "io/write.h"

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <new>

#include "io/encoders.h"
#include "io/messages.h"
#include "io/whole_file.h"

namespace chromeball {
namespace {

/// What a format can hold. `name` is the usual extension, `others` more of them.
struct FormatRow {
    FileFormat format;
    std::string_view name;
    std::array<std::string_view, 2> others;
    bool alpha;
    bool associated;  ///< colour is stored multiplied by alpha
    bool confidence;
    bool single;  ///< one grey channel is possible
};
constexpr FormatRow kFormats[] = {
    {FileFormat::exr, "exr", {"sxr", ""}, true, true, true, true},
    {FileFormat::hdr, "hdr", {"rgbe", "pic"}, false, true, false, false},
    {FileFormat::tif, "tif", {"tiff", ""}, true, false, true, true},
    {FileFormat::png, "png", {"", ""}, true, false, false, true},
    {FileFormat::jpg, "jpg", {"jpeg", "jpe"}, false, true, false, true},
};

const FormatRow& row_of(FileFormat format) {
    return *std::ranges::find(kFormats, format, &FormatRow::format);
}

PixelType stored_type(const WriteOptions& options) {
    switch (options.format) {
        case FileFormat::exr:
            return options.full_float ? PixelType::f32 : PixelType::f16;
        case FileFormat::hdr:
            return PixelType::f32;
        case FileFormat::jpg:
            return PixelType::u8;
        case FileFormat::tif:
            if (options.full_float) return PixelType::f32;
            [[fallthrough]];
        case FileFormat::png:
            return options.bits == 8 ? PixelType::u8 : PixelType::u16;
    }
    return PixelType::f32;
}

struct Range {
    float low, high;
};

Range range_of(FileFormat format, PixelType type) {
    constexpr float kMostFloat = std::numeric_limits<float>::max();
    if (is_integer(type)) return {0, 1};
    if (type == PixelType::f16) return {-65504, 65504};
    // RGBE: eight bits of mantissa below 2^127, no sign.
    if (format == FileFormat::hdr) return {0, std::ldexp(255.0f / 256.0f, 127)};
    return {-kMostFloat, kMostFloat};
}

/// A value that the format can hold, counting what had to be done to it.
float fitted(float value, Range range, WriteReport& report) {
    if (!std::isfinite(value)) {
        ++report.repaired;
        return value > 0 ? range.high : 0;  // false for NaN
    }
    if (value > range.high) ++report.clamped;
    return std::clamp(value, range.low, range.high);
}

/// Colour as it was before it was multiplied by alpha.
void unassociate(float* pixel, int colors) {
    const float alpha = pixel[colors];
    if (!(alpha > 0) || !std::isfinite(alpha)) return;
    for (int c = 0; c < colors; ++c) {
        // NaN and infinities are for `fitted` to see; a quotient may overflow into one of its own.
        if (!std::isfinite(pixel[c])) continue;
        const float quotient = pixel[c] / alpha;
        pixel[c] = std::clamp(quotient, std::numeric_limits<float>::lowest(),
                              std::numeric_limits<float>::max());
    }
}

/// Appends values in a stored type.
class Packer {
public:
    Packer(PixelType type, std::size_t count) : type_(type) {
        bytes_.reserve(count * bytes_per_value(type));
    }
    void put(float value) {
        switch (type_) {
            case PixelType::u8:
                append(static_cast<std::uint8_t>(value * 255.0f + 0.5f));
                break;
            case PixelType::u16:
                append(static_cast<std::uint16_t>(value * 65535.0f + 0.5f));
                break;
            case PixelType::f16:
                append(Imath::half(value).bits());
                break;
            case PixelType::f32:
                append(value);
                break;
        }
    }
    io::Bytes take() { return std::move(bytes_); }

private:
    template <class T>
    void append(T value) {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + sizeof value);
        std::memcpy(bytes_.data() + at, &value, sizeof value);
    }
    PixelType type_;
    io::Bytes bytes_;
};

/// Which of the image's channels are written; grey is repeated where a format needs three.
struct Shape {
    int colors, alpha, confidence;  ///< of the image; alpha and confidence 0 or 1
    bool write_alpha, write_confidence, repeat_grey;
    int written() const {
        return (repeat_grey ? 3 : colors) + (write_alpha ? 1 : 0) + (write_confidence ? 1 : 0);
    }
};

Shape shape_of(const FormatRow& format, int channels, const WriteOptions& options) {
    Shape shape{};
    shape.confidence = options.confidence ? 1 : 0;
    const int rest = channels - shape.confidence;
    assert(rest == 1 || rest == 3 || rest == 4);
    shape.alpha = rest == 4 ? 1 : 0;
    shape.colors = rest - shape.alpha;
    shape.write_alpha = shape.alpha && format.alpha;
    shape.write_confidence = shape.confidence && format.confidence;
    shape.repeat_grey = shape.colors == 1 && !format.single;
    return shape;
}

io::Values prepare(ImageView<const float> image, const WriteOptions& options, WriteReport& report) {
    const FormatRow& format = row_of(options.format);
    const Shape shape = shape_of(format, image.channels, options);
    io::Values values;
    values.size = image.size;
    values.type = stored_type(options);
    values.channels = shape.written();
    values.colors = shape.repeat_grey ? 3 : shape.colors;
    values.alpha = shape.write_alpha;
    const Range range = range_of(options.format, values.type);
    constexpr Range kShare{0, 1};  // of alpha and confidence
    const int copies = shape.repeat_grey ? 3 : 1;
    Packer packer(values.type, image.size.pixels() * static_cast<std::size_t>(values.channels));
    std::array<float, 5> pixel{};
    for (int y = 0; y < image.size.height; ++y) {
        const float* in = image.row(y);
        for (int x = 0; x < image.size.width; ++x, in += image.channels) {
            std::copy_n(in, image.channels, pixel.begin());
            if (shape.write_alpha && !format.associated) unassociate(pixel.data(), shape.colors);
            for (int c = 0; c < shape.colors; ++c) {
                const float value = fitted(pixel[static_cast<std::size_t>(c)], range, report);
                for (int copy = 0; copy < copies; ++copy) packer.put(value);
            }
            const float* rest = pixel.data() + shape.colors;
            if (shape.write_alpha) packer.put(fitted(rest[0], kShare, report));
            if (shape.write_confidence) packer.put(fitted(rest[shape.alpha], kShare, report));
        }
    }
    values.data = packer.take();
    return values;
}

}  // namespace

std::optional<FileFormat> format_from_extension(std::string_view extension) {
    if (extension.starts_with('.')) extension.remove_prefix(1);
    if (extension.empty()) return std::nullopt;
    std::string lower(extension);
    std::ranges::transform(lower, lower.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const FormatRow& row : kFormats)
        if (row.name == lower || std::ranges::find(row.others, lower) != row.others.end())
            return row.format;
    return std::nullopt;
}

std::string_view extension_of(FileFormat format) { return row_of(format).name; }

WriteReport write_image(const std::string& path, ImageView<const float> image,
                        const WriteOptions& options) {
    io::check_target(path);
    if (image.size.width <= 0 || image.size.height <= 0)
        throw io::failure(path, "there are no pixels to write");
    try {
        WriteReport report;
        const io::Values values = prepare(image, options, report);
        io::write_whole_file(path, options.format == FileFormat::exr
                                       ? io::encode_exr(path, values, options)
                                       : io::encode_with_oiio(path, values, options));
        return report;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw io::failure(path, "not enough memory to encode it; choose a smaller size");
    } catch (const std::exception& e) {
        throw io::failure(path, fmt::format("cannot be encoded: {}; try another format", e.what()));
    }
}

void check_target(const std::string& path) { io::check_target(path); }

}  // namespace chromeball
