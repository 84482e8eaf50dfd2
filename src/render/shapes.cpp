#include "render/shapes.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>

#include "render/teapot.h"

namespace chromeball {
namespace {

using std::numbers::pi;

/// A surface over (u, v) in the unit square.
using Surface = std::function<V3d(double u, double v)>;

/// Perpendicular to a surface by central differences, towards dp/du x dp/dv; where those have no
/// length (at a pole) from a little further in.
V3d normal_of(const Surface& surface, double u, double v) {
    constexpr double kStep = 1e-4;
    for (const double inward : {0.0, 1e-3, 1e-2}) {
        const double s = u + inward * (0.5 - u), t = v + inward * (0.5 - v);
        const V3d n = (surface(s + kStep, t) - surface(s - kStep, t))
                          .cross(surface(s, t + kStep) - surface(s, t - kStep));
        if (n.length() > 1e-12) return n.normalized();
    }
    return {0, 1, 0};
}

/// As floats, what is 0 but for rounding being 0: at a pole all positions are one.
V3f without_dust(const V3d& p) {
    const auto part = [](double x) { return std::abs(x) < 1e-9 ? 0.0F : static_cast<float>(x); };
    return {part(p.x), part(p.y), part(p.z)};
}

/// A grid of nu x nv cells over the unit square, two triangles each; those that shrink to nothing
/// at a pole are left out. Columns and rows go round where the surface does.
void add_grid(Mesh& mesh, const Surface& surface, int nu, int nv, bool round_u, bool round_v) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const int columns = round_u ? nu : nu + 1, rows = round_v ? nv : nv + 1;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const double u = double(i) / nu, v = double(j) / nv;
            mesh.positions.push_back(without_dust(surface(u, v)));
            mesh.normals.push_back(V3f(normal_of(surface, u, v)));
        }
    const auto at = [&](int i, int j) {
        return first + static_cast<std::uint32_t>((j % rows) * columns + i % columns);
    };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const V3f &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        if (V3d(q - p).cross(V3d(r - p)).length() > 1e-10) mesh.triangles.push_back({a, b, c});
    };
    for (int j = 0; j < nv; ++j)
        for (int i = 0; i < nu; ++i) {
            add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
}

/// On the unit sphere, u counter-clockwise around +Y, v from -Y to +Y.
V3d on_sphere(double u, double v) {
    const double around = 2 * pi * u, up = pi * (v - 0.5);
    return {std::cos(up) * std::sin(around), std::sin(up), std::cos(up) * std::cos(around)};
}

/// Cells along a side that has so many at detail 1.
int cells(int usual, double detail) {
    return std::max(8, static_cast<int>(std::lround(usual * detail)));
}

Mesh torus(double detail) {
    Mesh mesh;
    constexpr double kTube = 0.3;
    add_grid(
        mesh,
        [](double u, double v) {
            const double around = 2 * pi * u, tube = 2 * pi * v;
            const double r = 1 - kTube + kTube * std::cos(tube);
            return V3d(r * std::sin(around), kTube * std::sin(tube), r * std::cos(around));
        },
        cells(256, detail), cells(96, detail), true, true);
    return mesh;
}

/// A square floor seen from above.
Mesh plane(double) {
    Mesh mesh;
    const double side = std::numbers::sqrt2;
    add_grid(
        mesh, [&](double u, double v) { return V3d(side * (u - 0.5), 0, side * (0.5 - v)); }, 1, 1,
        false, false);
    return mesh;
}

/// A tube along a trefoil: the torus knot (2, 3).
Mesh knot(double detail) {
    const auto line = [](double u) {
        const double t = 2 * pi * u;
        const double r = 2 + std::cos(3 * t);
        return V3d(r * std::cos(2 * t), r * std::sin(2 * t), 1.2 * std::sin(3 * t));
    };
    Mesh mesh;
    add_grid(
        mesh,
        [&](double u, double v) {
            constexpr double kTube = 0.55, kStep = 1e-4;
            const V3d ahead = (line(u + kStep) - line(u - kStep)).normalized();
            // A frame that turns with the knot's own radius, so that it closes.
            const V3d out = line(u), side = (out - ahead * out.dot(ahead)).normalized();
            const V3d up = side.cross(ahead);
            const double tube = 2 * pi * v;
            return line(u) + (side * std::cos(tube) + up * std::sin(tube)) * kTube;
        },
        cells(512, detail), cells(64, detail), true, true);
    fit_into_unit_sphere(mesh);
    return mesh;
}

/// A polished bean after Anish Kapoor's Cloud Gate: half as high as long, rounder above than below,
/// with an arch to walk through whose ceiling is hollowed further.
Mesh bean(double detail) {
    Mesh mesh;
    add_grid(
        mesh,
        [](double u, double v) {
            const V3d d = on_sphere(u, v);
            V3d p(d.x, 0.5 * d.y, 0.62 * d.z);
            const double below = 0.5 * (1 - d.y);  // 0 at the top, 1 at the bottom
            const double along = std::exp(-p.x * p.x / 0.16),
                         around = along * std::exp(-p.z * p.z / 0.08);
            // The ends bend down to the ground, the middle rises off it.
            p.y += below * below * (0.34 * along + 0.16 * around) - 0.12 * p.x * p.x;
            return p;
        },
        cells(256, detail), cells(197, detail), true, false);
    fit_into_unit_sphere(mesh);
    return mesh;
}

std::vector<double> numbers_in(std::string_view text) {
    std::vector<double> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (at != end) {
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error == std::errc()) numbers.push_back(value);
        at = error == std::errc() ? next : at + 1;
    }
    return numbers;
}

/// Bernstein's cubics.
std::array<double, 4> bernstein(double t) {
    const double s = 1 - t;
    return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
}

/// Martin Newell's teapot of 1975 as published: bicubic Bezier patches, their control points in a
/// Z-up world.
Mesh teapot(double detail) {
    const std::vector<double> data = numbers_in(teapot_patches());
    const auto patches = static_cast<std::size_t>(data.at(0));
    const double* numbers = data.data() + 1;
    const double* points = numbers + 16 * patches + 1;
    assert(data.size() == 2 + 16 * patches + 3 * static_cast<std::size_t>(points[-1]));
    Mesh mesh;
    const int side = cells(32, detail);
    for (std::size_t patch = 0; patch < patches; ++patch)
        add_grid(
            mesh,
            [&](double u, double v) {
                const auto a = bernstein(u), b = bernstein(v);
                V3d p(0, 0, 0);
                for (std::size_t i = 0; i < 16; ++i) {
                    const double* c =
                        points + 3 * (static_cast<std::size_t>(numbers[16 * patch + i]) - 1);
                    p += V3d(c[0], c[2], -c[1]) * (a[i % 4] * b[i / 4]);
                }
                return p;
            },
            side, side, false, false);
    fit_into_unit_sphere(mesh);
    return mesh;
}

struct Shape {
    std::string_view name;
    Mesh (*make)(double detail);
};

const Shape kShapes[] = {
    {"sphere",
     [](double detail) { return tessellated_sphere(cells(192, detail), cells(96, detail)); }},
    {"torus", torus},
    {"plane", plane},
    {"knot", knot},
    {"bean", bean},
    {"teapot", teapot}};

}  // namespace

std::vector<std::string> shape_names() {
    std::vector<std::string> names;
    for (const Shape& shape : kShapes) names.emplace_back(shape.name);
    return names;
}

std::optional<Mesh> shape(std::string_view name, double detail) {
    for (const Shape& shape : kShapes)
        if (shape.name == name) return shape.make(detail);
    return std::nullopt;
}

Mesh tessellated_sphere(int around, int down) {
    Mesh mesh;
    add_grid(mesh, on_sphere, around, down, true, false);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        mesh.normals[i] = mesh.positions[i].normalized();
    return mesh;
}

}  // namespace chromeball
