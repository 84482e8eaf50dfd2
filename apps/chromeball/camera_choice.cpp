#include "camera_choice.h"

#include <fmt/format.h>

#include "core/error.h"
#include "io/facts.h"
#include "numbers.h"

namespace chromeball {
namespace {

/// The ways to tell the lens; two of them would contradict each other.
void check_one_lens(const PhotoOptions& o) {
    const bool by_sensor = o.focal_mm || o.sensor_mm;
    const int ways = by_sensor + o.hfov.has_value() + o.focal_px.has_value() +
                     o.distance_radii.has_value() + o.orthographic;
    if (ways > 1)
        throw Error(Error::Kind::usage,
                    "more than one of --focal-mm with --sensor-mm, --hfov, --focal-px, "
                    "--distance-radii and "
                    "--orthographic: they would contradict each other; give one");
    if (o.focal_mm.has_value() != o.sensor_mm.has_value())
        throw Error(Error::Kind::usage,
                    "--focal-mm and --sensor-mm belong together; give both (a 36 mm wide "
                    "sensor is called full frame)");
}

/// The lens' radial terms, which count in focal lengths.
Distortion lens_distortion(const PhotoOptions& o, const CameraChoice& choice) {
    const Distortion lens{o.k1, o.k2, o.k3};
    if (lens.none()) return choice.camera.distortion;
    if (choice.camera.orthographic())
        throw Error(
            Error::Kind::usage,
            "--k1, --k2 and --k3 need the focal length in pixels: give --focal-px, --focal-mm "
            "with --sensor-mm, or --hfov");
    return lens;
}

}  // namespace

CameraChoice choose_camera(const PhotoOptions& o, const Photo& photo) {
    check_one_lens(o);
    const int width = photo.display.width;
    CameraChoice choice;
    choice.camera.principal = V2d(0.5 * width, 0.5 * photo.display.height);
    if (o.orthographic) {
        choice.source = "--orthographic";
    } else if (o.focal_px) {
        choice.camera.focal = o.focal_px;
        choice.source = "--focal-px";
    } else if (o.hfov) {
        choice.camera.focal = focal_from_hfov(*o.hfov, width);
        choice.source = "--hfov";
    } else if (o.focal_mm) {
        choice.camera.focal = focal_from_sensor(*o.focal_mm, *o.sensor_mm, width);
        choice.source = "--focal-mm";
    } else if (o.distance_radii) {
        choice.distance = o.distance_radii;
        choice.source = "--distance-radii";
    } else if (const auto facts =
                   camera_from_metadata(photo.metadata, photo.display, sensors_with(o.sensors))) {
        choice.camera = facts->camera;
        choice.source = facts->source;
    } else {
        choice.source = "orthographic";
        choice.told = false;
        if (cropped_since(photo.metadata, photo.display))
            choice.note = fmt::format(
                "{}: EXIF tells the lens, but of another picture: this one was cropped since, so "
                "its "
                "scale and middle are not known",
                photo.name);
    }
    if (o.principal) {
        const auto p = parse_numbers("--principal", *o.principal, {2}, "X,Y");
        choice.camera.principal = V2d(p[0], p[1]);
    }
    choice.camera.distortion = lens_distortion(o, choice);
    return choice;
}

std::optional<Rotation> rotation_from_metadata(const Photo& photo, const std::string& camera_axes) {
    const Attribute* matrix = photo.metadata.find("worldToCamera");
    if (!matrix) return std::nullopt;
    return Rotation::camera_to_world(matrix->numbers, camera_axes);
}

std::optional<Rotation> told_by_file(const Photo& photo, const std::string& camera_axes,
                                     const Console& console) {
    if (!photo.metadata.find("worldToCamera")) return std::nullopt;
    const auto rotation = rotation_from_metadata(photo, camera_axes);
    if (rotation)
        console.say(
            fmt::format("{}: turned into the world by the file's worldToCamera", photo.name));
    else
        console.warn(fmt::format(
            "{}: its worldToCamera is no rotation and is not used; give --camera-to-world",
            photo.name));
    return rotation;
}

}  // namespace chromeball
