#include "render/scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace chromeball {

std::size_t Scene::triangles() const {
    std::size_t count = 0;
    for (const Object& object : objects) count += object.mesh.triangles.size();
    return count;
}

std::vector<std::string> Scene::names() const {
    std::vector<std::string> names;
    for (const Object& object : objects)
        if (std::find(names.begin(), names.end(), object.name) == names.end())
            names.push_back(object.name);
    return names;
}

std::size_t Scene::hide(const std::string& name) {
    return std::erase_if(objects, [&](const Object& object) { return object.name == name; });
}

std::optional<V3d> Scene::place(const std::string& name) const {
    for (const Place& place : places)
        if (place.name == name) return place.position;
    for (const SceneCamera& camera : cameras)
        if (camera.name == name) return camera.position;
    for (const Object& object : objects)
        if (object.name == name)
            return object.ball ? object.ball->center : box_of(object.mesh).middle();
    return std::nullopt;
}

void repair(Scene& scene, const std::string& name, std::vector<std::string>& notes) {
    std::vector<Object> whole;
    for (Object& object : scene.objects) {
        const std::string full = fmt::format("{}: {}", name, object.name);
        try {
            if (!object.ball) object.mesh = repaired(std::move(object.mesh), full, notes);
            whole.push_back(std::move(object));
        } catch (const Error& e) {
            notes.push_back(fmt::format("{}; it is left out", e.what()));
        }
    }
    scene.objects = std::move(whole);
    if (scene.objects.empty())
        throw Error(Error::Kind::failed,
                    fmt::format("{}: none of its objects can be rendered", name));
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

}  // namespace chromeball
