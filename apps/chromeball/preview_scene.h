#pragma once

#include <CLI/App.hpp>

#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "render/scene.h"

namespace chromeball {

/// What is looked at; texts as typed.
struct SceneOptions {
    std::string mesh = "sphere";
    std::optional<std::string> set;
    std::optional<std::string> scene;  ///< a file
    std::string material = "mirror";
    std::optional<double> roughness;
    std::optional<double> ior;
    std::optional<std::string> color;
};

void add_scene_options(CLI::App& command, SceneOptions& options);
/// Those of them that say what any object is made of: --material, --roughness.
void add_material_options(CLI::App& command, SceneOptions& options, const std::string& group);
/// --scale, of an object in a plate.
void add_scale_option(CLI::App& command, double& scale, const std::string& group);
/// --samples, of each pixel of a picture.
void add_samples_option(CLI::App& command, int& samples, const std::string& group);

/// What was typed wrong, before anything is read. Throws Error (usage).
void check_scene_options(const SceneOptions& options);

/// Within the unit sphere around the origin; a set of spheres with radius 1 each; a file's scene in
/// its own frame. Throws Error.
Scene scene_of(const SceneOptions& options, const Console& console);

/// A mesh file's object in its own frame and units; notes: what was repaired. Throws Error.
Scene object_file(const std::string& path, const SceneOptions& options,
                  std::vector<std::string>& notes);

/// Makes all objects larger.
void scale(Scene& scene, double factor);

/// The mesh alone, as coarse as a page can be that is sent around. Throws Error.
Mesh page_mesh(const SceneOptions& options, const Console& console);

/// A file's scene, fit to be rendered. Throws Error.
Scene scene_file(const std::string& path, const Console& console);

/// "X,Y,Z", or the name of a place, camera or object of the scene. Throws Error (usage) that names
/// the option.
V3d point_in(const Scene& scene, const std::string& option, const std::string& text);

}  // namespace chromeball
