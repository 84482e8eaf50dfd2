#include "io/exif.h"

#include <libexif/exif-data.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>

namespace chromeball::io {
namespace {

struct Tag {
    std::uint32_t number;
    std::string_view name;
};

// EXIF 2.32, tables 4, 7 and 8; in the order of their numbers.
constexpr Tag kTags[] = {
    {269, "DocumentName"},
    {270, "ImageDescription"},
    {271, "Make"},
    {272, "Model"},
    {305, "Software"},
    {306, "DateTime"},
    {315, "Artist"},
    {316, "HostComputer"},
    {33432, "Copyright"},
    {33434, "ExposureTime"},
    {33437, "FNumber"},
    {34850, "Exif:ExposureProgram"},
    {34852, "Exif:SpectralSensitivity"},
    {34855, "Exif:PhotographicSensitivity"},
    {34864, "Exif:SensitivityType"},
    {34865, "Exif:StandardOutputSensitivity"},
    {34866, "Exif:RecommendedExposureIndex"},
    {34867, "Exif:ISOSpeed"},
    {36864, "Exif:ExifVersion"},
    {36867, "Exif:DateTimeOriginal"},
    {36868, "Exif:DateTimeDigitized"},
    {36880, "Exif:OffsetTime"},
    {36881, "Exif:OffsetTimeOriginal"},
    {36882, "Exif:OffsetTimeDigitized"},
    {37122, "Exif:CompressedBitsPerPixel"},
    {37377, "Exif:ShutterSpeedValue"},
    {37378, "Exif:ApertureValue"},
    {37379, "Exif:BrightnessValue"},
    {37380, "Exif:ExposureBiasValue"},
    {37381, "Exif:MaxApertureValue"},
    {37382, "Exif:SubjectDistance"},
    {37383, "Exif:MeteringMode"},
    {37384, "Exif:LightSource"},
    {37385, "Exif:Flash"},
    {37386, "Exif:FocalLength"},
    {40961, "Exif:ColorSpace"},
    {40962, "Exif:PixelXDimension"},
    {40963, "Exif:PixelYDimension"},
    {41486, "Exif:FocalPlaneXResolution"},
    {41487, "Exif:FocalPlaneYResolution"},
    {41488, "Exif:FocalPlaneResolutionUnit"},
    {41493, "Exif:ExposureIndex"},
    {41495, "Exif:SensingMethod"},
    {41985, "Exif:CustomRendered"},
    {41986, "Exif:ExposureMode"},
    {41987, "Exif:WhiteBalance"},
    {41988, "Exif:DigitalZoomRatio"},
    {41989, "Exif:FocalLengthIn35mmFilm"},
    {41990, "Exif:SceneCaptureType"},
    {41991, "Exif:GainControl"},
    {41992, "Exif:Contrast"},
    {41993, "Exif:Saturation"},
    {41994, "Exif:Sharpness"},
    {41996, "Exif:SubjectDistanceRange"},
    {42016, "Exif:ImageUniqueID"},
    {42032, "Exif:CameraOwnerName"},
    {42033, "Exif:BodySerialNumber"},
    {42034, "Exif:LensSpecification"},
    {42035, "Exif:LensMake"},
    {42036, "Exif:LensModel"},
    {42037, "Exif:LensSerialNumber"},
    {42240, "Exif:Gamma"},
};
/// libexif's entry with bounds: its numbers by their places.
class Entry {
public:
    Entry(const ExifEntry& entry, ExifByteOrder order)
        : entry_(entry), order_(order), step_(exif_format_get_size(entry.format)) {}

    /// 0 where its values are not all there.
    std::size_t count() const {
        return step_ > 0 && entry_.data && entry_.components <= entry_.size / step_
                   ? entry_.components
                   : 0;
    }
    bool is_ratio() const {
        return entry_.format == EXIF_FORMAT_RATIONAL || entry_.format == EXIF_FORMAT_SRATIONAL;
    }
    bool is_text() const {
        constexpr std::size_t kVersionDigits = 4;  // EXIF's own version
        return entry_.format == EXIF_FORMAT_ASCII ||
               (entry_.format == EXIF_FORMAT_UNDEFINED && count() == kVersionDigits);
    }
    std::string text() const {
        const std::string_view all(reinterpret_cast<const char*>(entry_.data), count());
        return std::string(all.substr(0, all.find('\0')));
    }
    /// Nothing for formats that hold no numbers.
    std::optional<double> number(std::size_t i) const {
        const unsigned char* at = entry_.data + i * step_;
        switch (entry_.format) {
            case EXIF_FORMAT_BYTE:
                return *at;
            case EXIF_FORMAT_SHORT:
                return exif_get_short(at, order_);
            case EXIF_FORMAT_LONG:
                return exif_get_long(at, order_);
            case EXIF_FORMAT_SLONG:
                return exif_get_slong(at, order_);
            case EXIF_FORMAT_RATIONAL: {
                const ExifRational r = exif_get_rational(at, order_);
                return ratio(r.numerator, r.denominator);
            }
            case EXIF_FORMAT_SRATIONAL: {
                const ExifSRational r = exif_get_srational(at, order_);
                return ratio(r.numerator, r.denominator);
            }
            default:
                return std::nullopt;
        }
    }

private:
    /// 0 for what has no value; single precision, as all such numbers are handed on.
    static double ratio(double over, double under) {
        return under == 0 ? 0 : static_cast<double>(static_cast<float>(over / under));
    }

    const ExifEntry& entry_;
    ExifByteOrder order_;
    std::size_t step_;
};

std::optional<Attribute> attribute_of(const Entry& entry, std::string_view name) {
    Attribute attribute{std::string(name), {}, {}, {}};
    const std::size_t count = entry.count();
    if (count == 0) return std::nullopt;
    if (entry.is_text()) {
        attribute.type = "string";
        attribute.text = entry.text();
        return attribute;
    }
    constexpr std::size_t kMostNumbers = 4;  // a zoom lens
    if (count > kMostNumbers || (count > 1 && !entry.is_ratio())) return std::nullopt;
    attribute.type = count > 1 ? "floatvector" : entry.is_ratio() ? "float" : "int";
    for (std::size_t i = 0; i < count; ++i) {
        const auto number = entry.number(i);
        if (!number) return std::nullopt;
        attribute.numbers.push_back(*number);
    }
    return attribute;
}

std::optional<double> whole_number(const Entry& entry) {
    return entry.count() == 1 && !entry.is_ratio() ? entry.number(0) : std::nullopt;
}

void take(const Entry& entry, std::uint32_t tag, Exif& exif) {
    if (const auto number = whole_number(entry)) {
        if (tag == EXIF_TAG_ORIENTATION && *number >= 1 && *number <= 8)
            exif.orientation = static_cast<int>(*number);
        if (tag == EXIF_TAG_COLOR_SPACE) exif.srgb = *number == 1;
    }
    const auto* known = std::ranges::find(kTags, tag, &Tag::number);
    if (known == std::end(kTags)) return;
    if (auto attribute = attribute_of(entry, known->name)) exif.metadata.set(std::move(*attribute));
}

using Data = std::unique_ptr<ExifData, decltype(&exif_data_unref)>;

Data parsed(std::span<const std::byte> tiff) {
    Data data(exif_data_new(), &exif_data_unref);
    if (!data) throw std::bad_alloc();
    // Values as the camera wrote them, of tags that libexif may not know.
    exif_data_unset_option(data.get(), EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);
    exif_data_unset_option(data.get(), EXIF_DATA_OPTION_IGNORE_UNKNOWN_TAGS);
    std::string bytes("Exif\0\0", 6);  // libexif wants what a JPEG holds
    bytes.append(reinterpret_cast<const char*>(tiff.data()), tiff.size());
    constexpr std::size_t kMost = 0xffff;  // more than a JPEG can hold is pictures
    exif_data_load_data(data.get(), reinterpret_cast<const unsigned char*>(bytes.data()),
                        static_cast<unsigned>(std::min(bytes.size(), kMost)));
    return data;
}

}  // namespace

Exif read_exif(std::span<const std::byte> tiff) {
    Exif exif;
    const Data data = parsed(tiff);
    const ExifByteOrder order = exif_data_get_byte_order(data.get());
    for (const ExifIfd part : {EXIF_IFD_0, EXIF_IFD_EXIF}) {
        const ExifContent* content = data->ifd[part];
        for (unsigned i = 0; content && i < content->count; ++i) {
            const ExifEntry& entry = *content->entries[i];
            take(Entry(entry, order), entry.tag, exif);
        }
    }
    return exif;
}

}  // namespace chromeball::io
