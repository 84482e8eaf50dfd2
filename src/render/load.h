#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/scene.h"

namespace chromeball {

/// What is refused before memory runs out.
struct LoadLimits {
    std::uintmax_t file_bytes = std::uintmax_t{2} << 30;
    std::size_t triangles = 50'000'000;
};

/// The meshes of a file (OBJ, PLY, STL, glTF and others) as it holds them: an object for each mesh
/// of each node, in the file's own frame and scale, with its names and materials as far as they are
/// known here. Normals may be missing. Throws Error that names the file: missing, empty, too large,
/// not a mesh file, nothing but points and lines.
Scene load_scene(const std::string& path, const LoadLimits& limits = {});

/// All meshes of a file as one, fit to be rendered (see repaired()), in the file's own frame.
Mesh load_mesh(const std::string& path, std::vector<std::string>& notes,
               const LoadLimits& limits = {});

}  // namespace chromeball
