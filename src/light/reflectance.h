#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "map/affine.h"
#include "map/mirror_ball.h"

namespace chromeball {

/// A polished surface's refractive index n + i k for red, green, blue; k is 0 of dielectrics.
struct OpticalConstants {
    std::array<double, 3> n{1, 1, 1};
    std::array<double, 3> k{0, 0, 0};
};

/// The part of unpolarised light that a surface with the index n + i k gives back, 0 to 1.
///
/// cosine   of the angle of incidence, 0 to 1
/// Born and Wolf, Principles of Optics, 7th ed., 14.4, in its usual real form: with s = sin^2 i,
/// a^2 + b^2 = sqrt((n^2 - k^2 - s)^2 + 4 n^2 k^2), 2 a^2 = a^2 + b^2 + n^2 - k^2 - s.
double fresnel(double cosine, double n, double k);

/// What a mirror ball gives back.
struct Reflectance {
    /// Of all angles; where constants are given a factor of theirs (1: clean and polished).
    std::array<double, 3> factor{1, 1, 1};
    std::optional<OpticalConstants> constants = std::nullopt;

    bool constant() const { return !constants; }
    /// Red, green, blue at an angle of incidence; more at grazing angles where constants tell.
    std::array<double, 3> at(double cosine) const;
};

/// Materials of which balls are made, by name; their constants at 617, 549 and 451 nm, which is
/// where cameras' channels have their middles.
struct BallMaterial {
    std::string_view name;
    OpticalConstants constants;
    std::string_view source;
};
const std::vector<BallMaterial>& ball_materials();
const BallMaterial* find_ball_material(std::string_view name);

/// Divides a ball's pixels by what the mirror gives back at each one's angle of incidence, in
/// place.
///
/// pixels      3 or 4 channels, the part of the photo that has the ball
/// to_pixels   from the positions that `ball` knows to those in `pixels`
/// inside      pixels whose middle does not show the ball stay as they are; else they count as
///             grazed
void undo_reflectance(Image& pixels, const MirrorBall& ball, const Affine& to_pixels,
                      const Reflectance& reflectance, bool inside = false);

}  // namespace chromeball
