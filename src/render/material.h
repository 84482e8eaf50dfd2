#pragma once

#include <Imath/ImathVec.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chromeball {

using Imath::V3f;

/// What a surface does with light.
struct Material {
    enum class Kind {
        mirror,     ///< reflects `color` at every angle
        conductor,  ///< Fresnel's equations for eta and k, times color
        glass,      ///< Snell's law and Fresnel's equations at every surface, index ior
        diffuse,    ///< Lambert, albedo color
        flat,       ///< shows color itself, lit by nothing
    };
    Kind kind = Kind::mirror;
    V3f color{1, 1, 1};
    V3f eta{1, 1, 1}, k{0, 0, 0};  ///< of a conductor, for red, green and blue light
    float ior = 1.5F;              ///< of glass
    /// Of mirrors and conductors: 0 polished, 1 rough; GGX with alpha = roughness^2.
    float roughness = 0;

    bool operator==(const Material&) const = default;
};

/// By name: mirror, chrome, aluminium, silver, gold, copper, glass, glossy, diffuse.
std::vector<std::string> material_names();
std::optional<Material> find_material(std::string_view name);

/// The part of unpolarised light that a smooth dielectric reflects (Fresnel).
///
/// cosine   of the angle of incidence, 0 to 1
/// eta      index behind the surface over that before it
/// 1 for total internal reflection.
float fresnel_dielectric(float cosine, float eta);

/// The same for a conductor of complex index eta + i k. Born and Wolf, Principles of Optics, 14.2.
float fresnel_conductor(float cosine, float eta, float k);

/// Whether it shows its surroundings as they are: all but matte and flat ones.
bool reflects(const Material& material);

/// What a mirror or conductor reflects at an angle of incidence.
V3f reflectance(const Material& material, float cosine);

}  // namespace chromeball
