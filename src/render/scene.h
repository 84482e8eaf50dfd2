#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/material.h"
#include "render/mesh.h"

namespace chromeball {

/// A sphere that is no mesh: as round as numbers allow.
struct Ball {
    V3d center{0, 0, 0};
    double radius = 1;
};

/// A thing with one material: a mesh, or a ball where there is one.
struct Object {
    std::string name;
    Mesh mesh;
    std::optional<Ball> ball;
    Material material;
};

/// What is seen, in one frame; right-handed, +Y up.
struct Scene {
    std::vector<Object> objects;
    /// Places with names: cameras and empty nodes of a file.
    struct Place {
        std::string name;
        V3d position{0, 0, 0};
    };
    std::vector<Place> places;

    std::size_t triangles() const;
};

/// The sphere around everything that is not farther than it must be: middle of the box, and the
/// farthest point from there. Radius 0 of an empty scene.
Ball bounds_of(const Scene& scene);

/// As fit_into_unit_sphere(), of a whole scene.
void fit_into_unit_sphere(Scene& scene);

}  // namespace chromeball
