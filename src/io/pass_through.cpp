#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/fact_names.h"
#include "io/facts.h"

namespace chromeball {
namespace io {

// OpenEXR, "Standard Attributes"; EXIF 2.32; SMPTE 268M (DPX). Places on the map (GPS) are not
// taken out of EXIF: who wants to publish a map need not publish where it was taken.
constexpr FactName kFactNames[] = {
    {"timeCode", "timecode", "smpte:TimeCode"},
    {"keyCode", "keycode", "smpte:KeyCode"},
    {"framesPerSecond", "rational", "FramesPerSecond"},
    {"framesPerSecond", "rational", "dpx:FrameRate"},
    {"framesPerSecond", "rational", "dpx:TemporalFrameRate"},
    {"reelName", "string", "dpx:SourceImageFileName"},
    {"imageCounter", "int", "dpx:FramePosition"},
    {"expTime", "float", "ExposureTime"},
    {"expTime", "float", "Exif:ExposureTime"},
    {"aperture", "float", "FNumber"},
    {"aperture", "float", "Exif:FNumber"},
    {"tStop", "float", ""},
    {"shutterAngle", "float", "dpx:ShutterAngle"},
    {"isoSpeed", "float", "Exif:PhotographicSensitivity"},
    {"isoSpeed", "float", "Exif:ISOSpeedRatings"},
    {"focus", "float", "Exif:SubjectDistance"},
    {"nominalFocalLength", "float", "Exif:FocalLength"},
    {"pinholeFocalLength", "float", ""},
    {"effectiveFocalLength", "float", ""},
    {"entrancePupilOffset", "float", ""},
    {"sensorOverallDimensions", "v2f", ""},
    {"sensorPhotositePitch", "float", ""},
    {"sensorCenterOffset", "v2f", ""},
    {"sensorAcquisitionRectangle", "box2i", ""},
    {"cameraMake", "string", "Make"},
    {"cameraModel", "string", "Model"},
    {"cameraSerialNumber", "string", "Exif:BodySerialNumber"},
    {"cameraFirmwareVersion", "string", ""},
    {"cameraUuid", "string", ""},
    {"cameraLabel", "string", ""},
    {"cameraCCTSetting", "float", ""},
    {"cameraTintSetting", "float", ""},
    {"lensMake", "string", "Exif:LensMake"},
    {"lensModel", "string", "Exif:LensModel"},
    {"lensSerialNumber", "string", "Exif:LensSerialNumber"},
    {"lensFirmwareVersion", "string", ""},
    {"capDate", "string", "Exif:DateTimeOriginal"},
    {"capDate", "string", "DateTime"},
    {"utcOffset", "float", ""},
    {"longitude", "float", ""},
    {"latitude", "float", ""},
    {"altitude", "float", ""},
    {"owner", "string", "Copyright"},
    {"worldToCamera", "m44f", ""},
    {"worldToNDC", "m44f", ""},
    {"whiteLuminance", "float", ""},
    {"adoptedNeutral", "v2f", ""},
};

std::span<const FactName> fact_names() { return kFactNames; }

}  // namespace io

namespace {

/// A frame rate as the fraction that is meant: n/1 or n/1001 where that is what it rounds to.
std::vector<double> rational_of(double value) {
    for (const double denominator : {1.0, 1001.0}) {
        const double numerator = std::round(value * denominator);
        const bool ntsc = denominator == 1 || std::fmod(numerator, 1000) == 0;
        if (ntsc && std::abs(numerator / denominator - value) < 1e-4)
            return {numerator, denominator};
    }
    const long numerator = std::lround(value * 1000);
    const long common = std::gcd(numerator, 1000L);
    return {static_cast<double>(numerator / common), static_cast<double>(1000 / common)};
}

bool is_number_type(std::string_view type) {
    return type == "int" || type == "float" || type == "double";
}

/// The attribute under its standard name and type; nothing where it says nothing usable.
std::optional<Attribute> renamed(const Attribute& from, const io::FactName& to) {
    Attribute out{std::string(to.exr), std::string(to.type), from.numbers, from.text};
    if (to.type == "string") {
        if (from.type != "string" || from.text.empty()) return std::nullopt;
        return out;
    }
    if (from.type == to.type) return out;
    if (from.numbers.empty() || !is_number_type(from.type)) return std::nullopt;
    const double value = from.numbers.front();
    if (!std::isfinite(value) || value <= 0 || value > 1e9) return std::nullopt;
    if (to.type == "rational")
        out.numbers = rational_of(value);
    else if (is_number_type(to.type))
        out.numbers = {value};
    else
        return std::nullopt;
    return out;
}

}  // namespace

Metadata pass_through(const Metadata& metadata) {
    Metadata passed;
    for (const io::FactName& fact : io::fact_names()) {
        if (passed.find(fact.exr)) continue;
        const Attribute* found = metadata.find(fact.exr);
        if (!found && !fact.other.empty()) found = metadata.find(fact.other);
        if (!found) continue;
        if (auto attribute = renamed(*found, fact)) passed.set(std::move(*attribute));
    }
    return passed;
}

}  // namespace chromeball
