#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/mesh.h"

namespace chromeball {

/// The meshes known by name, in the order of the help text: sphere, torus, plane, knot, bean,
/// teapot.
std::vector<std::string> shape_names();

/// One of them, smooth, closed but for the plane and the teapot, within the unit sphere around the
/// origin, +Y up; nothing for a name that is none of them. The bean has 100 352 triangles; `detail`
/// scales how many there are along each side.
std::optional<Mesh> shape(std::string_view name, double detail = 1);

/// A sphere of radius 1 for those who need triangles.
Mesh tessellated_sphere(int around = 192, int down = 96);

}  // namespace chromeball
