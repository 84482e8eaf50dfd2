#include "render/bake.h"

#include <algorithm>
#include <cmath>

#include "map/layouts.h"

namespace chromeball {

Image bake(const Scene& scene, const Tracer& tracer, const Environment& environment, const V3d& at,
           const BakeOptions& options, const Watch& watch) {
    const CubeLayout& layout = cube_layouts().front();
    const PreviewOptions how{.shading = Shading::raytrace,
                             .samples = options.samples,
                             .background = true,
                             .clip = options.clip};
    Image column({options.size, 6 * options.size}, 4);
    for (int i = 0; i < 6; ++i) {
        const Face& face = layout.faces[static_cast<std::size_t>(i)];
        const V3d up = -face.down, back = -layout.forward(i);
        const Rotation turn = *Rotation::nearest(std::array{
            face.right.x, up.x, back.x, face.right.y, up.y, back.y, face.right.z, up.z, back.z});
        const View view = View::at({options.size, options.size}, at, turn, 90);
        Watch part = watch;
        if (watch.progress) part.progress = [&, i](double done) { watch.progress((i + done) / 6); };
        const Image seen = preview(scene, tracer, environment, view, how, nullptr, part);
        std::copy_n(seen.row(0), static_cast<std::ptrdiff_t>(seen.size().pixels()) * 4,
                    column.row(i * options.size));
    }
    return column;
}

std::optional<Plane> plane_through(const V3d& a, const V3d& b, const V3d& c) {
    const V3d n = (b - a).cross(c - a);
    const double longest = std::max((b - a).length2(), (c - a).length2());
    if (!(n.length() > 1e-9 * longest)) return std::nullopt;
    return Plane{a, n.normalized()};
}

std::optional<Plane> plane_of(const Object& object) {
    if (object.ball) return std::nullopt;
    const Mesh& mesh = object.mesh;
    std::optional<Plane> plane;
    double largest = 0;
    for (const auto& t : mesh.triangles) {
        const V3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
        const double area = (b - a).cross(c - a).length();
        if (area <= largest) continue;
        if (const auto found = plane_through(a, b, c)) {
            largest = area;
            plane = found;
        }
    }
    if (!plane) return std::nullopt;
    const Box box = box_of(mesh);
    const double tolerance = 1e-3 * (box.high - box.low).length();
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t i : t)
            if (std::abs((V3d(mesh.positions[i]) - plane->point).dot(plane->normal)) > tolerance)
                return std::nullopt;
    return plane;
}

V3d mirrored(const V3d& eye, const Plane& plane) {
    return eye - plane.normal * (2 * (plane.normal.dot(eye) - plane.normal.dot(plane.point)));
}

}  // namespace chromeball
