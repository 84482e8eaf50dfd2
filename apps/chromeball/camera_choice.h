#pragma once

#include <optional>
#include <string>

#include "console.h"
#include "core/photo.h"
#include "map/camera.h"
#include "map/orientation.h"
#include "options.h"

namespace chromeball {

/// The camera in force and who said so: "--focal-px", "exif: 35 mm equivalent", "orthographic", ...
struct CameraChoice {
    Camera camera;
    std::string source;
    std::optional<double>
        distance;      ///< --distance-radii: the focal length follows from the outline
    std::string note;  ///< what the user should know of it; may be empty
    std::optional<double> deviation;  ///< of a focal length that was estimated, pixels
    bool told = true;                 ///< false: neither flags nor the file knew, so orthographic
};

/// Flags win over what the file says. Throws Error (usage) when flags contradict each other.
CameraChoice choose_camera(const PhotoOptions& options, const Photo& photo);

/// Camera to world from EXR metadata (worldToCamera); nothing where there is none or it is no
/// rotation.
std::optional<Rotation> rotation_from_metadata(const Photo& photo, const std::string& camera_axes);
/// The same, told to the user: that it is taken, or why it is not.
std::optional<Rotation> told_by_file(const Photo& photo, const std::string& camera_axes,
                                     const Console& console);

}  // namespace chromeball
