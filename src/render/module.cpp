#include "render/module.h"

#include <fmt/format.h>

#include <string_view>

#include "core/error.h"
#include "core/module.h"

namespace chromeball {
namespace render {
namespace {

constexpr char kName[] = "chromeball_render.so";

const Module& loaded_module() {
    constexpr std::string_view kWayOut = "install chromeball again";
    std::string reason;
    void* handle = load_module(kName, reason);
    if (!handle)
        throw Error(Error::Kind::failed, fmt::format("{}, which traces rays, cannot be loaded: "
                                                     "{}; {}",
                                                     kName, reason, kWayOut));
    auto* entry = reinterpret_cast<ModuleEntry*>(module_symbol(handle, kModuleEntry));
    const Module* found = entry ? entry() : nullptr;
    if (!found || std::string_view(found->version) != CHROMEBALL_VERSION)
        throw Error(
            Error::Kind::failed,
            fmt::format("{} is of version {}, but {} is needed; {}", kName,
                        found ? found->version : "something else", CHROMEBALL_VERSION, kWayOut));
    return *found;
}

}  // namespace

const Module& module() {
    static const Module& loaded = loaded_module();
    return loaded;
}

}  // namespace render

Tracer::Tracer(const Scene& scene)
    : scene_(render::module().build(scene), render::module().destroy) {}

void Tracer::intersect(const RayPacket& rays, Hit (&hits)[RayPacket::kRays]) const {
    render::module().intersect_packet(scene_.get(), rays, hits);
}

Hit Tracer::intersect(const V3f& origin, const V3f& direction, float from) const {
    return render::module().intersect(scene_.get(), origin, direction, from);
}

Scene load_scene(const std::string& path, const LoadLimits& limits) {
    return render::module().load(path, limits);
}

Mesh load_mesh(const std::string& path, std::vector<std::string>& notes, const LoadLimits& limits) {
    const Scene scene = load_scene(path, limits);
    Mesh all;
    for (const Object& object : scene.objects) {
        const auto first = static_cast<std::uint32_t>(all.positions.size());
        const Mesh& mesh = object.mesh;
        all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
        all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
        all.normals.resize(all.positions.size(), V3f(0, 0, 0));
        for (const auto& t : mesh.triangles)
            all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return repaired(std::move(all), path, notes);
}

}  // namespace chromeball
