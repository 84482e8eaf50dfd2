#include "io/facts.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace chromeball {
namespace {

/// A positive, finite number under the first of the names that has one.
std::optional<double> positive(const Metadata& metadata,
                               std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names)
        if (const auto number = metadata.number(name);
            number && std::isfinite(*number) && *number > 0)
            return number;
    return std::nullopt;
}

CameraFacts pinhole(double focal, Size display, std::string source) {
    return {{focal, {0.5 * display.width, 0.5 * display.height}, {}}, std::move(source)};
}

/// How the picture at hand relates to the one the camera wrote.
struct Scale {
    bool cropped = false;  ///< another shape: nobody knows which part, nor at what scale
    double factor = 1;     ///< pixels now per pixel then
};

/// Long side over short side, as tags describe the picture before it was turned upright.
double shape_of(double width, double height) {
    return std::max(width, height) / std::min(width, height);
}

Scale scale_since_capture(const Metadata& metadata, Size display) {
    // Cameras make 5:4 to 21:9. Editors that crop also correct the tags below, but a square (what
    // a ball is cut out as) betrays them.
    const double shape = shape_of(display.width, display.height);
    constexpr double kSquarest = 1.2;
    constexpr double kWidest = 2.4;
    if (shape < kSquarest || shape > kWidest) return {true, 1};
    const auto width = positive(metadata, {"Exif:PixelXDimension"});
    const auto height = positive(metadata, {"Exif:PixelYDimension"});
    if (!width || !height) return {};
    constexpr double kShapeTolerance = 0.02;  // resizing rounds, RAW developers trim a few pixels
    const bool cropped = std::abs(shape / shape_of(*width, *height) - 1) > kShapeTolerance;
    return {cropped, std::max(display.width, display.height) / std::max(*width, *height)};
}

/// CIPA DCG-001: the focal length that gives the same diagonal field of view on 36 x 24 mm. It is
/// written for the whole sensor; pictures wider than 3:2 have lost rows of it but no columns, so
/// that for them the width counts.
std::optional<CameraFacts> from_35mm_equivalent(const Metadata& metadata, Size display) {
    const auto focal = positive(metadata, {"Exif:FocalLengthIn35mmFilm"});
    if (!focal) return std::nullopt;
    const double film_diagonal = std::hypot(36.0, 24.0);
    const double diagonal = std::hypot(display.width, display.height);
    const double long_side = std::max(display.width, display.height);
    const bool rows_lost = shape_of(display.width, display.height) > 1.51;
    const double pixels_per_mm = rows_lost ? long_side / 36.0 : diagonal / film_diagonal;
    return pinhole(*focal * pixels_per_mm, display, "exif: 35 mm equivalent");
}

/// Millimetres of EXIF's unit of the focal plane resolution (TIFF's ResolutionUnit and its common
/// extensions).
std::optional<double> millimetres_of_unit(double unit) {
    switch (static_cast<int>(unit)) {
        case 2:
            return 25.4;
        case 3:
            return 10.0;
        case 4:
            return 1.0;
        case 5:
            return 0.001;
        default:
            return std::nullopt;
    }
}

bool plausible_sensor_width(double mm) { return mm > 1 && mm < 100; }

std::optional<CameraFacts> from_focal_plane(const Metadata& metadata, Size display, Scale scale) {
    const auto focal = positive(metadata, {"Exif:FocalLength"});
    const auto resolution = positive(metadata, {"Exif:FocalPlaneXResolution"});
    const auto unit = millimetres_of_unit(
        metadata.number("Exif:FocalPlaneResolutionUnit").value_or(2));  // EXIF's default: inch
    if (!focal || !resolution || !unit) return std::nullopt;
    const double pixels_per_mm = *resolution / *unit * scale.factor;
    const double long_side = std::max(display.width, display.height);
    if (!plausible_sensor_width(long_side / pixels_per_mm)) return std::nullopt;
    return pinhole(*focal * pixels_per_mm, display, "exif: focal plane resolution");
}

std::optional<double> focal_mm(const Metadata& metadata) {
    // The pinhole's focal length is what the projection uses; the nominal one is engraved on the
    // lens.
    return positive(metadata, {"pinholeFocalLength", "effectiveFocalLength", "nominalFocalLength",
                               "Exif:FocalLength", "focalLength", "focal_length", "FocalLength",
                               "cameraFocalLength"});
}

/// EXIF's focal length on the sensor that such cameras have.
std::optional<CameraFacts> from_table(const Metadata& metadata, Size display,
                                      const std::vector<Sensor>& sensors) {
    const auto focal = positive(metadata, {"Exif:FocalLength"});
    const auto make = metadata.text("Make"), model = metadata.text("Model");
    if (!focal || !make || !model) return std::nullopt;
    const Sensor* sensor = find_sensor(sensors, *make, *model);
    if (!sensor) return std::nullopt;
    const int long_side = std::max(display.width, display.height);
    return pinhole(focal_from_sensor(*focal, sensor->width_mm, long_side), display,
                   "exif: focal length; sensor of the " + *model);
}

std::optional<CameraFacts> from_sensor(const Metadata& metadata, Size display) {
    const auto focal = focal_mm(metadata);
    if (!focal) return std::nullopt;
    const Attribute* rectangle = metadata.find("sensorAcquisitionRectangle");
    const auto pitch = positive(metadata, {"sensorPhotositePitch"});  // micrometres
    if (pitch && rectangle && rectangle->numbers.size() == 4) {
        const double photosites = rectangle->numbers[2] - rectangle->numbers[0] + 1;
        const double width_mm = photosites * *pitch / 1000;
        if (plausible_sensor_width(width_mm))
            return pinhole(focal_from_sensor(*focal, width_mm, display.width), display,
                           "exr: focal length and photosites");
    }
    const auto width_mm =
        positive(metadata, {"sensorOverallDimensions", "sensorWidth", "sensor_width",
                            "sensor_width_mm", "SensorWidth", "cameraAperture"});
    if (!width_mm || !plausible_sensor_width(*width_mm)) return std::nullopt;
    return pinhole(focal_from_sensor(*focal, *width_mm, display.width), display,
                   "exr: focal length and sensor width");
}

/// chromeball's own note of the camera, where it is of this very picture.
std::optional<CameraFacts> from_provenance(const Provenance& provenance) {
    if (!provenance.camera || !provenance.camera->focal) return std::nullopt;
    return CameraFacts{*provenance.camera, "chromeball"};
}

}  // namespace

bool cropped_since(const Metadata& metadata, Size display) {
    const bool told =
        positive(metadata, {"Exif:FocalLengthIn35mmFilm", "Exif:FocalLength"}).has_value();
    return told && display.width > 0 && display.height > 0 && !provenance_from(metadata) &&
           scale_since_capture(metadata, display).cropped;
}

std::optional<CameraFacts> camera_from_metadata(const Metadata& metadata, Size display,
                                                const std::vector<Sensor>& sensors) {
    if (display.width <= 0 || display.height <= 0) return std::nullopt;
    if (const auto provenance = provenance_from(metadata)) {
        // A map or a cropped ball is no picture of the camera in its camera's frame.
        if (!provenance->layout.empty()) return std::nullopt;
        if (auto facts = from_provenance(*provenance)) return facts;
    }
    const Scale scale = scale_since_capture(metadata, display);
    if (!scale.cropped) {
        if (auto facts = from_35mm_equivalent(metadata, display)) return facts;
        if (auto facts = from_focal_plane(metadata, display, scale)) return facts;
    }
    if (auto facts = from_sensor(metadata, display)) return facts;
    return scale.cropped ? std::nullopt : from_table(metadata, display, sensors);
}

}  // namespace chromeball
