#include "render/preview.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <bit>
#include <chrono>
#include <filesystem>
#include <optional>

#include "color/color.h"
#include "commands.h"
#include "console.h"
#include "io/write.h"
#include "light_input.h"
#include "map_files.h"
#include "map_job.h"
#include "numbers.h"
#include "options.h"
#include "picture_file.h"
#include "plate.h"
#include "preview_scene.h"
#include "refuse.h"
#include "render/bake.h"
#include "render/compare.h"
#include "render/page.h"
#include "render/patch.h"
#include "shot/pattern.h"

namespace chromeball {
namespace {

struct PreviewCommand {
    LightOptions light;
    CommonOptions common;
    MapOptions map;
    SceneOptions scene;
    std::string through = "orbit";
    std::optional<std::string> orbit;
    std::optional<double> fov;
    std::optional<std::string> size;
    int turntable = 0;
    int samples = 16;
    double noise = 0;
    std::string filter = "box";
    bool background = false;
    std::string shading = "pixel";
    std::optional<std::string> compare;
    std::optional<std::string> reflect_from;
    std::optional<std::string> html;
    int face = 256;
    std::optional<std::string> over;
    bool patch = false;
    double scale = 1;
};

PixelFilter filter_of(const std::string& name) {
    if (name == "triangle") return PixelFilter::triangle;
    return name == "gaussian" ? PixelFilter::gaussian : PixelFilter::box;
}

std::optional<Size> told_size(const PreviewCommand& o) {
    if (!o.size) return std::nullopt;
    const auto n = parse_numbers("--size", *o.size, {1, 2}, "W,H in pixels");
    const double width = n[0], height = n.size() > 1 ? n[1] : n[0];
    const auto fits = [](double x) { return x >= 1 && x <= 32768 && x == static_cast<int>(x); };
    if (!fits(width) || !fits(height))
        refuse(fmt::format("--size {}: whole numbers from 1 to 32768 are wanted", *o.size));
    return Size{static_cast<int>(width), static_cast<int>(height)};
}

Shading shading_of(const std::string& option, const std::string& name) {
    if (name == "pixel") return Shading::pixel;
    if (name == "vertex") return Shading::vertex;
    if (name == "raytrace") return Shading::raytrace;
    refuse(fmt::format("{} {}: choose pixel, vertex or raytrace", option, name));
}

/// One way to shade, or the two of --compare.
std::vector<Shading> shadings_of(const PreviewCommand& o) {
    if (!o.compare) return {shading_of("--shading", o.shading)};
    const std::size_t comma = o.compare->find(',');
    if (comma == std::string::npos)
        refuse(fmt::format("--compare {}: two ways to shade are wanted, as in pixel,raytrace",
                           *o.compare));
    return {shading_of("--compare", o.compare->substr(0, comma)),
            shading_of("--compare", o.compare->substr(comma + 1))};
}

struct Orbit {
    double azimuth, elevation, distance;
};
Orbit orbit_of(const PreviewCommand& o) {
    const Orbit usual = o.scene.set ? Orbit{0, 10, 10} : Orbit{30, 15, 4};
    if (!o.orbit) return usual;
    const auto n = parse_numbers("--orbit", *o.orbit, {2, 3}, "AZ,EL or AZ,EL,DIST");
    if (!(n[1] >= -90 && n[1] <= 90))
        refuse(fmt::format("--orbit {}: the elevation must be from -90 to 90 degrees", *o.orbit));
    const double distance = n.size() > 2 ? n[2] : usual.distance;
    if (!(distance > 0 && distance <= 1e4))
        refuse(fmt::format("--orbit {}: the distance must be above 0 and at most 10000", *o.orbit));
    return {n[0], n[1], distance};
}

/// The cameras of all frames, one without --turntable.
std::vector<View> views_of(const PreviewCommand& o, const Scene& scene, const Light& light,
                           const Console& console) {
    const auto told = told_size(o);
    constexpr Size kUsual{1280, 720};
    const bool from_map = !light.photo;
    auto seen = from_map ? told_view(o.light.photo, told.value_or(kUsual), console) : std::nullopt;
    if (o.through == "photo" && light.photo) seen = light.photo;
    if (o.through == "photo" && !seen)
        refuse(
            "--through photo: the light is a map; tell the camera with --ellipse, or --ball, "
            "and --focal-px (and --principal, --camera-to-world)");
    if (seen) {
        if (o.turntable > 0) refuse("--turntable goes with --orbit, not with a photo's camera");
        if (told && *told != seen->size)
            refuse(fmt::format("--size {}: the photo's camera makes pictures of {}x{} pixels",
                               *o.size, seen->size.width, seen->size.height));
        return {View::of_ball(seen->size, seen->camera, seen->ball, light.to_world)};
    }
    if (o.scene.scene && !o.orbit && !scene.cameras.empty() && o.turntable == 0) {
        const SceneCamera& camera = scene.cameras.front();
        return {View::at(told.value_or(kUsual), camera.position, camera.to_world,
                         o.fov.value_or(camera.fov_degrees))};
    }
    const Orbit orbit = orbit_of(o);
    const Ball around = o.scene.scene ? bounds_of(scene) : Ball{};
    std::vector<View> views;
    const int count = std::max(1, o.turntable);
    for (int i = 0; i < count; ++i)
        views.push_back(View::orbit(told.value_or(kUsual), orbit.azimuth + 360.0 * i / count,
                                    orbit.elevation, orbit.distance * around.radius,
                                    o.fov.value_or(35), around.center));
    return views;
}

/// Where the frames go; one without --turntable.
std::vector<std::string> paths_of(const PreviewCommand& o) {
    const auto pattern = FramePattern::parse(o.map.output.output);
    if (o.turntable == 0) return {o.map.output.output};
    if (!pattern)
        refuse(
            fmt::format("{}: --turntable writes {} pictures; give their number a place, as in "
                        "turn.####.png",
                        o.map.output.output, o.turntable));
    std::vector<std::string> paths;
    for (int i = 1; i <= o.turntable; ++i) paths.push_back(pattern->path(i));
    return paths;
}

/// The scene itself, as a map baked at a point: what environment mapping reflects.
std::optional<Environment> reflected_light(const PreviewCommand& o, const Scene& scene,
                                           const Environment& environment, const Console& console) {
    if (!o.reflect_from) return std::nullopt;
    const V3d at = point_in(scene, "--reflect-from", *o.reflect_from);
    Scene seen = scene;
    std::erase_if(seen.objects, [](const Object& object) { return reflects(object.material); });
    constexpr int kFace = 512;
    return Environment(
        bake(seen, Tracer(seen), environment, at, {.size = kFace}, console.watch("baking")),
        *find_layout("openexr"));
}

Image rendered(const Scene& scene, const Tracer& tracer, const Environment& environment,
               const View& view, const PreviewOptions& how, const std::string& path,
               const Console& console) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    PreviewStatistics statistics;
    Image picture =
        preview(scene, tracer, environment, view, how, &statistics, console.watch("rendering"));
    const double seconds =
        std::max(1e-6, std::chrono::duration<double>(Clock::now() - start).count());
    const double millions = static_cast<double>(statistics.camera_rays) / 1e6;
    console.say(fmt::format("{}: {:.2f} million camera rays in {:.3f} s, {:.1f} million/s", path,
                            millions, seconds, millions / seconds));
    return picture;
}

/// The page that --html asks for, instead of pictures.
void run_page(const PreviewCommand& o) {
    const Console console(o.common.quiet);
    const UsedThreads threads(o.common);
    if (!o.map.output.output.empty()) refuse("-o and --html: give one, a picture or a page");
    if (o.scene.set || o.scene.scene)
        refuse("--html shows one object: --mesh, not --set or --scene");
    if (!std::has_single_bit(static_cast<unsigned>(o.face)))
        refuse(fmt::format("--face {}: a power of two is wanted", o.face));
    const ColorConfig colors = ColorConfig::load(o.light.color.ocio);
    if (o.light.color.input_space) colors.space(*o.light.color.input_space);
    check_from(o.light.from);
    check_scene_options(o.scene);
    const Orbit orbit = orbit_of(o);
    check_not_input(*o.html, o.light.input);
    check_target(*o.html);
    const Mesh mesh = page_mesh(o.scene, console);
    Light light = read_light(o.light, o.map, colors, console);
    const Environment environment(light.pixels, *light.layout);
    Image faces = page_faces(environment, light.pixels, *light.layout, o.face, light.confidence);
    colors.from_working(faces, "lin_rec709");
    const std::string text =
        page(faces, mesh,
             {.title = std::filesystem::path(o.light.input).filename().string(),
              .face = o.face,
              .azimuth = orbit.azimuth,
              .elevation = orbit.elevation,
              .distance = orbit.distance,
              .fov = o.fov.value_or(35)});
    write_file(*o.html, text);
    console.say(fmt::format("{}: {:.2f} MB; open it in a browser", *o.html,
                            static_cast<double>(text.size()) / 1e6));
}

/// What does not go together with --over.
void check_over(const PreviewCommand& o) {
    if (!o.over) {
        if (o.patch) refuse("--patch paints the ball out of the plate of --over; give that too");
        return;
    }
    if (o.turntable > 0 || o.compare || o.background || o.scene.set || o.scene.scene || o.size)
        refuse(
            "--over puts one object into a plate: --turntable, --compare, --background, --set, "
            "--scene and --size do not go with it");
}

void run_preview(const PreviewCommand& o) {
    const Console console(o.common.quiet);
    const UsedThreads threads(o.common);
    const OutputPlan plan = plan_output(o.map.output);
    const ColorConfig colors = ColorConfig::load(o.light.color.ocio);
    if (o.light.color.input_space) colors.space(*o.light.color.input_space);
    check_map_options(o.map, plan, colors);
    check_from(o.light.from);
    check_scene_options(o.scene);
    orbit_of(o);
    told_size(o);
    const auto paths = paths_of(o);
    for (const std::string& path : paths) {
        check_not_input(path, o.light.input);
        check_target(path);
    }

    const auto shadings = shadings_of(o);
    check_over(o);
    if (o.over)
        for (const std::string& path : paths) check_not_input(path, *o.over);
    Scene scene = scene_of(o.scene, console);
    const Light light = read_light(o.light, o.map, colors, console);
    scale(scene, o.scale);
    std::optional<Plate> plate;
    if (o.over) plate = read_plate(*o.over, o.light, light, o.map, colors, console);
    const auto views = plate ? std::vector{View::of_ball(plate->view.size, plate->view.camera,
                                                         plate->view.ball, plate->to_world)}
                             : views_of(o, scene, light, console);
    const Environment environment(light.pixels, *light.layout);
    if (environment.covered() < 0.9999)
        console.say(
            fmt::format("{}: shows {:.1f} % of the sphere; the rest is filled in from "
                        "around it",
                        o.light.input, 100 * environment.covered()));
    if (std::find(shadings.begin(), shadings.end(), Shading::vertex) != shadings.end())
        scene = with_meshes_only(std::move(scene));
    const Tracer tracer(scene);
    const auto reflected = reflected_light(o, scene, environment, console);
    PreviewOptions how{.samples = o.samples,
                       .filter = filter_of(o.filter),
                       .noise = o.noise,
                       .background = o.background,
                       .reflected = reflected ? &*reflected : nullptr};
    for (std::size_t i = 0; i < views.size(); ++i) {
        std::vector<Image> pictures;
        for (const Shading shading : shadings) {
            how.shading = shading;
            pictures.push_back(
                rendered(scene, tracer, environment, views[i], how, paths[i], console));
        }
        Image picture = std::move(pictures.front());
        if (o.compare) {
            Comparison comparison = compared(picture, pictures.back());
            console.say(fmt::format("{}: {} differ by {:.4f} in the mean of x / (1 + x), {:.1f} dB",
                                    paths[i], *o.compare, comparison.difference, comparison.psnr));
            picture = std::move(comparison.picture);
        }
        Metadata metadata;
        if (plate) {
            if (o.patch)
                paint_out(plate->pixels, plate->view.ball.outline(), plate->view.lens_blur);
            lay_over(plate->pixels, picture);
            picture = std::move(plate->pixels);
            metadata = std::move(plate->metadata);
        }
        write_picture(paths[i], std::move(picture), plan, o.map, o.light.input, colors, console,
                      std::move(metadata));
    }
}

void add_view_options(CLI::App& command, PreviewCommand& o) {
    const std::string group = "View";
    command
        .add_option("--orbit", o.orbit,
                    "Camera: degrees around +Y from +Z towards +X, degrees up, distance in radii "
                    "of the object (default: 30,15,4; of a set 0,10,10)")
        ->type_name("AZ,EL[,DIST]")
        ->group(group);
    command
        .add_option("--fov", o.fov,
                    "... its vertical field of view, degrees (default: 35, or the scene camera's)")
        ->check(finite())
        ->check(CLI::Range(0.01, 179.0))
        ->group(group);
    command
        .add_option("--through", o.through,
                    "orbit: the camera above; photo: the photo's own, the object in its ball's "
                    "place (with a map: as --ellipse, --focal-px, --principal, --camera-to-world "
                    "say)")
        ->check(CLI::IsMember({"orbit", "photo"}))
        ->capture_default_str()
        ->group(group);
    command.add_option("--size", o.size, "Of the picture, pixels (default: 1280,720)")
        ->type_name("W,H")
        ->group(group);
    command
        .add_option("--turntable", o.turntable,
                    "That many frames, once around; -o needs a place for the number: turn.####.png")
        ->check(CLI::Range(1, 100000))
        ->group(group);
    command
        .add_option("--camera-to-world", o.map.camera_to_world,
                    "How the camera of a photo, or of --ellipse, stood: 9 or 16 numbers, row by "
                    "row (default: the photo's worldToCamera)")
        ->type_name("M")
        ->group(group);
    command
        .add_option("--over", o.over,
                    "Put the object into this photo, in its ball's place and through its camera; "
                    "--ball, --focal-px and the like describe it")
        ->type_name("PLATE")
        ->group(group);
    command.add_flag("--patch", o.patch, "... and paint the ball out where the object is not")
        ->group(group);
    add_scale_option(command, o.scale, group);
    command.add_flag("--background", o.background, "Show the map behind the object")->group(group);
}

void add_quality_options(CLI::App& command, PreviewCommand& o) {
    const std::string group = "Quality";
    command
        .add_option("--shading", o.shading,
                    "pixel: the map is looked up at every point, as graphics processors do; "
                    "vertex: at every vertex, colours between them interpolated; raytrace: rays go "
                    "on, so that things see themselves and each other")
        ->type_name("HOW")
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--compare", o.compare,
                    "Two of them side by side, and their difference: pixel,raytrace")
        ->type_name("A,B")
        ->group(group);
    command
        .add_option("--reflect-from", o.reflect_from,
                    "With pixel or vertex: mirrors show the other objects, too, as a map baked at "
                    "this point of the scene")
        ->type_name("X,Y,Z|NAME")
        ->group(group);
    add_samples_option(command, o.samples, group);
    command
        .add_option("--noise", o.noise,
                    "Take as many times --samples, up to 64, as bring the standard error of "
                    "x / (1 + x) below this; 0.002 is hard to see (default: 0, once)")
        ->check(finite())
        ->check(CLI::Range(0.0, 1.0))
        ->group(group);
    command
        .add_option("--pixel-filter", o.filter,
                    "What a pixel is the mean over: box, one pixel; triangle, two; gaussian, "
                    "three (standard deviation 0.5)")
        ->check(CLI::IsMember({"box", "triangle", "gaussian"}))
        ->capture_default_str()
        ->group(group);
}

}  // namespace

void add_preview(CLI::App& app) {
    auto o = std::make_shared<PreviewCommand>();
    auto* command =
        app.add_subcommand("preview", "Show an object in the light of a map, or of a photo's ball");
    command->add_option("input", o->light.input, "Map, folder of faces, or photo of a mirror ball")
        ->required();
    command->add_option("-o,--output", o->map.output.output,
                        "Picture to write (needed, unless --html is given)");
    command
        ->add_option(
            "--html", o->html,
            "Instead, a page to turn the object by hand in a browser: one file, no network")
        ->type_name("FILE.html");
    command->add_option("--face", o->face, "... its map's faces, pixels; a power of two")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    command
        ->add_option("--from", o->light.from,
                     "What the input is: photo, or one of the layouts; auto: by its shape and what "
                     "it says of itself")
        ->capture_default_str();
    add_scene_options(*command, o->scene);
    add_view_options(*command, *o);
    add_quality_options(*command, *o);
    add_encoding_options(*command, o->map);
    add_photo_options(*command, o->light.photo);
    add_color_options(*command, o->light.color);
    add_common_options(*command, o->common);
    command->footer(
        "Examples:\n"
        "  chromeball preview probe.exr --mesh bean -o bean.png\n"
        "  chromeball preview probe.exr --set lookdev --background --display sRGB --view \"ACES "
        "SDR\" -o set.png\n"
        "  chromeball preview plate.exr --through photo --mesh teapot --material chrome -o "
        "teapot.exr\n"
        "  chromeball preview probe.exr --mesh knot --compare pixel,raytrace -o compare.png\n"
        "  chromeball preview plate.exr --over plate.exr --patch --mesh bean -o in_place.exr\n"
        "  chromeball preview probe.exr --mesh bean --html bean.html\n"
        "  chromeball preview probe.exr --mesh model.obj --turntable 48 -o turn.####.png");
    command->callback([o] { o->html ? run_page(*o) : run_preview(*o); });
}

}  // namespace chromeball
