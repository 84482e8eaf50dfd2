#include "light/reflectance.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace chromeball {
namespace {

// The measured tables are collected, in the public domain, at refractiveindex.info.
constexpr std::string_view kTransition =
    "Johnson and Christy, Phys. Rev. B 9, 5056 (1974), by refractiveindex.info";
constexpr std::string_view kNoble =
    "Johnson and Christy, Phys. Rev. B 6, 4370 (1972), by refractiveindex.info";
constexpr std::string_view kAluminium =
    "Rakic, Appl. Opt. 34, 4755 (1995), by refractiveindex.info, interpolated";

double cosine_of_incidence(const MirrorBall& ball, V2d position, V3d reflected) {
    // It makes twice the angle of incidence with the direction to the camera.
    return std::sqrt(std::max(0.0, (1 - reflected.normalized().dot(ball.ray(position))) / 2));
}

}  // namespace

double fresnel(double cosine, double n, double k) {
    const double c = std::clamp(cosine, 0.0, 1.0), s = 1 - c * c;
    const double real = n * n - k * k - s;
    const double sum = std::sqrt(real * real + 4 * n * n * k * k);  // a^2 + b^2
    const double a = std::sqrt(std::max(0.0, (sum + real) / 2));
    const double across =  // polarised across the plane of incidence
        (sum + c * c - 2 * a * c) / std::max(1e-300, sum + c * c + 2 * a * c);
    const double t = c * c * sum + s * s;
    const double along = across * (t - 2 * a * c * s) / std::max(1e-300, t + 2 * a * c * s);
    return (across + along) / 2;
}

std::array<double, 3> Reflectance::at(double cosine) const {
    std::array<double, 3> r = factor;
    if (constants)
        for (std::size_t c = 0; c < 3; ++c)
            r[c] *= fresnel(cosine, constants->n[c], constants->k[c]);
    return r;
}

const std::vector<BallMaterial>& ball_materials() {
    static const std::vector<BallMaterial> materials{
        {"chromium", {{3.17, 3.18, 2.33}, {3.30, 3.33, 3.14}}, kTransition},
        {"nickel", {{1.99, 1.92, 1.73}, {4.02, 3.61, 2.95}}, kTransition},
        // Iron; alloys and what grows on them change it by some per cent.
        {"steel", {{2.88, 2.95, 2.59}, {3.05, 2.93, 2.77}}, kTransition},
        {"aluminium", {{1.35, 1.01, 0.637}, {7.37, 6.62, 5.47}}, kAluminium},
        {"silver", {{0.06, 0.06, 0.04}, {4.152, 3.586, 2.657}}, kNoble},
    };
    return materials;
}

const BallMaterial* find_ball_material(std::string_view name) {
    const auto& all = ball_materials();
    const auto found = std::ranges::find(all, name, &BallMaterial::name);
    return found == all.end() ? nullptr : &*found;
}

void undo_reflectance(Image& pixels, const MirrorBall& ball, const Affine& to_pixels,
                      const Reflectance& reflectance, bool inside) {
    const Affine from_pixels = to_pixels.inverse();
    const bool anywhere = reflectance.constant() && !inside;
    for_each_band(pixels.height(), 16, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < pixels.width(); ++x) {
                double cosine = 1;
                if (!anywhere) {
                    const V2d position = from_pixels(Vec2<double>(x + 0.5, y + 0.5));
                    const auto d = ball.to_direction(position);
                    if (inside && !d) continue;
                    cosine = d ? cosine_of_incidence(ball, position, *d) : 0;
                }
                const auto r = reflectance.at(cosine);
                for (std::size_t c = 0; c < 3; ++c)
                    pixels.pixel(x, y)[c] /= static_cast<float>(r[c]);
            }
    });
}

}  // namespace chromeball
