#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "color/color.h"
#include "commands.h"
#include "console.h"
#include "core/parallel.h"
#include "io/facts.h"
#include "io/read.h"
#include "io/threads.h"
#include "io/write.h"
#include "map_files.h"
#include "map_input.h"
#include "numbers.h"
#include "options.h"
#include "photo_job.h"
#include "resample/resample.h"
#include "resample/residual.h"
#include "version.h"

namespace chromeball {
namespace {

struct ConvertOptions {
    std::string input;
    std::string from = "photo";
    CommonOptions common;
    PhotoOptions photo;
    ColorOptions color;
    OutputOptions output;
    std::optional<std::string> output_space;
    std::optional<std::string> display;
    std::optional<std::string> view;
    std::optional<int> size;
    std::string filter = "adaptive";
    std::optional<std::string> camera_to_world;
    double yaw = 0, pitch = 0, roll = 0;
    std::optional<std::string> reflectance;
    bool verify = false;
    std::optional<std::string> verify_image;
};

/// The photo's ball as it is, to hold the map against.
struct Evidence {
    Image pixels;
    Window region;  ///< of the photo, that `pixels` shows
    MirrorBall ball;
};

/// What is turned into the output, and what is told about it.
struct Input {
    Source source;
    Rotation to_world;
    Provenance provenance;
    Metadata metadata;
    std::optional<Evidence> evidence;  ///< with --verify
};

void undo_reflectance(Image& pixels, const std::string& text) {
    auto r = parse_numbers("--reflectance", text, {1, 3}, "R or R,G,B, each above 0 and at most 1");
    if (r.size() == 1) r = {r[0], r[0], r[0]};
    for (const double part : r)
        if (!(part > 0 && part <= 1))
            throw Error(
                Error::Kind::usage,
                fmt::format("--reflectance {}: a mirror gives back a part above 0 and at most 1",
                            text));
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x)
            for (std::size_t c = 0; c < 3; ++c) pixels.pixel(x, y)[c] /= static_cast<float>(r[c]);
}

void warn_bad_pixels(const Console& console, const std::string& name, std::size_t count) {
    if (count > 0)
        console.warn(
            fmt::format("{}: {} pixels are NaN or infinite; they are left out", name, count));
}

/// --camera-to-world as a rotation; the identity where it is not given.
Rotation told_rotation(const ConvertOptions& o) {
    if (!o.camera_to_world) return {};
    const auto numbers = parse_numbers("--camera-to-world", *o.camera_to_world, {9, 16},
                                       "9 or 16 numbers, row by row");
    const auto rotation = Rotation::nearest(numbers);
    if (!rotation)
        throw Error(Error::Kind::usage,
                    fmt::format("--camera-to-world {}: this is no rotation (columns must be "
                                "perpendicular, of length 1, right-handed, to 1e-3); a scale or a "
                                "mirror must be taken out first",
                                *o.camera_to_world));
    return *rotation;
}

Rotation world_rotation(const ConvertOptions& o, const Photo* photo, const Console& console) {
    if (o.camera_to_world) return told_rotation(o);
    if (!photo || !photo->metadata.find("worldToCamera")) return {};
    const auto rotation = rotation_from_metadata(*photo, o.photo.camera_axes);
    if (!rotation) {
        console.warn(fmt::format(
            "{}: its worldToCamera is no rotation and is not used; give --camera-to-world",
            photo->name));
        return {};
    }
    console.say(fmt::format("{}: turned into the world by the file's worldToCamera", photo->name));
    return *rotation;
}

Input photo_input(const ConvertOptions& o, const ColorConfig& colors, const Console& console) {
    PhotoJob job = open_photo(o.input, o.photo, console.watch("searching"));
    if (!job.ball.found) throw no_ball(job, o.photo.threshold);
    const MirrorBall ball = projection_of(job);
    for (const std::string& warning : job.warnings) console.warn(warning);
    console.say(description(job, ball));

    std::string tag_warning;
    const std::string space = colors.input_space(job.photo, o.color.input_space, &tag_warning);
    if (!tag_warning.empty()) console.warn(tag_warning);
    console.say(fmt::format("{}: {}x{} pixels, colour space {}", o.input, job.photo.display.width,
                            job.photo.display.height, space));

    // Of a crop everything is needed, and its outline is that of the whole photo.
    const bool cropped = o.photo.cropped;
    const Window region =
        cropped ? job.photo.window : needed_window(ball.outline(), job.photo.window);
    std::size_t bad = 0;
    Image pixels = colors.to_working(job.photo, space, region, &bad);
    warn_bad_pixels(console, o.input, bad);
    job.photo.pixels = std::vector<std::byte>();  // the rest of the work is on the ball
    if (o.reflectance) undo_reflectance(pixels, *o.reflectance);

    Affine to_pixels = job.ball.to_pixels;
    to_pixels.x0 -= region.x;
    to_pixels.y0 -= region.y;
    Input input;
    input.source = ball_source(pixels, ball, to_pixels,
                               job.ball.candidate ? lens_blur(*job.ball.candidate) : 0);
    input.to_world = world_rotation(o, &job.photo, console);
    input.provenance.outline = ball.outline();
    input.provenance.camera = job.camera.camera;
    input.metadata = pass_through(job.photo.metadata);
    if (o.verify) input.evidence = Evidence{std::move(pixels), region, ball};
    return input;
}

/// Paints the ball again from the map and tells how far it is from the photo.
void verify(const ConvertOptions& o, const Evidence& evidence, const Image& map,
            const Layout& layout, const Rotation& rotation, const Console& console) {
    const Image painted = render_ball(map_source(map, layout), evidence.ball, evidence.region,
                                      rotation, console.watch("verifying"));
    const Residual residual = residual_of(evidence.pixels, painted);
    print_message(
        fmt::format("{}: painted again from the map the ball is off by {:.3f} stops in the median, "
                    "{:.3f} stops at 95 % of its {} pixels\n",
                    o.input, residual.median_stops, residual.p95_stops, residual.pixels));
    if (!o.verify_image) return;
    WriteOptions write;
    write.format =
        *format_from_extension(std::filesystem::path(*o.verify_image).extension().string());
    write.bits = 8;
    write_image(*o.verify_image, residual.picture.view(), write);
}

Input map_input(const ConvertOptions& o, const ColorConfig& colors, const Console& console) {
    const Layout* layout = find_layout(o.from);
    MapInput map = read_map(o.input, *layout, o.photo.max_pixels, colors, o.color.input_space);
    for (const std::string& warning : map.warnings) console.warn(warning);
    console.say(fmt::format("{}: {} of {}x{} pixels, colour space {}", o.input, layout->name,
                            map.pixels.width(), map.pixels.height(), map.space));
    warn_bad_pixels(console, o.input, map.bad_pixels);
    Input input;
    input.source = map_source(map.pixels, *layout);
    input.to_world = world_rotation(o, nullptr, console);
    input.metadata = std::move(map.metadata);
    return input;
}

/// From the working space into the file's, or onto a display.
std::string encode(Image& map, const ConvertOptions& o, const OutputPlan& plan,
                   const ColorConfig& colors) {
    if (o.display || o.view) {
        const std::string display = o.display.value_or(colors.displays().front());
        const std::string view = o.view.value_or(colors.views(display).front());
        colors.to_display(map, display, view);
        return fmt::format("{}, {}", display, view);
    }
    const std::string space = colors.output_space(o.output_space, plan.scene_linear);
    colors.from_working(map, space);
    return space;
}

void check_display(const ConvertOptions& o, const OutputPlan& plan, const ColorConfig& colors) {
    if (o.output_space) colors.space(*o.output_space);
    if (!o.display && !o.view) return;
    if (o.output_space)
        throw Error(Error::Kind::usage,
                    "--output-space and --display or --view contradict each other; give one");
    if (plan.scene_linear)
        throw Error(
            Error::Kind::usage,
            fmt::format(
                "{}: --display and --view make pictures to look at; write a .png, .jpg or .tif",
                plan.path));
    Image probe({1, 1}, 3);
    const std::string display = o.display.value_or(colors.displays().front());
    const auto views = colors.views(display);
    colors.to_display(probe, display, o.view.value_or(views.empty() ? "" : views.front()));
}

/// What was typed wrong about the input, before it is read.
void check_input(const ConvertOptions& o) {
    told_rotation(o);
    if (o.verify_image) {
        if (!format_from_extension(std::filesystem::path(*o.verify_image).extension().string()))
            throw Error(Error::Kind::usage,
                        fmt::format("--verify-image {}: name a .png, .jpg, .tif or .exr file",
                                    *o.verify_image));
        check_target(*o.verify_image);
        check_not_input(*o.verify_image, o.input);
    }
    if (o.verify && (o.from != "photo" || o.photo.cropped))
        throw Error(Error::Kind::usage,
                    "--verify holds the map against the whole photo of a ball; it does not go with "
                    "--from or --cropped");
    if (o.from == "photo") return;
    if (!find_layout(o.from)) throw Error(Error::Kind::usage, unknown_shape(o.from));
    if (o.photo.ball || o.photo.ellipse || o.photo.cropped)
        throw Error(Error::Kind::usage,
                    fmt::format("--from {} is a map, but --ball, --ellipse and --cropped tell of a "
                                "photo of a ball; leave one of them out",
                                o.from));
}

EnvmapKind envmap_kind(const Layout& layout, bool turned_away) {
    // The attribute says that +Z is in the middle; a preset with other axes must not claim it.
    if (turned_away) return EnvmapKind::none;
    if (layout.name == "latlong") return EnvmapKind::latlong;
    return layout.name == "openexr" ? EnvmapKind::cube : EnvmapKind::none;
}

void report_write(const Console& console, const OutputPlan& plan, const WriteReport& report,
                  bool displayed) {
    // A display ends at white; that a picture for it does too is no news.
    if (report.clamped > 0 && !displayed)
        console.warn(fmt::format(
            "{}: {} values above what the format holds were clamped{}", plan.path, report.clamped,
            plan.format == FileFormat::exr ? " to 65504; --float keeps them" : ""));
    if (report.repaired > 0)
        console.warn(fmt::format("{}: {} values were NaN or infinite and were replaced", plan.path,
                                 report.repaired));
}

void run_convert(const ConvertOptions& o) {
    const Console console(o.common.quiet);
    const ThreadLimit limit(o.common.threads);
    set_coding_threads(o.common.threads);
    const OutputPlan plan = plan_output(o.output);
    const ColorConfig colors = ColorConfig::load(o.color.ocio);
    if (o.color.input_space) colors.space(*o.color.input_space);
    check_display(o, plan, colors);
    check_input(o);
    check_output(plan, o.input);
    if (o.reflectance) {
        Image nothing({1, 1}, 3);
        undo_reflectance(nothing, *o.reflectance);
    }

    Input input =
        o.from == "photo" ? photo_input(o, colors, console) : map_input(o, colors, console);

    ResampleOptions how;
    how.filter = o.filter == "fast" ? Filter::fast : Filter::adaptive;
    const Rotation axes = plan.preset ? plan.preset->axes : Rotation();
    const Rotation to_output = Rotation::yaw_pitch_roll(o.yaw, o.pitch, o.roll) * input.to_world;
    how.rotation = axes * to_output;
    const int size = o.size.value_or(natural_size(input.source, *plan.layout));
    Image map = resample(input.source, *plan.layout, size, how, console.watch("converting"));
    if (input.evidence) verify(o, *input.evidence, map, *plan.layout, how.rotation, console);
    input.source = {};
    input.evidence.reset();
    const std::string space = encode(map, o, plan, colors);

    WriteOptions write;
    write.format = plan.format;
    write.full_float = o.output.full_float;
    write.bits = o.output.bits.value_or(16);
    write.envmap = envmap_kind(*plan.layout, !axes.is_identity());
    if (!o.display && !o.view) write.color = colors.tag(space);
    input.provenance.version = kVersion;
    input.provenance.source = o.input;
    input.provenance.layout = plan.preset && !axes.is_identity()
                                  ? fmt::format("{} for {}", plan.layout->name, plan.preset->name)
                                  : std::string(plan.layout->name);
    input.provenance.rotation = how.rotation.rows();
    write.metadata = std::move(input.metadata);
    write.metadata.set(to_attribute(input.provenance));
    console.watch("").check();
    WriteReport report;
    const auto files = write_map(plan, map, write, report);
    report_write(console, plan, report, o.display || o.view);
    console.say(fmt::format("{}: {} --size {} ({}x{} pixels), colour space {}", plan.path,
                            plan.layout->name, size, map.width(), map.height(), space));
}

}  // namespace

void add_convert(CLI::App& app) {
    auto o = std::make_shared<ConvertOptions>();
    auto* command = app.add_subcommand(
        "convert", "Turn a photo of a mirror ball, or an environment map, into an environment map");
    command->add_option("input", o->input, "Photo, map, or folder of faces")->required();
    command->add_option("-o,--output", o->output.output, "File, or folder for faces")->required();
    command->add_option("--from", o->from, "What the input is: photo, or one of the layouts")
        ->capture_default_str();
    const std::string out = "Output";
    command
        ->add_option("--layout", o->output.layout,
                     "Shape: " + comma_list(layout_names()) + " (default: latlong)")
        ->type_name("NAME")
        ->group(out);
    command
        ->add_option("--for", o->output.preset,
                     "Program that reads it: " + comma_list(preset_names()) +
                         "; sets layout, names, axes and file type")
        ->type_name("PRESET")
        ->group(out);
    command
        ->add_option("--size", o->size,
                     "Width of a face, height of a lat-long, side of a ball, pixels (default: the "
                     "power of two from 64 to "
                     "4096 nearest to the source's resolution)")
        ->check(CLI::Range(1, 32768))
        ->group(out);
    command
        ->add_option("--format", o->output.format,
                     "exr, hdr, tif, png or jpg, for folders (default: exr)")
        ->type_name("FORMAT")
        ->group(out);
    command
        ->add_flag("--float", o->output.full_float,
                   "32-bit EXR or TIFF, scene-linear (default: half EXR)")
        ->group(out);
    command->add_option("--bits", o->output.bits, "Of PNG and TIFF (default: 16)")
        ->check(CLI::IsMember({8, 16}))
        ->group(out);
    command
        ->add_option("--filter", o->filter,
                     "adaptive: as many taps as needed; fast: one bilinear tap")
        ->check(CLI::IsMember({"adaptive", "fast"}))
        ->capture_default_str()
        ->group(out);
    command
        ->add_option("--output-space", o->output_space,
                     "Colour space (default: scene_linear for EXR, HDR and float TIFF; "
                     "srgb_texture for pictures)")
        ->type_name("SPACE")
        ->group("Colour");
    command->add_option("--display", o->display, "Write a picture for this display")
        ->type_name("NAME")
        ->group("Colour");
    command->add_option("--view", o->view, "... through this view, such as \"ACES SDR\"")
        ->type_name("NAME")
        ->group("Colour");
    const std::string check = "Check";
    command
        ->add_flag(
            "--verify", o->verify,
            "Paint the ball again from the map and tell how far it is from the photo, in stops")
        ->group(check);
    command
        ->add_option(
            "--verify-image", o->verify_image,
            "... and write where: red where the painted ball is brighter, blue where it is "
            "darker; a wrong outline or camera shows as rings")
        ->type_name("FILE.png")
        ->group(check);
    command
        ->add_option("--reflectance", o->reflectance,
                     "What the mirror gives back, 0 to 1; divided out")
        ->type_name("R|R,G,B")
        ->group("Colour");
    const std::string axes =
        "Orientation (default: the camera's frame, +Z towards the camera, +Y up)";
    command
        ->add_option("--camera-to-world", o->camera_to_world,
                     "Rotation, row by row: 9 or 16 numbers (default: the file's worldToCamera)")
        ->type_name("M")
        ->group(axes);
    command
        ->add_option(
            "--yaw", o->yaw,
            "Then turned about +Y, degrees; 180 puts what the camera looks at into the middle")
        ->check(finite())
        ->capture_default_str()
        ->group(axes);
    command->add_option("--pitch", o->pitch, "... about +X, degrees")
        ->check(finite())
        ->capture_default_str()
        ->group(axes);
    command->add_option("--roll", o->roll, "... about +Z, degrees")
        ->check(finite())
        ->capture_default_str()
        ->group(axes);
    add_photo_options(*command, o->photo);
    add_color_options(*command, o->color);
    add_common_options(*command, o->common);
    command->footer(
        "Examples:\n"
        "  chromeball convert plate.jpg -o probe.exr\n"
        "  chromeball convert plate.exr --focal-mm 50 --sensor-mm 36 --layout faces -o probe\n"
        "  chromeball convert plate.jpg --ball 812,540.5,202 --for blender --size 1024 -o "
        "probe.exr\n"
        "  chromeball convert probe.exr --from latlong --layout cross-h -o cross.exr");
    command->callback([o] {
        o->verify = o->verify || o->verify_image;
        run_convert(*o);
    });
}

}  // namespace chromeball
