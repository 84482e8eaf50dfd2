#include "io/write.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <new>
#include <span>

#include "io/encoders.h"
#include "io/messages.h"
#include "io/store.h"
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

/// A value that the format can hold, counting what had to be done to it. No branches, as it is
/// done to every number of a map.
float fitted(float value, Range range, WriteReport& report) {
    constexpr std::uint32_t kExponent = 0x7f800000u;  // all set: NaN or infinite
    const bool finite = (std::bit_cast<std::uint32_t>(value) & kExponent) != kExponent;
    report.repaired += !finite;
    // What rounding leaves above, of a mean of ones or an alpha, is nobody's loss.
    constexpr float kRounding = 1.00001F;
    report.clamped += finite && value > range.high * kRounding;
    const float repaired = finite ? value : value > 0 ? range.high : 0;  // NaN is not above 0
    return std::min(std::max(repaired, range.low), range.high);
}

/// Colour as it was before it was multiplied by alpha.
void unassociate(float* pixel, int colors) {
    const float alpha = pixel[colors];
    if (!(alpha > 0) || !std::isfinite(alpha) || alpha == 1) return;
    for (int c = 0; c < colors; ++c) {
        // NaN and infinities are for `fitted` to see; a quotient may overflow into one of its own.
        if (!std::isfinite(pixel[c])) continue;
        const float quotient = pixel[c] / alpha;
        pixel[c] = std::clamp(quotient, std::numeric_limits<float>::lowest(),
                              std::numeric_limits<float>::max());
    }
}

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

/// Rows as the file gets them, still in floats.
class RowFitter {
public:
    RowFitter(const FormatRow& format, const Shape& shape, PixelType type)
        : shape_(shape),
          divide_(shape.write_alpha && !format.associated),
          range_(range_of(format.format, type)) {}

    /// Whether a row can be stored as it is: all of its values fit, and there is nothing to divide,
    /// repeat or leave out. So are nearly all, and asking costs a fraction of fitting.
    bool fits(const float* in, int channels, std::size_t values) const {
        if (shape_.written() != channels || shape_.repeat_grey) return false;
        switch (channels) {
            case 1:
                return row_fits<1>(in, values);
            case 2:
                return row_fits<2>(in, values);
            case 3:
                return row_fits<3>(in, values);
            case 4:
                return row_fits<4>(in, values);
            default:
                return row_fits<5>(in, values);
        }
    }

    /// channels: of the image, 1 to 5
    void fit(const float* in, int channels, std::span<float> out, WriteReport& report) const {
        switch (channels) {  // known to the compiler the loops over them cost nothing
            case 1:
                return fit_row<1>(in, out, report);
            case 2:
                return fit_row<2>(in, out, report);
            case 3:
                return fit_row<3>(in, out, report);
            case 4:
                return fit_row<4>(in, out, report);
            default:
                return fit_row<5>(in, out, report);
        }
    }

private:
    template <int kChannels>
    bool row_fits(const float* in, std::size_t values) const {
        // The same limits for some pixels in a row, so that many numbers are asked at a time.
        constexpr std::size_t kTogether = std::size_t{16} * kChannels;
        std::array<float, kTogether> low, high;
        for (std::size_t i = 0; i < kTogether; ++i) {
            const int channel = static_cast<int>(i) % kChannels;
            const bool color = channel < shape_.colors;
            const bool divisor = divide_ && channel == shape_.colors;
            low[i] = color ? range_.low : divisor ? 1 : 0;
            high[i] = color ? range_.high : 1;
        }
        const auto misfits = [&](const float* at, std::size_t count) {
            int bad = 0;
            for (std::size_t i = 0; i < count; ++i)  // so that NaN is one
                bad |= !(at[i] >= low[i]) | !(at[i] <= high[i]);
            return bad;
        };
        int bad = 0;
        std::size_t done = 0;
        for (; done + kTogether <= values; done += kTogether) bad |= misfits(in + done, kTogether);
        return (bad | misfits(in + done, values - done)) == 0;
    }

    template <int kChannels>
    void fit_row(const float* in, std::span<float> out, WriteReport& total) const {
        constexpr Range kShare{0, 1};  // of alpha and confidence
        WriteReport report;
        const Shape shape = shape_;
        const int copies = shape.repeat_grey ? 3 : 1;
        float* to = out.data();
        for (float* const end = to + out.size(); to != end; in += kChannels) {
            float pixel[kChannels];
            for (int c = 0; c < kChannels; ++c) pixel[c] = in[c];
            if (divide_) unassociate(pixel, shape.colors);
            for (int c = 0; c < std::min(shape.colors, kChannels); ++c) {
                const float value = fitted(pixel[c], range_, report);
                for (int copy = 0; copy < copies; ++copy) *to++ = value;
            }
            const float* rest = pixel + shape.colors;
            if (shape.write_alpha) *to++ = fitted(rest[0], kShare, report);
            if (shape.write_confidence) *to++ = fitted(rest[shape.alpha], kShare, report);
        }
        total.clamped += report.clamped;
        total.repaired += report.repaired;
    }

    Shape shape_;
    bool divide_;  ///< colour is stored as it was before it was multiplied by alpha
    Range range_;
};

io::Values values_of(ImageView<const float> image, const WriteOptions& options) {
    const FormatRow& format = row_of(options.format);
    const Shape shape = shape_of(format, image.channels, options);
    io::Values values;
    values.size = image.size;
    values.type = stored_type(options);
    values.channels = shape.written();
    values.colors = shape.repeat_grey ? 3 : shape.colors;
    values.alpha = shape.write_alpha;
    const RowFitter fitter(format, shape, values.type);
    const std::size_t length = values.row_bytes();
    values.store = [=, type = values.type](int first, int last, std::byte* out) {
        WriteReport report;
        std::vector<float> row(length / bytes_per_value(type));
        for (int y = first; y < last; ++y, out += length) {
            const bool as_it_is = fitter.fits(image.row(y), image.channels, row.size());
            if (!as_it_is) fitter.fit(image.row(y), image.channels, row, report);
            io::store(as_it_is ? std::span(image.row(y), row.size()) : std::span<const float>(row),
                      type, out);
        }
        return report;
    };
    return values;
}

/// The whole file in memory. `name` is for messages.
io::Bytes encoded(const std::string& name, const io::Values& values, const WriteOptions& options,
                  WriteReport& report) {
    switch (options.format) {
        case FileFormat::exr:
            return io::encode_exr(name, values, options, report);
        case FileFormat::png:
            return io::encode_png(values, options, report);
        default:
            return io::encode_with_oiio(name, values, options, report);
    }
}

/// Hands an image's file in memory to `use`; what goes wrong on the way is an Error that names it.
template <class Use>
void encode(const std::string& name, ImageView<const float> image, const WriteOptions& options,
            WriteReport& report, const Use& use) {
    if (image.size.width <= 0 || image.size.height <= 0)
        throw io::failure(name, "there are no pixels to write");
    try {
        use(encoded(name, values_of(image, options), options, report));
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw io::failure(name, "not enough memory to encode it; choose a smaller size");
    } catch (const std::exception& e) {
        throw io::failure(name, fmt::format("cannot be encoded: {}; try another format", e.what()));
    }
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
    WriteReport report;
    encode(path, image, options, report,
           [&](const io::Bytes& file) { io::write_whole_file(path, file); });
    return report;
}

std::vector<std::byte> encode_image(ImageView<const float> image, const WriteOptions& options) {
    io::Bytes bytes;
    WriteReport report;
    encode(fmt::format("a picture as {}", extension_of(options.format)), image, options, report,
           [&](io::Bytes&& file) { bytes = std::move(file); });
    return bytes;
}

void check_target(const std::string& path) { io::check_target(path); }

}  // namespace chromeball
