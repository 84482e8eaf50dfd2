#include "render/material.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chromeball {
namespace {

TEST(Fresnel, OfGlassHasItsKnownValues) {
    EXPECT_NEAR(fresnel_dielectric(1, 1.5F), 0.04, 1e-6);
    EXPECT_NEAR(fresnel_dielectric(1, 1 / 1.5F), 0.04, 1e-6);
    EXPECT_NEAR(fresnel_dielectric(0, 1.5F), 1, 1e-6);
    EXPECT_EQ(fresnel_dielectric(0.7F, 1 / 1.5F), 1) << "beyond asin(1 / 1.5) = 41.8 degrees";
    EXPECT_LT(fresnel_dielectric(0.75F, 1 / 1.5F), 1);
    // At Brewster's angle only light across the plane is reflected: ((n^2 - 1) / (n^2 + 1))^2 of
    // it.
    const float brewster = std::cos(std::atan(1.5F));
    EXPECT_NEAR(fresnel_dielectric(brewster, 1.5F), 0.5 * std::pow(1.25 / 3.25, 2), 1e-6);
}

TEST(Fresnel, OfAConductorThatAbsorbsNothingIsThatOfGlass) {
    for (int i = 0; i <= 20; ++i) {
        const float c = static_cast<float>(i) / 20;
        EXPECT_NEAR(fresnel_conductor(c, 1.5F, 0), fresnel_dielectric(c, 1.5F), 2e-6) << c;
    }
}

TEST(Fresnel, OfMetalsIsNormalIncidencesFormulaAndGrowsToOne) {
    const auto at_normal = [](double n, double k) {
        return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
    };
    for (const char* name : {"chrome", "aluminium", "silver", "gold", "copper"}) {
        const Material m = *find_material(name);
        const V3f normal = reflectance(m, 1);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(normal[c], at_normal(m.eta[c], m.k[c]), 1e-5) << name;
            EXPECT_NEAR(reflectance(m, 0)[c], 1, 1e-5) << name;
        }
    }
    const V3f gold = reflectance(*find_material("gold"), 1),
              chrome = reflectance(*find_material("chrome"), 1);
    EXPECT_GT(gold.x, 2 * gold.z) << "gold is yellow";
    EXPECT_NEAR(chrome.x, chrome.z, 0.1) << "chrome is grey";
}

TEST(Materials, AreFoundByTheNamesTheyAreListedBy) {
    for (const std::string& name : material_names()) EXPECT_TRUE(find_material(name)) << name;
    EXPECT_FALSE(find_material("velvet"));
}

}  // namespace
}  // namespace chromeball
