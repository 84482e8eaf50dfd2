#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <vector>

namespace chromeball {

using Imath::V2f;
using Imath::V3f;

/// Scrambles a number; the same on every machine.
constexpr std::uint32_t hashed(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    return x ^ (x >> 16);
}

/// The i-th point of a (0,2)-sequence in the unit square (van der Corput's and Sobol's second
/// dimension), scrambled by a seed: any 2^n points in a row, from a multiple of 2^n on, are spread
/// evenly.
V2f spread_point(std::uint32_t i, std::uint32_t seed);

/// What a picture's pixels are means over.
enum class PixelFilter {
    box,       ///< the pixel itself
    triangle,  ///< two pixels wide
    gaussian,  ///< standard deviation half a pixel, three pixels wide
};

/// Where in and around a pixel samples are taken so that their mean is the filtered pixel.
struct PixelSamples {
    std::vector<V2f> offsets;  ///< from the pixel's top-left corner
    float step = 1;            ///< between samples, pixels
};

/// The round-th set of `count` samples: a regular grid where count is a square.
PixelSamples pixel_samples(PixelFilter filter, int count, std::uint32_t round);

/// A direction within the hemisphere around +Z, with density cosine / pi.
V3f cosine_direction(const V2f& at);

/// A microfacet's normal that is seen from v (a unit vector with v.z > 0, +Z the surface's normal),
/// of GGX with roughness alpha, with density G1(v) max(0, v.h) D(h) / v.z.
/// Heitz: Sampling the GGX Distribution of Visible Normals, 2018.
V3f visible_facet(const V3f& v, float alpha, const V2f& at);

/// GGX's density of facets.
float ggx_density(const V3f& h, float alpha);
/// Smith's Lambda for GGX.
float ggx_lambda(const V3f& v, float alpha);

}  // namespace chromeball
