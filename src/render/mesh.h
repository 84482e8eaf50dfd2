#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace chromeball {

using Imath::V3d;
using Imath::V3f;

/// Triangles with smooth normals.
struct Mesh {
    std::vector<V3f> positions;
    std::vector<V3f> normals;  ///< unit vectors, one a position; may be missing before repaired()
    /// Three positions each, counter-clockwise seen from outside.
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Makes a mesh fit to be rendered: triangles without area or with positions that are no numbers
/// are dropped, normals that are missing, of length 0 or no numbers are made smooth (edges sharper
/// than 60 degrees stay edges), and a closed mesh that is inside out is turned. Says in `notes`
/// what was done. Throws Error that names the mesh where no triangle is left.
Mesh repaired(Mesh mesh, const std::string& name, std::vector<std::string>& notes);

/// The axis-parallel box around all positions.
struct Box {
    V3d low{0, 0, 0}, high{0, 0, 0};
    V3d middle() const { return (low + high) * 0.5; }
};
Box box_of(const Mesh& mesh);

/// Moves the middle of the mesh's box to the origin and scales it so that the furthest position is
/// 1 away.
void fit_into_unit_sphere(Mesh& mesh);

/// Six times the signed volume; above 0 for a closed mesh whose outside is outside.
double six_volumes(const Mesh& mesh);

}  // namespace chromeball
