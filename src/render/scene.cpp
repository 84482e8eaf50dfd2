#include "render/scene.h"

#include <algorithm>

namespace chromeball {

std::size_t Scene::triangles() const {
    std::size_t count = 0;
    for (const Object& object : objects) count += object.mesh.triangles.size();
    return count;
}

Ball bounds_of(const Scene& scene) {
    Box box;
    bool first = true;
    const auto add = [&](const V3d& low, const V3d& high) {
        for (int k = 0; k < 3; ++k) {
            box.low[k] = first ? low[k] : std::min(box.low[k], low[k]);
            box.high[k] = first ? high[k] : std::max(box.high[k], high[k]);
        }
        first = false;
    };
    for (const Object& object : scene.objects) {
        if (object.ball) {
            const V3d r(object.ball->radius, object.ball->radius, object.ball->radius);
            add(object.ball->center - r, object.ball->center + r);
        } else if (!object.mesh.positions.empty()) {
            const Box of = box_of(object.mesh);
            add(of.low, of.high);
        }
    }
    if (first) return {V3d(0, 0, 0), 0};
    const V3d middle = box.middle();
    double furthest = 0;
    for (const Object& object : scene.objects) {
        if (object.ball)
            furthest =
                std::max(furthest, (object.ball->center - middle).length() + object.ball->radius);
        else
            for (const V3f& p : object.mesh.positions)
                furthest = std::max(furthest, (V3d(p) - middle).length());
    }
    return {middle, furthest};
}

void fit_into_unit_sphere(Scene& scene) {
    const Ball bounds = bounds_of(scene);
    if (!(bounds.radius > 0)) return;
    const auto fitted = [&](const V3d& p) { return (p - bounds.center) / bounds.radius; };
    for (Object& object : scene.objects) {
        for (V3f& p : object.mesh.positions) p = V3f(fitted(V3d(p)));
        if (object.ball)
            object.ball = Ball{fitted(object.ball->center), object.ball->radius / bounds.radius};
    }
    for (Scene::Place& place : scene.places) place.position = fitted(place.position);
}

}  // namespace chromeball
