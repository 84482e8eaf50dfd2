#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/metadata.h"
#include "core/outline.h"
#include "io/sensors.h"
#include "map/camera.h"

namespace chromeball {

/// The camera as a file's own facts tell it, and in which words: "exif: 35 mm equivalent", "exr",
/// ...
struct CameraFacts {
    Camera camera;
    std::string source;
};

/// Focal length in pixels of the upright picture from EXIF (35 mm equivalent; or focal length with
/// focal-plane resolution; or focal length with a sensor's width, the file's or from `sensors` by
/// the camera's make and model) or EXR metadata; principal point in the middle of the display
/// window.
///
/// Nothing where the file does not tell, where the picture was cropped since (see cropped_since),
/// and of maps and cropped balls, whose provenance_from holds the source's camera. `display` is the
/// upright display window's size.
std::optional<CameraFacts> camera_from_metadata(const Metadata& metadata, Size display,
                                                const std::vector<Sensor>& sensors = {});

/// Whether EXIF tells a lens, but of another picture than this one: its shape is another, or none
/// that cameras make, so that neither scale nor centre are known.
bool cropped_since(const Metadata& metadata, Size display);

/// How an image came about, kept in its file as one attribute (JSON text) that chromeball reads
/// again.
struct Provenance {
    std::string version = {};  ///< of chromeball
    std::string source =
        {};  ///< the photo's path as given; of an absolute path the file name alone
    std::optional<Outline> outline = std::nullopt;  ///< of the ball in the source photo
    std::optional<Camera> camera = std::nullopt;    ///< of the source photo
    std::string layout = {};  ///< of a map: its layout's name; "crop" of a cropped ball; else empty
    std::optional<std::array<double, 9>> rotation = std::nullopt;  ///< camera to output, row-major
    std::string reflectance =
        {};  ///< of the mirror, as told, where it is undone already; else empty
    std::string fingerprint =
        {};  ///< of a shot's frame: a hash of all it was made of and how, by which a rerun knows it
};

/// The attribute to hand to write_image.
Attribute to_attribute(const Provenance& provenance);
/// From whatever a file of any format kept of it; nothing where there is none or it is damaged.
std::optional<Provenance> provenance_from(const Metadata& metadata);

/// The facts worth passing on from a photo to what is made of it, under OpenEXR's standard names:
/// time code, exposure, aperture, ISO, camera make and model, lens, date, frame rate, reel,
/// worldToCamera, ...
Metadata pass_through(const Metadata& metadata);

}  // namespace chromeball
