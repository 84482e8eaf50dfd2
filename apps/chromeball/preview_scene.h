#pragma once

#include <CLI/App.hpp>

#include <optional>
#include <string>

#include "console.h"
#include "render/scene.h"

namespace chromeball {

/// What is looked at; texts as typed.
struct SceneOptions {
    std::string mesh = "sphere";
    std::optional<std::string> set;
    std::string material = "mirror";
    std::optional<double> roughness;
    std::optional<double> ior;
    std::optional<std::string> color;
};

void add_scene_options(CLI::App& command, SceneOptions& options);

/// What was typed wrong, before anything is read. Throws Error (usage).
void check_scene_options(const SceneOptions& options);

/// Within the unit sphere around the origin; a set of spheres with radius 1 each. Throws Error.
Scene scene_of(const SceneOptions& options, const Console& console);

}  // namespace chromeball
