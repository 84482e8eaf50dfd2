#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "map/camera.h"
#include "map/orientation.h"

namespace chromeball {

/// The camera of one frame as a file of cameras tells it; what is absent it does not tell.
struct FrameCamera {
    std::optional<Rotation> to_world;
    std::optional<double> focal;  ///< pixels
    std::optional<V2d> principal;
};

/// From {"frames": {"1001": {"camera_to_world": [9 or 16 numbers], "focal_px": F, "principal": [x,
/// y]}}}. Throws Error (usage) that names the file and the frame.
std::map<int, FrameCamera> cameras_from(std::string_view json, const std::string& file);

}  // namespace chromeball
