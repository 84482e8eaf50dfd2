#include "io/exif.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes.h"

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
constexpr std::uint32_t kOrientation = 274, kExifDirectory = 34665, kColorSpace = 40961;

// TIFF 6.0, the types of values.
enum Type : std::uint32_t {
    kByte = 1,
    kAscii = 2,
    kShort = 3,
    kLong = 4,
    kRational = 5,
    kUndefined = 7,
    kSignedLong = 9,
    kSignedRational = 10
};

std::size_t size_of(std::uint32_t type) {
    switch (type) {
        case kByte:
        case kAscii:
        case kUndefined:
            return 1;
        case kShort:
            return 2;
        case kLong:
        case kSignedLong:
            return 4;
        case kRational:
        case kSignedRational:
            return 8;
        default:
            return 0;
    }
}

/// A tag and where its values are.
struct Entry {
    std::uint32_t tag = 0, type = 0;
    std::size_t count = 0;
    std::span<const std::byte> values;
};

class Directories {
public:
    explicit Directories(std::span<const std::byte> tiff)
        : tiff_(tiff), big_(starts_with(tiff, 0, "MM")) {}

    /// Calls work(entry) for all of the first directory and of EXIF's own.
    template <class Work>
    void for_each(const Work& work) const {
        if (tiff_.size() < 8 || u16(0 + 2) != 42) return;
        std::size_t exif = 0;
        walk(u32(4), [&](const Entry& entry) {
            if (entry.tag == kExifDirectory && entry.type == kLong && entry.count == 1)
                exif = static_cast<std::size_t>(number(entry, 0));
            work(entry);
        });
        if (exif > 0) walk(exif, work);
    }

    double number(const Entry& entry, std::size_t i) const {
        const auto at =
            static_cast<std::size_t>(entry.values.data() - tiff_.data()) + i * size_of(entry.type);
        switch (entry.type) {
            case kByte:
                return byte_at(tiff_, at);
            case kShort:
                return u16(at);
            case kLong:
                return u32(at);
            case kSignedLong:
                return static_cast<std::int32_t>(u32(at));
            case kRational:
                return ratio(u32(at), u32(at + 4));
            case kSignedRational:
                return ratio(static_cast<std::int32_t>(u32(at)),
                             static_cast<std::int32_t>(u32(at + 4)));
            default:
                return 0;
        }
    }

private:
    /// 0 for what has no value; single precision, as all such numbers are handed on.
    static double ratio(double over, double under) {
        return under == 0 ? 0 : static_cast<double>(static_cast<float>(over / under));
    }
    std::uint32_t u16(std::size_t at) const {
        return big_ ? big_endian_16(tiff_, at) : little_endian_16(tiff_, at);
    }
    std::uint32_t u32(std::size_t at) const {
        return big_ ? big_endian_32(tiff_, at) : little_endian_32(tiff_, at);
    }

    template <class Work>
    void walk(std::size_t directory, const Work& work) const {
        constexpr std::size_t kEntry = 12, kInside = 4;
        if (directory > tiff_.size() || tiff_.size() - directory < 2) return;
        const std::size_t entries = u16(directory);
        for (std::size_t i = 0; i < entries; ++i) {
            const std::size_t at = directory + 2 + kEntry * i;
            if (at + kEntry > tiff_.size()) return;
            Entry entry{u16(at), u16(at + 2), u32(at + 4), {}};
            const std::size_t size = size_of(entry.type);
            if (size == 0 || entry.count == 0 || entry.count > tiff_.size() / size) continue;
            const std::size_t bytes = size * entry.count;
            const std::size_t from = bytes > kInside ? u32(at + 8) : at + 8;
            if (from > tiff_.size() || tiff_.size() - from < bytes) continue;
            entry.values = tiff_.subspan(from, bytes);
            work(entry);
        }
    }

    std::span<const std::byte> tiff_;
    bool big_;
};

/// Text up to its end.
std::string text_of(const Entry& entry) {
    const std::string_view all(reinterpret_cast<const char*>(entry.values.data()),
                               entry.values.size());
    return std::string(all.substr(0, all.find('\0')));
}

std::optional<Attribute> attribute_of(const Directories& file, const Entry& entry,
                                      std::string_view name) {
    Attribute attribute{std::string(name), {}, {}, {}};
    constexpr std::size_t kVersionDigits = 4;  // EXIF's own version
    if (entry.type == kAscii || (entry.type == kUndefined && entry.count == kVersionDigits)) {
        attribute.type = "string";
        attribute.text = text_of(entry);
        return attribute;
    }
    constexpr std::size_t kMostNumbers = 4;  // a zoom lens
    if (entry.type == kUndefined || entry.count > kMostNumbers) return std::nullopt;
    const bool ratio = entry.type == kRational || entry.type == kSignedRational;
    if (entry.count > 1 && !ratio) return std::nullopt;
    attribute.type = entry.count > 1 ? "floatvector" : ratio ? "float" : "int";
    for (std::size_t i = 0; i < entry.count; ++i)
        attribute.numbers.push_back(file.number(entry, i));
    return attribute;
}

}  // namespace

Exif read_exif(std::span<const std::byte> tiff) {
    Exif exif;
    if (!starts_with(tiff, 0, "II") && !starts_with(tiff, 0, "MM")) return exif;
    const Directories file(tiff);
    file.for_each([&](const Entry& entry) {
        const bool one_number = entry.count == 1 && (entry.type == kShort || entry.type == kLong);
        if (entry.tag == kOrientation && one_number) {
            const double value = file.number(entry, 0);
            if (value >= 1 && value <= 8) exif.orientation = static_cast<int>(value);
        }
        if (entry.tag == kColorSpace && one_number) exif.srgb = file.number(entry, 0) == 1;
        const auto* known = std::ranges::find(kTags, entry.tag, &Tag::number);
        if (known == std::end(kTags)) return;
        if (auto attribute = attribute_of(file, entry, known->name))
            exif.metadata.set(std::move(*attribute));
    });
    return exif;
}

}  // namespace chromeball::io
