#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "map/orientation.h"
#include "map/projections.h"

namespace chromeball {

/// A shape an environment map can have, by the name that --layout and --from know.
struct Layout {
    std::string_view name;
    AnyProjection projection;
    /// The picture is width_units x size by height_units x size pixels; size is the width of one
    /// face, the height of a lat-long, the side of a ball.
    int width_units = 1;
    int height_units = 1;
    /// Faces in files of their own; in memory they stand in a column.
    bool separate_faces = false;
    std::string_view help;

    Size picture(int size) const { return {width_units * size, height_units * size}; }
    /// How many pixels of a picture of size 1 have directions (of a disk pi / 4).
    double directed_area() const;
};

/// What a program that reads environment maps expects: shape, file names, axes, file type.
struct Preset {
    std::string_view name;
    std::string_view layout;
    std::string_view extension;
    /// Of the faces +X -X +Y -Y +Z -Z of our frame.
    std::array<std::string_view, 6> face_names;
    /// Camera (or world) frame of ours -> the frame that the layout is drawn in.
    Rotation axes;
    std::string_view help;
};

/// The cube layouts, `openexr` first.
std::span<const CubeLayout> cube_layouts();

/// All shapes, in the order of the help text.
const std::vector<Layout>& layouts();
const Layout* find_layout(std::string_view name);
std::vector<std::string> layout_names();

const std::vector<Preset>& presets();
const Preset* find_preset(std::string_view name);
std::vector<std::string> preset_names();

/// px nx py ny pz nz.
const std::array<std::string_view, 6>& default_face_names();

}  // namespace chromeball
