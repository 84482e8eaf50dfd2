#include "map/layouts.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "support/directions.h"

namespace chromeball {
namespace {

using std::numbers::pi;
using Names = std::vector<std::string>;

std::optional<V2d> position_in(const Layout& layout, V3d d) {
    return std::visit([&](const auto& projection) { return projection.to_position(d); },
                      layout.projection);
}

TEST(Layouts, AreTheContractsAndEachIsFoundByItsName) {
    for (const char* name : {"latlong", "faces", "openexr", "strip-h", "strip-v", "cross-h",
                             "cross-v", "blender-3x2", "angular", "mirror-ball"}) {
        const Layout* layout = find_layout(name);
        ASSERT_NE(layout, nullptr) << name;
        EXPECT_EQ(layout->name, name);
        EXPECT_FALSE(layout->help.empty());
    }
    EXPECT_EQ(find_layout("Latlong"), nullptr);
    EXPECT_EQ(layout_names().size(), layouts().size());
    const Names names = layout_names();
    EXPECT_EQ(std::set(names.begin(), names.end()).size(), names.size());
}

TEST(Layouts, HaveSquarePixelsOnCubesAndTheContractsShapes) {
    EXPECT_EQ(find_layout("latlong")->picture(100), (Size{200, 100}));
    EXPECT_EQ(find_layout("faces")->picture(100), (Size{100, 600}));
    EXPECT_EQ(find_layout("openexr")->picture(100), (Size{100, 600}));
    EXPECT_EQ(find_layout("strip-h")->picture(100), (Size{600, 100}));
    EXPECT_EQ(find_layout("strip-v")->picture(100), (Size{100, 600}));
    EXPECT_EQ(find_layout("cross-h")->picture(100), (Size{400, 300}));
    EXPECT_EQ(find_layout("cross-v")->picture(100), (Size{300, 400}));
    EXPECT_EQ(find_layout("blender-3x2")->picture(100), (Size{300, 200}));
    EXPECT_EQ(find_layout("angular")->picture(100), (Size{100, 100}));
    EXPECT_EQ(find_layout("mirror-ball")->picture(100), (Size{100, 100}));
    for (const Layout& layout : layouts())
        if (const auto* cube = std::get_if<Cube>(&layout.projection)) {
            EXPECT_EQ(cube->layout().columns, layout.width_units) << layout.name;
            EXPECT_EQ(cube->layout().rows, layout.height_units) << layout.name;
        }
}

TEST(Layouts, KnowHowManyOfTheirPixelsShowSomething) {
    for (const Layout& layout : layouts()) {
        constexpr int n = 100;
        const Size size = layout.picture(n);
        int shown = 0;
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x)
                shown += std::visit(
                    [&](const auto& p) {
                        return p.solid_angle({(x + 0.5) / size.width, (y + 0.5) / size.height}) > 0;
                    },
                    layout.projection);
        // 0.003: counting pixel centres in a disk of 100 pixels
        EXPECT_NEAR(shown / static_cast<double>(n * n), layout.directed_area(), 0.003)
            << layout.name;
    }
}

TEST(Layouts, SeparateFacesStandInAColumnInMemory) {
    for (const Layout& layout : layouts())
        EXPECT_EQ(layout.separate_faces, layout.name.starts_with("faces")) << layout.name;
}

TEST(CubeLayouts, ReadCorrectlyFromInsideUnlessTheySayOtherwise) {
    const V3d axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (const CubeLayout& layout : cube_layouts()) {
        EXPECT_EQ(layout.mirrored, layout.name == "faces-opengl");
        for (std::size_t face = 0; face < 6; ++face) {
            const Face& f = layout.faces[face];
            EXPECT_EQ(f.right.cross(f.down), layout.mirrored ? -axes[face] : axes[face])
                << layout.name;
            EXPECT_EQ(layout.forward(static_cast<int>(face)), axes[face]) << layout.name;
        }
    }
}

TEST(Presets, AreTheContractsAndEachHasALayoutAndSixNames) {
    for (const char* name : {"opengl", "directx", "openexr", "usd", "blender", "alias", "unreal",
                             "unity", "renderman", "arnold"})
        EXPECT_NE(find_preset(name), nullptr) << name;
    EXPECT_EQ(find_preset("maya"), nullptr);
    EXPECT_EQ(preset_names().size(), presets().size());
    for (const Preset& preset : presets()) {
        EXPECT_NE(find_layout(preset.layout), nullptr) << preset.name;
        const std::set<std::string_view> names(preset.face_names.begin(), preset.face_names.end());
        EXPECT_EQ(names.size(), 6U) << preset.name;
        EXPECT_FALSE(names.contains("")) << preset.name;
        EXPECT_TRUE(std::set<std::string_view>({"exr", "hdr", "tif"}).contains(preset.extension))
            << preset.name;
        EXPECT_FALSE(preset.help.empty());
    }
}

TEST(Presets, NameTheFacesAsTheContractSays) {
    EXPECT_EQ(default_face_names(),
              (std::array<std::string_view, 6>{"px", "nx", "py", "ny", "pz", "nz"}));
    EXPECT_EQ(find_preset("alias")->face_names,
              (std::array<std::string_view, 6>{"right", "left", "top", "bottom", "front", "back"}));
}

/// OpenGL 4.6 core, table 8.19: the face px nx py ny pz nz that a lookup along r takes its texel
/// from, and its coordinates s and t there. Direct3D has the same table.
struct GlLookup {
    int face;
    double s, t;

    explicit GlLookup(V3d r) {
        const double ax = std::abs(r.x), ay = std::abs(r.y), az = std::abs(r.z);
        double sc, tc, ma;
        if (ax >= ay && ax >= az) {
            face = r.x > 0 ? 0 : 1;
            ma = ax, sc = r.x > 0 ? -r.z : r.z, tc = -r.y;
        } else if (ay >= az) {
            face = r.y > 0 ? 2 : 3;
            ma = ay, sc = r.x, tc = r.y > 0 ? r.z : -r.z;
        } else {
            face = r.z > 0 ? 4 : 5;
            ma = az, sc = r.z > 0 ? r.x : -r.x, tc = -r.y;
        }
        s = 0.5 * (sc / ma + 1);
        t = 0.5 * (tc / ma + 1);
    }
};

/// The direction of the camera frame that a file of a preset shows at (s, t), (0, 0) its first
/// texel: what a texture upload makes of it.
V3d shown_by_file(const Preset& preset, std::string_view file, double s, double t) {
    const auto found = std::find(preset.face_names.begin(), preset.face_names.end(), file);
    const auto face = static_cast<int>(found - preset.face_names.begin());
    const auto& cube = std::get<Cube>(find_layout(preset.layout)->projection);
    return preset.axes.inverse() * cube.direction_on(face, 2 * s - 1, 2 * t - 1);
}

TEST(Presets, AnOpenGlLookupFindsTheTexelThatShowsItsDirection) {
    const Preset& preset = *find_preset("opengl");
    for (const V3d& d : directions_on_sphere(2000)) {
        const GlLookup lookup(d);  // its world is ours
        const auto file = default_face_names()[static_cast<std::size_t>(lookup.face)];
        EXPECT_LT(angle_between(shown_by_file(preset, file, lookup.s, lookup.t), d), 1e-12) << d;
    }
}

TEST(Presets, ADirect3dLookupFindsTheTexelThatShowsItsDirection) {
    const Preset& preset = *find_preset("directx");
    for (const V3d& d : directions_on_sphere(2000)) {
        const GlLookup lookup({d.x, d.y, -d.z});  // its world is left-handed
        const auto file = default_face_names()[static_cast<std::size_t>(lookup.face)];
        EXPECT_LT(angle_between(shown_by_file(preset, file, lookup.s, lookup.t), d), 1e-12) << d;
    }
}

/// Where a lat-long preset's picture shows a direction of our frame.
V2d preset_position(const Preset& preset, V3d d) {
    return position_in(*find_layout(preset.layout), preset.axes * d).value();
}

/// Whether u and the expected one are the same longitude.
void expect_longitude(double u, double expected, const char* program) {
    const double off = u - expected;
    EXPECT_LT(std::abs(off - std::round(off)), 1e-12) << program;
}

TEST(Presets, LatLongsFollowTheProgramsOwnFormulas) {
    for (const V3d& d : directions_on_sphere(500)) {
        const double v = 0.5 - std::asin(d.y) / pi;  // down from the zenith, in all of them
        for (const char* program : {"blender", "unity", "unreal", "usd", "renderman", "arnold"})
            EXPECT_NEAR(preset_position(*find_preset(program), d).y, v, 1e-12) << program;

        // Cycles' direction_to_equirectangular, in its Z-up world
        const V3d blender(d.x, -d.z, d.y);
        expect_longitude(preset_position(*find_preset("blender"), d).x,
                         0.5 - std::atan2(blender.y, blender.x) / (2 * pi), "blender");
        // Skybox/Panoramic's ToRadialCoords, in its left-handed world
        const V3d unity(d.x, d.y, -d.z);
        expect_longitude(preset_position(*find_preset("unity"), d).x,
                         0.5 - std::atan2(unity.z, unity.x) / (2 * pi), "unity");
        // TextureCompressorModule's long-lat lookup, in its left-handed Z-up world
        const V3d unreal(d.x, d.z, d.y);
        expect_longitude(preset_position(*find_preset("unreal"), d).x,
                         0.5 * (1 + std::atan2(unreal.x, -unreal.y) / pi), "unreal");
        for (const char* program : {"usd", "renderman", "arnold"})
            expect_longitude(preset_position(*find_preset(program), d).x,
                             0.5 - std::atan2(d.x, d.z) / (2 * pi), program);
    }
}

}  // namespace
}  // namespace chromeball
