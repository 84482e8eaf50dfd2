#include "preview_scene.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>

#include "core/names.h"
#include "numbers.h"
#include "options.h"
#include "refuse.h"
#include "render/load.h"
#include "render/material.h"
#include "render/shapes.h"

namespace chromeball {
namespace {

V3f color_from(const std::string& text) {
    auto c = parse_numbers("--color", text, {1, 3}, "V or R,G,B, each from 0 to 1");
    if (c.size() == 1) c = {c[0], c[0], c[0]};
    for (const double part : c)
        if (!(part >= 0 && part <= 1))
            refuse(fmt::format("--color {}: a surface gives back a part from 0 to 1", text));
    return V3f(V3d(c[0], c[1], c[2]));
}

Material material_of(const SceneOptions& o) {
    auto material = find_material(o.material);
    if (!material)
        refuse(fmt::format("--material {}: not known; {}", o.material,
                           did_you_mean(o.material, material_names())));
    using Kind = Material::Kind;
    const bool metal = material->kind == Kind::mirror || material->kind == Kind::conductor;
    if (o.roughness && !metal)
        refuse(
            fmt::format("--roughness: {} has none; it goes with mirrors and metals", o.material));
    if (o.ior && material->kind != Kind::glass)
        refuse(fmt::format("--ior: {} has none; it goes with glass", o.material));
    if (o.roughness) material->roughness = static_cast<float>(*o.roughness);
    if (o.ior) material->ior = static_cast<float>(*o.ior);
    if (o.color) material->color = color_from(*o.color);
    return *material;
}

/// Grey, chrome, glossy and white matte spheres side by side, as on set.
Scene lookdev() {
    Scene scene;
    Material grey = *find_material("diffuse");
    grey.color = V3f(0.18F);
    const std::pair<const char*, Material> spheres[] = {{"grey", grey},
                                                        {"chrome", *find_material("chrome")},
                                                        {"glossy", *find_material("glossy")},
                                                        {"diffuse", *find_material("diffuse")}};
    double x = -3.3;
    for (const auto& [name, material] : spheres) {
        scene.objects.push_back({name, {}, Ball{V3d(x, 0, 0), 1}, material});
        x += 2.2;
    }
    return scene;
}

Mesh mesh_from(const std::string& name, const Console& console) {
    if (auto known = shape(name)) return std::move(*known);
    // A word without dot or slash is no file that was forgotten, but a name mistyped.
    if (!std::filesystem::exists(name) && name.find_first_of("./") == std::string::npos)
        refuse(fmt::format("--mesh {}: no such mesh or file; {}", name,
                           did_you_mean(name, shape_names(), "choose a file or")));
    std::vector<std::string> notes;
    Mesh mesh = load_mesh(name, notes);
    for (const std::string& note : notes) console.warn(note);
    console.say(fmt::format("{}: {} triangles", name, mesh.triangles.size()));
    fit_into_unit_sphere(mesh);
    return mesh;
}

}  // namespace

void add_material_options(CLI::App& command, SceneOptions& o, const std::string& group) {
    command.add_option("--material", o.material, comma_list(material_names()))
        ->type_name("NAME")
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--roughness", o.roughness,
                    "Of mirrors and metals: 0 polished, 1 rough (default: 0; glossy: 0.3)")
        ->check(finite())
        ->check(CLI::Range(0.0, 1.0))
        ->group(group);
}

void add_scale_option(CLI::App& command, double& scale, const std::string& group) {
    command
        .add_option("--scale", scale,
                    "Size of the object, times the ball's (or its own, where that is kept)")
        ->check(finite())
        ->check(CLI::Range(1e-3, 1e3))
        ->capture_default_str()
        ->group(group);
}

void add_samples_option(CLI::App& command, int& samples, const std::string& group) {
    command.add_option("--samples", samples, "Of each pixel; best a square: 4, 9, 16")
        ->check(CLI::Range(1, 65536))
        ->capture_default_str()
        ->group(group);
}

void add_scene_options(CLI::App& command, SceneOptions& o) {
    const std::string group = "Object";
    command
        .add_option("--mesh", o.mesh,
                    comma_list(shape_names()) +
                        ", or a file (.obj, .ply, .stl, .gltf, .glb); scaled into a sphere of "
                        "radius 1")
        ->type_name("NAME|FILE")
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--set", o.set,
                    "Several objects instead; lookdev: grey, chrome, glossy and white spheres")
        ->check(CLI::IsMember({"lookdev"}))
        ->group(group);
    command
        .add_option("--scene", o.scene,
                    "A scene file instead (.gltf, .glb, ...): objects with their materials, in "
                    "its own frame; its first camera is the view unless --orbit is given")
        ->type_name("FILE")
        ->group(group);
    add_material_options(command, o, group);
    command.add_option("--ior", o.ior, "Index of refraction of glass (default: 1.5)")
        ->check(finite())
        ->check(CLI::Range(1.0, 4.0))
        ->group(group);
    command
        .add_option("--color", o.color,
                    "What of the light it gives back, 0 to 1 (default: 1; diffuse: 0.8)")
        ->type_name("V|R,G,B")
        ->group(group);
}

void check_scene_options(const SceneOptions& o) {
    material_of(o);
    if (o.scene && o.set) refuse("--scene and --set contradict each other; give one");
}

Scene object_file(const std::string& path, const SceneOptions& o, std::vector<std::string>& notes) {
    Scene scene;
    scene.objects.push_back({path, load_mesh(path, notes), std::nullopt, material_of(o)});
    return scene;
}

void scale(Scene& scene, double factor) {
    for (Object& object : scene.objects) {
        for (V3f& p : object.mesh.positions) p *= static_cast<float>(factor);
        if (object.ball)
            object.ball = Ball{object.ball->center * factor, object.ball->radius * factor};
    }
}

Mesh page_mesh(const SceneOptions& o, const Console& console) {
    // About a third of a megabyte for the bean.
    constexpr double kDetail = 0.4;
    if (auto known = shape(o.mesh, kDetail)) return std::move(*known);
    return mesh_from(o.mesh, console);
}

Scene scene_file(const std::string& path, const Console& console) {
    Scene scene = load_scene(path);
    std::vector<std::string> notes;
    repair(scene, path, notes);
    for (const std::string& note : notes) console.warn(note);
    console.say(
        fmt::format("{}: {} objects, {} triangles", path, scene.objects.size(), scene.triangles()));
    return scene;
}

V3d point_in(const Scene& scene, const std::string& option, const std::string& text) {
    if (const auto place = scene.place(text)) return *place;
    // A word with a letter is a name that is not there.
    if (text.find_first_not_of("0123456789+-.,eE ") != std::string::npos) {
        auto names = scene.names();
        for (const Place& place : scene.places) names.push_back(place.name);
        for (const SceneCamera& camera : scene.cameras) names.push_back(camera.name);
        refuse(fmt::format("{} {}: the scene has nothing of that name; {}", option, text,
                           did_you_mean(text, names, "give X,Y,Z or")));
    }
    const auto n = parse_numbers(option, text, {3}, "X,Y,Z or a name");
    return {n[0], n[1], n[2]};
}

Scene scene_of(const SceneOptions& o, const Console& console) {
    if (o.scene) return scene_file(*o.scene, console);
    if (o.set) return lookdev();
    Object object;
    object.name = o.mesh;
    object.material = material_of(o);
    if (o.mesh == "sphere")
        object.ball = Ball{};
    else
        object.mesh = mesh_from(o.mesh, console);
    Scene scene;
    scene.objects.push_back(std::move(object));
    return scene;
}

}  // namespace chromeball
