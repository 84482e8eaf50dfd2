#include "io/exr_attributes.h"

#include <OpenEXR/ImfBoxAttribute.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfEnvmapAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFloatVectorAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfKeyCodeAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTimeCodeAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

namespace chromeball::io {
namespace {

/// What describes the storage of the pixels, has its own place in Photo, or is void once the
/// picture was read upright.
constexpr std::string_view kStructural[] = {"channels",
                                            "chunkCount",
                                            "chromaticities",
                                            "colorInteropID",
                                            "compression",
                                            "dataWindow",
                                            "displayWindow",
                                            "dwaCompressionLevel",
                                            "lineOrder",
                                            "maxSamplesPerPixel",
                                            "name",
                                            "preview",
                                            "screenWindowCenter",
                                            "screenWindowWidth",
                                            "tiles",
                                            "type",
                                            "version",
                                            "view",
                                            "multiView",
                                            "Orientation",
                                            "deepImageState",
                                            "idManifest",
                                            "originalDataWindow"};

bool is_structural(std::string_view name) {
    return std::ranges::find(kStructural, name) != std::end(kStructural);
}

// One pair of functions a C++ type: the numbers it holds, and back.

std::vector<double> numbers_of(int v) { return {double(v)}; }
std::vector<double> numbers_of(float v) { return {v}; }
std::vector<double> numbers_of(double v) { return {v}; }
std::vector<double> numbers_of(const Imf::Rational& v) { return {double(v.n), double(v.d)}; }
std::vector<double> numbers_of(const Imf::TimeCode& v) {
    return {double(v.timeAndFlags()), double(v.userData())};
}
std::vector<double> numbers_of(const Imf::KeyCode& v) {
    return {double(v.filmMfcCode()),  double(v.filmType()),   double(v.prefix()),
            double(v.count()),        double(v.perfOffset()), double(v.perfsPerFrame()),
            double(v.perfsPerCount())};
}
std::vector<double> numbers_of(const Imf::FloatVector& v) { return {v.begin(), v.end()}; }
template <class T>
std::vector<double> numbers_of(const Imath::Vec2<T>& v) {
    return {double(v.x), double(v.y)};
}
template <class T>
std::vector<double> numbers_of(const Imath::Vec3<T>& v) {
    return {double(v.x), double(v.y), double(v.z)};
}
template <class T>
std::vector<double> numbers_of(const Imath::Matrix33<T>& v) {
    return {v.getValue(), v.getValue() + 9};
}
template <class T>
std::vector<double> numbers_of(const Imath::Matrix44<T>& v) {
    return {v.getValue(), v.getValue() + 16};
}
template <class T>
std::vector<double> numbers_of(const Imath::Box<Imath::Vec2<T>>& v) {
    return {double(v.min.x), double(v.min.y), double(v.max.x), double(v.max.y)};
}

/// A double as T; what T cannot hold becomes its nearest value, NaN 0 in integers.
template <class T>
T number_as(double value) {
    if constexpr (std::is_integral_v<T>) {
        if (std::isnan(value)) return 0;
        return static_cast<T>(std::clamp(value, double(std::numeric_limits<T>::lowest()),
                                         double(std::numeric_limits<T>::max())));
    } else {
        return static_cast<T>(value);
    }
}

using Numbers = std::vector<double>;

template <class T>
std::optional<T> from_numbers(const Numbers& n) {
    if constexpr (std::is_arithmetic_v<T>) {
        if (n.size() != 1) return std::nullopt;
        return number_as<T>(n[0]);
    } else if constexpr (std::is_same_v<T, Imf::Rational>) {
        if (n.size() != 2) return std::nullopt;
        return Imf::Rational(number_as<int>(n[0]), number_as<unsigned>(n[1]));
    } else if constexpr (std::is_same_v<T, Imf::TimeCode>) {
        if (n.size() != 2) return std::nullopt;
        return Imf::TimeCode(number_as<unsigned>(n[0]), number_as<unsigned>(n[1]));
    } else if constexpr (std::is_same_v<T, Imf::KeyCode>) {
        if (n.size() != 7) return std::nullopt;
        return Imf::KeyCode(number_as<int>(n[0]), number_as<int>(n[1]), number_as<int>(n[2]),
                            number_as<int>(n[3]), number_as<int>(n[4]), number_as<int>(n[5]),
                            number_as<int>(n[6]));
    } else if constexpr (std::is_same_v<T, Imf::FloatVector>) {
        Imf::FloatVector values;
        for (const double v : n) values.push_back(number_as<float>(v));
        return values;
    } else if constexpr (requires(T box) { box.min.x; }) {
        if (n.size() != 4) return std::nullopt;
        using V = decltype(T::min);
        using C = typename V::BaseType;
        return T(V(number_as<C>(n[0]), number_as<C>(n[1])),
                 V(number_as<C>(n[2]), number_as<C>(n[3])));
    } else if constexpr (
        requires(T matrix) { matrix.getValue(); } && requires(T matrix) { matrix[0][0]; }) {
        constexpr std::size_t kCount = sizeof(T) / sizeof(std::declval<T&>()[0][0]);
        if (n.size() != kCount) return std::nullopt;
        T matrix;
        for (std::size_t i = 0; i < kCount; ++i)
            matrix.getValue()[i] = number_as<std::remove_reference_t<decltype(matrix[0][0])>>(n[i]);
        return matrix;
    } else {
        if (n.size() != T::dimensions()) return std::nullopt;
        T vector;
        for (unsigned i = 0; i < T::dimensions(); ++i)
            vector[static_cast<int>(i)] = number_as<typename T::BaseType>(n[i]);
        return vector;
    }
}

/// The types whose numbers are kept. A new one needs its two functions above.
template <class... T>
struct TypeList {};
using NumericTypes =
    TypeList<int, float, double, Imf::Rational, Imf::TimeCode, Imf::KeyCode, Imf::FloatVector,
             Imath::V2i, Imath::V2f, Imath::V2d, Imath::V3i, Imath::V3f, Imath::V3d, Imath::M33f,
             Imath::M33d, Imath::M44f, Imath::M44d, Imath::Box2i, Imath::Box2f>;

template <class T>
bool read_as(const Imf::Attribute& attribute, Attribute& out) {
    const auto* typed = dynamic_cast<const Imf::TypedAttribute<T>*>(&attribute);
    if (typed) out.numbers = numbers_of(typed->value());
    return typed != nullptr;
}

template <class T>
bool write_as(Imf::Header& header, const Attribute& attribute) {
    if (attribute.type != Imf::TypedAttribute<T>::staticTypeName()) return false;
    if (const auto value = from_numbers<T>(attribute.numbers))
        header.insert(attribute.name, Imf::TypedAttribute<T>(*value));
    return true;
}

template <class... T>
bool read_numbers(const Imf::Attribute& attribute, Attribute& out, TypeList<T...>) {
    return (read_as<T>(attribute, out) || ...);
}

template <class... T>
bool write_numbers(Imf::Header& header, const Attribute& attribute, TypeList<T...>) {
    return (write_as<T>(header, attribute) || ...);
}

std::optional<Attribute> to_attribute(const std::string& name, const Imf::Attribute& attribute) {
    Attribute out{name, attribute.typeName(), {}, {}};
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute)) {
        out.text = text->value();
        return out;
    }
    if (const auto* envmap = dynamic_cast<const Imf::EnvmapAttribute*>(&attribute)) {
        out.numbers = {double(envmap->value())};
        out.text = envmap->value() == Imf::ENVMAP_LATLONG ? "latlong" : "cube";
        return out;
    }
    if (!read_numbers(attribute, out, NumericTypes{})) return std::nullopt;
    return out;
}

void add_attribute(Imf::Header& header, const Attribute& attribute) {
    if (attribute.type == "string")
        header.insert(attribute.name, Imf::StringAttribute(attribute.text));
    else
        write_numbers(header, attribute, NumericTypes{});
}

}  // namespace

Metadata metadata_of(const Imf::Header& header) {
    Metadata metadata;
    for (auto i = header.begin(); i != header.end(); ++i) {
        const std::string name = i.name();
        if (is_structural(name)) continue;
        if (auto attribute = to_attribute(name, i.attribute())) metadata.set(std::move(*attribute));
    }
    return metadata;
}

ColorTag color_tag_of(const Imf::Header& header) {
    ColorTag tag;
    if (const auto* id = header.findTypedAttribute<Imf::StringAttribute>("colorInteropID"))
        tag.space = id->value();
    if (Imf::hasChromaticities(header)) {
        const Imf::Chromaticities& c = Imf::chromaticities(header);
        tag.chromaticities = {c.red.x,  c.red.y,  c.green.x, c.green.y,
                              c.blue.x, c.blue.y, c.white.x, c.white.y};
    }
    return tag;
}

void add_metadata(Imf::Header& header, const Metadata& metadata) {
    constexpr std::size_t kLongestName = 255;  // of the file format
    for (const Attribute& attribute : metadata.all()) {
        const std::string& name = attribute.name;
        const bool fits = !name.empty() && name.size() <= kLongestName;
        // The writer alone knows the shape of what it writes.
        const bool ours = name == "envmap" || name == "pixelAspectRatio";
        if (fits && !ours && !is_structural(name)) add_attribute(header, attribute);
    }
}

void add_color_tag(Imf::Header& header, const ColorTag& tag) {
    if (!tag.space.empty()) header.insert("colorInteropID", Imf::StringAttribute(tag.space));
    if (!tag.chromaticities) return;
    const auto at = [&](std::size_t i) {
        return Imath::V2f(static_cast<float>((*tag.chromaticities)[2 * i]),
                          static_cast<float>((*tag.chromaticities)[2 * i + 1]));
    };
    Imf::addChromaticities(header, Imf::Chromaticities(at(0), at(1), at(2), at(3)));
}

}  // namespace chromeball::io
