#pragma once

#include <fstream>
#include <string>

#include "render/mesh.h"

namespace chromeball::test {

/// A cube from -1 to 1, eight positions shared by its faces, no normals.
inline Mesh cube_mesh() {
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.emplace_back(i & 1 ? 1.0F : -1.0F, i & 2 ? 1.0F : -1.0F,
                                    i & 4 ? 1.0F : -1.0F);
    const std::uint32_t quads[6][4] = {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3},
                                       {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};
    for (const auto& q : quads) {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    return mesh;
}

inline void write_text(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

}  // namespace chromeball::test
