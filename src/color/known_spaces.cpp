#include "color/known_spaces.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

namespace chromeball {
namespace {

using Chromaticities = std::array<double, 8>;

// SMPTE ST 2065-1:2012, table 1 (AP0).
constexpr Chromaticities kAp0 = {0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.0770, 0.32168, 0.33767};
// Academy S-2014-004 (ACEScg), table 1 (AP1).
constexpr Chromaticities kAp1 = {0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767};
// ITU-R BT.709-6, item 1.3.
constexpr Chromaticities kRec709 = {0.640, 0.330, 0.300, 0.600, 0.150, 0.060, 0.3127, 0.3290};
// ITU-R BT.2020-2, table 3.
constexpr Chromaticities kRec2020 = {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290};
// Primaries of SMPTE RP 431-2, white of SMPTE EG 432-1 (D65).
constexpr Chromaticities kP3D65 = {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290};

/// Letters and digits only, in lower case: "sRGB IEC61966-2.1" and "sRGB IEC61966-2-1" are one.
std::string normalised(std::string_view name) {
    std::string letters;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte)) letters += static_cast<char>(std::tolower(byte));
    }
    return letters;
}

bool names_it(const KnownSpace& space, const std::string& wanted) {
    const auto same = [&](std::string_view name) { return normalised(name) == wanted; };
    return same(space.id) || std::any_of(space.names.begin(), space.names.end(), same) ||
           std::any_of(space.profiles.begin(), space.profiles.end(), same);
}

bool near(const Chromaticities& a, const Chromaticities& b) {
    // 1e-3: files hold rounded figures (0.3127 or 0.31271); the spaces here are 0.003 apart or
    // more.
    return std::equal(a.begin(), a.end(), b.begin(),
                      [](double x, double y) { return std::abs(x - y) <= 1e-3; });
}

}  // namespace

const std::vector<KnownSpace>& known_spaces() {
    // The long names are those of the configs of the ACES project and of Blender.
    static const std::vector<KnownSpace> spaces = {
        {"lin_ap1_scene", {"lin_ap1", "ACEScg", "ACES - ACEScg"}, {}, kAp1},
        {"lin_ap0_scene", {"lin_ap0", "ACES2065-1", "aces2065_1", "ACES - ACES2065-1"}, {}, kAp0},
        {"lin_rec709_scene",
         {"lin_rec709", "Linear Rec.709 (sRGB)", "Linear Rec.709", "lin_srgb",
          "Utility - Linear - Rec.709", "Utility - Linear - sRGB"},
         {"Linear sRGB", "scRGB"},
         kRec709},
        {"lin_p3d65_scene",
         {"lin_p3d65", "Linear P3-D65", "Utility - Linear - P3-D65"},
         {"Linear Display P3"},
         kP3D65},
        {"lin_rec2020_scene",
         {"lin_rec2020", "Linear Rec.2020", "Utility - Linear - Rec.2020"},
         {},
         kRec2020},
        {"srgb_rec709_scene",
         {"srgb_texture", "srgb_tx", "sRGB - Texture", "Utility - sRGB - Texture", "sRGB"},
         {"sRGB IEC61966-2.1", "sRGB built-in", "sRGB2014", "sRGB v4 ICC preference",
          "sRGB Color Space Profile", "c2"},
         {}},
        {"srgb_p3d65_scene",
         {"srgb_p3d65", "srgb_displayp3", "display_p3", "Display P3"},
         {"Image P3", "Display P3 Gamut with sRGB Transfer"},
         {}},
        {"g22_rec709_scene",
         {"g22_rec709", "Gamma 2.2 Rec.709 - Texture", "Utility - Gamma 2.2 - Rec.709 - Texture"},
         {"Gray Gamma 2.2", "Generic Gray Gamma 2.2 Profile"},
         {}},
        {"g22_adobergb_scene",
         {"g22_adobergb", "adobe_rgb", "Adobe RGB"},
         {"Adobe RGB (1998)", "Compatible with Adobe RGB (1998)"},
         {}},
        {"data", {"raw", "Utility - Raw", "Non-Color"}, {}, {}},
    };
    return spaces;
}

const KnownSpace* known_space(std::string_view tag) {
    const std::string wanted = normalised(tag);
    for (const KnownSpace& space : known_spaces())
        if (names_it(space, wanted)) return &space;
    return nullptr;
}

const KnownSpace* known_space(const Chromaticities& chromaticities) {
    for (const KnownSpace& space : known_spaces())
        if (space.chromaticities && near(*space.chromaticities, chromaticities)) return &space;
    return nullptr;
}

}  // namespace chromeball
