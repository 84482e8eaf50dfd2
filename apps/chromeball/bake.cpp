#include "render/bake.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <memory>
#include <optional>

#include "color/color.h"
#include "commands.h"
#include "console.h"
#include "core/names.h"
#include "light_input.h"
#include "map_files.h"
#include "map_job.h"
#include "numbers.h"
#include "options.h"
#include "preview_scene.h"
#include "refuse.h"
#include "render/environment.h"
#include "resample/resample.h"

namespace chromeball {
namespace {

struct BakeCommand {
    std::string scene;
    std::string at;
    std::vector<std::string> hidden;
    std::optional<std::string> mirror;
    LightOptions light;  // input empty: a white sky
    int samples = 16;
    MapOptions map;
    CommonOptions common;
};

void hide(Scene& scene, const std::string& name) {
    if (scene.hide(name) > 0) return;
    refuse(fmt::format("--hide {}: the scene has no object of that name; {}", name,
                       did_you_mean(name, scene.names(), "it has")));
}

/// The plane that --mirror-plane tells: point and normal, three points, or a flat object, which is
/// then hidden.
Plane plane_from(Scene& scene, const std::string& text) {
    for (const Object& object : scene.objects) {
        if (object.name != text) continue;
        const auto plane = plane_of(object);
        if (!plane)
            refuse(
                fmt::format("--mirror-plane {}: this object is not flat; give a point and a "
                            "normal, or three points",
                            text));
        scene.hide(text);
        return *plane;
    }
    if (text.find_first_not_of("0123456789+-.,eE ") != std::string::npos)
        refuse(fmt::format("--mirror-plane {}: the scene has no object of that name; it has {}",
                           text, quoted_list(scene.names())));
    const auto n = parse_numbers("--mirror-plane", text, {6, 9},
                                 "PX,PY,PZ,NX,NY,NZ, three points, or an object's name");
    const V3d p(n[0], n[1], n[2]), q(n[3], n[4], n[5]);
    if (n.size() == 9) {
        const auto plane = plane_through(p, q, V3d(n[6], n[7], n[8]));
        if (!plane) refuse(fmt::format("--mirror-plane {}: the points are on one line", text));
        return *plane;
    }
    if (!(q.length() > 0)) refuse(fmt::format("--mirror-plane {}: the normal has no length", text));
    return {p, q.normalized()};
}

Environment sky_of(const BakeCommand& o, const ColorConfig& colors, const Console& console) {
    if (!o.light.input.empty()) {
        const Light light = read_light(o.light, o.map, colors, console);
        return {light.pixels, *light.layout};
    }
    const Layout& latlong = *find_layout("latlong");
    Image white(latlong.picture(1), 4);
    for (int x = 0; x < white.width(); ++x) std::fill_n(white.pixel(x, 0), 4, 1.0F);
    return {std::move(white), latlong};
}

/// The point to bake from, and what is in front of the mirror, if there is one.
V3d point_of(const BakeCommand& o, Scene& scene, BakeOptions& how, const Console& console) {
    const V3d at = point_in(scene, "--at", o.at);
    if (!o.mirror) return at;
    const Plane plane = plane_from(scene, *o.mirror);
    const double height = (at - plane.point).dot(plane.normal);
    if (height == 0) refuse("--at: the eye lies in the mirror's plane; nothing is seen in it");
    // The mirror itself lies in the plane, whoever told it: just before it.
    const V3d front = plane.normal * (height > 0 ? 1.0 : -1.0);
    how.clip = ClipPlane{plane.point + front * (1e-4 * bounds_of(scene).radius), front};
    const V3d image = mirrored(at, plane);
    console.say(fmt::format("{}: the eye {:.6g},{:.6g},{:.6g} is mirrored to {:.6g},{:.6g},{:.6g}",
                            o.scene, at.x, at.y, at.z, image.x, image.y, image.z));
    return image;
}

/// Six views are six files, unless a file's name or the words ask for one picture.
OutputPlan planned(OutputOptions output) {
    if (!output.layout && !output.preset &&
        std::filesystem::path(output.output).extension().empty())
        output.layout = "faces";
    return plan_output(output);
}

void run_bake(const BakeCommand& o) {
    const Console console(o.common.quiet);
    const UsedThreads threads(o.common);
    const OutputPlan plan = planned(o.map.output);
    const ColorConfig colors = ColorConfig::load(o.light.color.ocio);
    check_map_options(o.map, plan, colors);
    use_instructions(o.map);
    check_from(o.light.from);
    check_output(plan, o.scene);
    Scene scene = scene_file(o.scene, console);
    BakeOptions how;
    how.samples = o.samples;
    const V3d at = point_of(o, scene, how, console);
    for (const std::string& name : o.hidden) hide(scene, name);

    const int size = o.map.size.value_or(512);
    if (!std::has_single_bit(static_cast<unsigned>(size)))
        console.say(fmt::format("--size {}: no power of two; real-time programs prefer {}", size,
                                std::bit_ceil(static_cast<unsigned>(size))));
    how.size = size;
    const ResampleOptions turn = resampling(o.map, plan, told_rotation(o.map).value_or(Rotation()));
    const Environment sky = sky_of(o, colors, console);
    Image map = bake(scene, Tracer(scene), sky, at, how, console.watch("baking"));
    const bool as_it_is = turn.rotation.is_identity() &&
                          (plan.layout->name == "faces" || plan.layout->name == "openexr");
    if (!as_it_is)
        map = resample(map_source(map, *find_layout("openexr")), *plan.layout, size, turn,
                       console.watch("converting"));
    const WrittenMap written =
        write_finished(std::move(map), plan, o.map, turn.rotation, {.source = o.scene}, {}, colors);
    tell(written, plan, o.map, console);
}

}  // namespace

void add_bake(CLI::App& app) {
    auto o = std::make_shared<BakeCommand>();
    auto* command = app.add_subcommand("bake", "Views of a 3-D scene from a point, as a map");
    command->add_option("scene", o->scene, "Scene file (.gltf, .glb, .obj, ...)")->required();
    command->add_option("-o,--output", o->map.output.output, "Folder for the six views, or a file")
        ->required();
    const std::string what = "Scene";
    command
        ->add_option("--at", o->at,
                     "The point: coordinates, or the name of an empty node, camera or object")
        ->type_name("X,Y,Z|NAME")
        ->required()
        ->group(what);
    command
        ->add_option("--hide", o->hidden,
                     "Leave this object out, such as the one that will be mirroring; repeatable")
        ->type_name("NAME")
        ->group(what);
    command
        ->add_option("--mirror-plane", o->mirror,
                     "The views from the image of --at in a flat mirror, of what is before it: "
                     "point and normal, three points, or a flat object's name")
        ->type_name("PLANE")
        ->group(what);
    command
        ->add_option("--light", o->light.input,
                     "Map, folder of faces or photo of a ball that lights the scene and stands "
                     "behind it (default: a white sky)")
        ->type_name("ENV")
        ->group(what);
    command->add_option("--from", o->light.from, "What --light is; as in preview")
        ->capture_default_str()
        ->group(what);
    command->add_option("--samples", o->samples, "Of each pixel; best a square: 4, 9, 16")
        ->check(CLI::Range(1, 65536))
        ->capture_default_str()
        ->group(what);
    add_map_options(*command, o->map);
    add_color_options(*command, o->light.color);
    add_common_options(*command, o->common);
    command->footer(
        "Examples:\n"
        "  chromeball bake room.gltf --at probe --hide ball --for alias -o faces\n"
        "  chromeball bake room.gltf --at 0,1.6,3 --mirror-plane floor --size 1024 "
        "-o floor");
    command->callback([o] { run_bake(*o); });
}

}  // namespace chromeball
