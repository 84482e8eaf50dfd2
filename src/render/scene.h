#pragma once

#include <optional>
#include <string>
#include <vector>

#include "map/orientation.h"
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

/// A point with a name: an empty node of a file.
struct Place {
    std::string name;
    V3d position{0, 0, 0};
};

/// A camera of a file: looks along its -Z, +Y up.
struct SceneCamera {
    std::string name;
    V3d position{0, 0, 0};
    Rotation to_world;
    double fov_degrees = 35;  ///< vertical
};

/// What is seen, in one frame; right-handed, +Y up.
struct Scene {
    std::vector<Object> objects;
    std::vector<Place> places;
    std::vector<SceneCamera> cameras;

    std::size_t triangles() const;
    /// The names of all objects, without repetition.
    std::vector<std::string> names() const;
    /// Takes out the objects of a name; how many there were.
    std::size_t hide(const std::string& name);
    /// The position of a place, camera or object (the middle of its box) of a name, looked for in
    /// this order.
    std::optional<V3d> place(const std::string& name) const;
};

/// Makes all meshes of a scene fit to be rendered, see repaired(). Objects of which nothing is left
/// are left out, with a note; throws Error where none is left.
void repair(Scene& scene, const std::string& name, std::vector<std::string>& notes);

/// The sphere around everything that is not farther than it must be: middle of the box, and the
/// farthest point from there. Radius 0 of an empty scene.
Ball bounds_of(const Scene& scene);

}  // namespace chromeball
