#include "render/material.h"

#include <algorithm>
#include <cmath>

namespace chromeball {
namespace {

using Kind = Material::Kind;

struct Named {
    std::string_view name;
    Material material;
};

/// Indices at 650, 550 and 450 nm, after Palik's handbook and Rakic's tables.
const Named kMaterials[] = {{"mirror", {}},
                            {"chrome",
                             {.kind = Kind::conductor,
                              .eta = {4.3697F, 2.9167F, 1.6547F},
                              .k = {5.2064F, 4.2314F, 3.7549F}}},
                            {"aluminium",
                             {.kind = Kind::conductor,
                              .eta = {1.6574F, 0.8803F, 0.5212F},
                              .k = {9.2239F, 6.2695F, 4.8370F}}},
                            {"silver",
                             {.kind = Kind::conductor,
                              .eta = {0.1552F, 0.1167F, 0.1383F},
                              .k = {4.8283F, 3.1222F, 2.1470F}}},
                            {"gold",
                             {.kind = Kind::conductor,
                              .eta = {0.1431F, 0.3749F, 1.4424F},
                              .k = {3.9831F, 2.3857F, 1.6032F}}},
                            {"copper",
                             {.kind = Kind::conductor,
                              .eta = {0.2004F, 0.9240F, 1.1022F},
                              .k = {3.9129F, 2.4528F, 2.1421F}}},
                            {"glass", {.kind = Kind::glass}},
                            {"glossy", {.roughness = 0.3F}},
                            {"diffuse", {.kind = Kind::diffuse, .color = {0.8F, 0.8F, 0.8F}}}};

}  // namespace

std::vector<std::string> material_names() {
    std::vector<std::string> names;
    for (const Named& named : kMaterials) names.emplace_back(named.name);
    return names;
}

std::optional<Material> find_material(std::string_view name) {
    for (const Named& named : kMaterials)
        if (named.name == name) return named.material;
    return std::nullopt;
}

float fresnel_dielectric(float cosine, float eta) {
    const float c = std::clamp(cosine, 0.0F, 1.0F);
    const float square = 1 - (1 - c * c) / (eta * eta);
    if (square <= 0) return 1;
    const float behind = std::sqrt(square);
    const float parallel = (eta * c - behind) / (eta * c + behind);
    const float across = (c - eta * behind) / (c + eta * behind);
    return 0.5F * (parallel * parallel + across * across);
}

float fresnel_conductor(float cosine, float eta, float k) {
    const float c = std::clamp(cosine, 0.0F, 1.0F), c2 = c * c, s2 = 1 - c2;
    const float t0 = eta * eta - k * k - s2;
    const float sum = std::sqrt(t0 * t0 + 4 * eta * eta * k * k);  // a^2 + b^2
    const float a = std::sqrt(std::max(0.0F, 0.5F * (sum + t0)));
    const float across = (sum + c2 - 2 * a * c) / (sum + c2 + 2 * a * c);
    const float parallel =
        across * (c2 * sum + s2 * s2 - 2 * a * c * s2) / (c2 * sum + s2 * s2 + 2 * a * c * s2);
    return 0.5F * (across + parallel);
}

bool reflects(const Material& m) { return m.kind != Kind::diffuse && m.kind != Kind::flat; }

V3f reflectance(const Material& m, float cosine) {
    if (m.kind != Kind::conductor) return m.color;
    return {m.color.x * fresnel_conductor(cosine, m.eta.x, m.k.x),
            m.color.y * fresnel_conductor(cosine, m.eta.y, m.k.y),
            m.color.z * fresnel_conductor(cosine, m.eta.z, m.k.z)};
}

}  // namespace chromeball
