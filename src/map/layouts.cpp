#include "map/layouts.h"

#include <algorithm>

namespace chromeball {
namespace {

const V3d X(1, 0, 0), Y(0, 1, 0), Z(0, 0, 1);

// Cube layouts: cells (column, row) and (right, down) of the faces +X -X +Y -Y +Z -Z.

// As the OpenEXR library's ImfEnvmap.h describes cube-face maps: one column, seen from inside.
const CubeLayout kColumn{
    "openexr",
    1,
    6,
    {{{0, 0, Z, -Y}, {0, 1, -Z, -Y}, {0, 2, X, -Z}, {0, 3, X, Z}, {0, 4, -X, -Y}, {0, 5, X, -Y}}}};
const CubeLayout kRow{
    "strip-h",
    6,
    1,
    {{{0, 0, Z, -Y}, {1, 0, -Z, -Y}, {2, 0, X, -Z}, {3, 0, X, Z}, {4, 0, -X, -Y}, {5, 0, X, -Y}}}};
// Crosses: +Z in the middle, +Y and -Y turned so that they join it.
const CubeLayout kCrossH{"cross-h",
                         4,
                         3,
                         {{{0, 1, Z, -Y},
                           {2, 1, -Z, -Y},
                           {1, 0, -X, Z},
                           {1, 2, -X, -Z},
                           {1, 1, -X, -Y},
                           {3, 1, X, -Y}}}};
// Debevec's vertical cross: -Z at the foot, upside down.
const CubeLayout kCrossV{"cross-v",
                         3,
                         4,
                         {{{0, 1, Z, -Y},
                           {2, 1, -Z, -Y},
                           {1, 0, -X, Z},
                           {1, 2, -X, -Z},
                           {1, 1, -X, -Y},
                           {1, 3, -X, Y}}}};
// Blender up to 2.7, "Environment Map" texture: -X -Y +X over -Z +Z +Y of its Z-up world. In ours,
// (x, y, z) -> (x, -z, y), that is -X +Z +X over -Y +Y -Z. The turns are those of its renderer's
// per-face cameras: sides upright, top and bottom with +X to the right.
const CubeLayout kBlender{
    "blender-3x2",
    3,
    2,
    {{{2, 0, Z, -Y}, {0, 0, -Z, -Y}, {1, 1, X, -Z}, {0, 1, X, Z}, {1, 0, -X, -Y}, {2, 1, X, -Y}}}};
// OpenGL 4.6 core specification, table 8.19: sc and tc are the directions of right and down. With
// a right-handed world its faces are mirror images; a lookup by direction is right again.
const CubeLayout kOpenGl{
    "faces-opengl",
    1,
    6,
    {{{0, 0, -Z, -Y}, {0, 1, Z, -Y}, {0, 2, X, Z}, {0, 3, X, -Z}, {0, 4, X, -Y}, {0, 5, -X, -Y}}},
    true};

const std::array<CubeLayout, 6> kCubeLayouts{kColumn, kRow, kCrossH, kCrossV, kBlender, kOpenGl};

const CubeLayout& cube_layout(std::string_view name) {
    return *std::find_if(kCubeLayouts.begin(), kCubeLayouts.end(),
                         [&](const CubeLayout& l) { return l.name == name; });
}

Layout cube(std::string_view name, const CubeLayout& cells, std::string_view help,
            bool separate = false) {
    return {name, Cube(cells), cells.columns, cells.rows, separate, help};
}

std::vector<Layout> make_layouts() {
    return {
        {"latlong", LatLong{}, 2, 1, false,
         "latitude-longitude, +Z in the middle (OpenEXR, UsdLux)"},
        cube("faces", cube_layout("openexr"), "six files in a folder, seen from inside", true),
        cube("openexr", cube_layout("openexr"), "1x6 column with the OpenEXR envmap attribute"),
        cube("strip-h", cube_layout("strip-h"), "6x1 row, +X -X +Y -Y +Z -Z"),
        cube("strip-v", cube_layout("openexr"), "1x6 column"),
        cube("cross-h", cube_layout("cross-h"), "4x3 cross around +Z"),
        cube("cross-v", cube_layout("cross-v"), "3x4 cross around +Z, -Z at the foot"),
        cube("blender-3x2", cube_layout("blender-3x2"),
             "3x2 sheet of Blender's old environment maps"),
        {"angular", Angular{}, 1, 1, false, "Debevec's light probe: -Z in the middle, +Z the edge"},
        {"mirror-ball", MirrorBall{}, 1, 1, false,
         "a mirror ball seen from far away, +Z in the middle"},
        cube("faces-opengl", cube_layout("faces-opengl"),
             "six files as OpenGL stores them (mirrored)", true),
    };
}

constexpr std::array<std::string_view, 6> kFaceNames{"px", "nx", "py", "ny", "pz", "nz"};

std::vector<Preset> make_presets() {
    const Rotation as_is;
    // Lat-longs whose middle is +X: d there shows what ours shows at +Z, so +X is turned to +Z.
    const Rotation x_in_the_middle = Rotation::about_y(-90);
    const Rotation back_in_the_middle = Rotation::about_y(180);
    return {
        // OpenGL 4.6 core specification, section 8.13 (table 8.19).
        {"opengl", "faces-opengl", "exr", kFaceNames, as_is,
         "six faces for GL_TEXTURE_CUBE_MAP_POSITIVE_X ..., world right-handed, +Y up"},
        // Direct3D documentation, "Cubic environment mapping": the same table in a left-handed
        // world; with (x, y, -z) the faces are ours and only the names of +Z and -Z change places.
        {"directx",
         "faces",
         "exr",
         {"px", "nx", "py", "ny", "nz", "pz"},
         as_is,
         "six faces for a left-handed world (x, y, -z)"},
        // OpenEXR: ImfEnvmap.h.
        {"openexr", "openexr", "exr", kFaceNames, as_is, "1x6 column with the envmap attribute"},
        // UsdLuxDomeLight: "expected to match the OpenEXR specification for latlong maps".
        {"usd", "latlong", "exr", kFaceNames, as_is, "texture:file of a DomeLight, +Y up"},
        // Cycles, kernel/camera/projection.h: u = 1/2 - atan2(y, x) / 2 pi, v from +Z: the middle
        // is
        // +X, +Y at u = 1/4, in its Z-up world (x, -z, y).
        {"blender", "latlong", "exr", kFaceNames, x_in_the_middle,
         "World > Environment Texture, equirectangular, Z-up world (x, -z, y)"},
        // Alias: environment cubes by their sides' names; +Z is the front.
        {"alias",
         "faces",
         "tif",
         {"right", "left", "top", "bottom", "front", "back"},
         as_is,
         "six files right left top bottom front back"},
        // Unreal Engine, TextureCompressorModule.cpp: u = (1 + atan2(x, -y) / pi) / 2, v from +Z
        // up:
        // the middle is its -Y; its left-handed Z-up world is (x, z, y) of ours.
        {"unreal", "latlong", "hdr", kFaceNames, back_in_the_middle,
         "long-lat HDR for a texture cube, world (x, z, y)"},
        // Unity, Skybox/Panoramic: u = 1/2 - atan2(z, x) / 2 pi: the middle is +X, +Z at u = 1/4;
        // its
        // left-handed Y-up world is (x, y, -z) of ours.
        {"unity", "latlong", "exr", kFaceNames, x_in_the_middle,
         "panoramic skybox or cube texture, world (x, y, -z)"},
        // PxrDomeLight as driven by USD: UsdLux's convention; the envmap attribute says so to
        // txmake.
        {"renderman", "latlong", "exr", kFaceNames, as_is, "PxrDomeLight, as UsdLux"},
        // skydome_light as driven by USD (arnold-usd): UsdLux's convention, format latlong.
        {"arnold", "latlong", "exr", kFaceNames, as_is, "skydome_light of a UsdLux dome, latlong"},
    };
}

template <class Row>
const Row* find(const std::vector<Row>& rows, std::string_view name) {
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.name == name; });
    return row == rows.end() ? nullptr : &*row;
}

template <class Row>
std::vector<std::string> names_of(const std::vector<Row>& rows) {
    std::vector<std::string> names;
    for (const Row& row : rows) names.emplace_back(row.name);
    return names;
}

}  // namespace

double Layout::directed_area() const {
    if (std::holds_alternative<Cube>(projection)) return 6;
    if (std::holds_alternative<LatLong>(projection)) return 2;
    return std::numbers::pi / 4;
}

std::span<const CubeLayout> cube_layouts() { return kCubeLayouts; }

const std::vector<Layout>& layouts() {
    static const std::vector<Layout> rows = make_layouts();
    return rows;
}
const Layout* find_layout(std::string_view name) { return find(layouts(), name); }
std::vector<std::string> layout_names() { return names_of(layouts()); }

const std::vector<Preset>& presets() {
    static const std::vector<Preset> rows = make_presets();
    return rows;
}
const Preset* find_preset(std::string_view name) { return find(presets(), name); }
std::vector<std::string> preset_names() { return names_of(presets()); }

const std::array<std::string_view, 6>& default_face_names() { return kFaceNames; }

}  // namespace chromeball
