#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "color/color.h"
#include "commands.h"
#include "console.h"
#include "grey_job.h"
#include "io/facts.h"
#include "io/read.h"
#include "io/write.h"
#include "light/blend.h"
#include "map_files.h"
#include "map_input.h"
#include "map_job.h"
#include "options.h"
#include "photo_job.h"
#include "resample/resample.h"
#include "resample/residual.h"
#include "stitch_views.h"

namespace chromeball {
namespace {

struct ConvertOptions {
    std::string input;
    std::string from = "photo";
    CommonOptions common;
    PhotoOptions photo;
    ColorOptions color;
    MapOptions map;
    GreyOptions grey;
    bool verify = false;
    std::optional<std::string> verify_image;
    bool confidence = false;
    bool remove_photographer = false;

    bool looks_closer() const { return confidence || remove_photographer; }
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
    std::optional<Source> trust;       ///< with --confidence or --remove-photographer; see View
    std::optional<Source> confidence;  ///< of a map that has the channel, three times
    std::optional<V3d> camera;         ///< of a ball: from it towards the camera
    Rotation to_world;
    Provenance provenance;
    Metadata metadata;
    std::optional<Evidence> evidence;  ///< with --verify
};

Input photo_input(const ConvertOptions& o, const ColorConfig& colors, const Console& console) {
    PhotoJob job =
        open_photo(o.input, o.photo, console.watch("searching"), !o.verify && !o.looks_closer());
    const MirrorBall ball = seen_ball(job, o.photo.threshold, console);

    // Of a crop everything is needed, and its outline is that of the whole photo.
    BallLight light = ball_light(job, ball, lens_blur(job), o.photo.cropped, o.color, o.map, colors,
                                 o.verify, grey_ball_step(o.grey, job, ball, colors, console));
    tell(light, job.photo, console);
    Input input;
    if (o.looks_closer()) input.trust = trust_source(job, light, ball, lens_blur(job));
    input.camera = -ball.axis();
    input.source = std::move(light.source);
    input.to_world = photo_rotation(o.map, job.photo, o.photo.camera_axes, console);
    input.provenance.outline = ball.outline();
    input.provenance.camera = job.camera.camera;
    input.metadata = pass_through(job.photo.metadata);
    if (o.verify) input.evidence = Evidence{std::move(light.pixels), light.region, ball};
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
    tell(map, o.input, *layout, console);
    Input input;
    input.source = map_source(map.pixels, *layout);
    if (!map.confidence.empty()) input.confidence = map_source(map.confidence, *layout);
    input.to_world = told_rotation(o.map).value_or(Rotation());
    input.metadata = std::move(map.metadata);
    return input;
}

/// The map, and what it has besides its colours.
struct Converted {
    Image map;
    MapExtras extras;
};
Converted converted(const ConvertOptions& o, Input& input, const OutputPlan& plan, int size,
                    const ResampleOptions& how, const Console& console) {
    Converted result;
    const Layout& layout = *plan.layout;
    const Watch watch = console.watch("converting");
    // What a map is to be believed goes with it wherever its new file can hold that.
    const bool carried = input.confidence && (o.confidence || plan.format == FileFormat::exr);
    if (!o.looks_closer() || carried) {
        result.map = resample(input.source, layout, size, how, watch);
        if (carried)
            result.extras.confidence =
                confidence_of(*input.confidence, result.map, layout, how, watch);
        return result;
    }
    PlacedView view{{std::move(input.source), std::move(input.trust)}, how.rotation, input.camera};
    if (o.remove_photographer) {
        BlendOptions blending;
        blending.filter = how.filter;
        blending.confidence = o.confidence;
        blending.lone_photographer = true;
        Blended blended = blend({std::move(view)}, layout, size, blending, watch);
        console.say(fmt::format("{}: {:.2f} % of the sphere is filled", o.input,
                                100 * (1 - blended.covered)));
        result.map = std::move(blended.map);
        result.extras = {std::move(blended.confidence), true};
        return result;
    }
    result.map = resample(view.view.source, layout, size, how, watch);
    result.extras.confidence = confidence_of(view, result.map, layout, {}, watch);
    return result;
}

/// What was typed wrong about the input, before it is read.
void check_input(const ConvertOptions& o) {
    check_grey_options(o.grey);
    if (o.grey.ball && (o.from != "photo" || o.photo.cropped))
        throw Error(Error::Kind::usage,
                    "--grey-ball is a place in the whole photo; it does not go with --from or "
                    "--cropped");
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
    if (o.remove_photographer && o.from != "photo")
        throw Error(Error::Kind::usage,
                    "--remove-photographer looks for who stands before the ball of a photo; it "
                    "does not go with --from");
    if (o.map.reflectance && o.from != "photo")
        throw Error(Error::Kind::usage,
                    "--reflectance is that of the ball in a photo; it does not go with --from");
    if (o.from == "photo") return;
    if (!find_layout(o.from)) throw Error(Error::Kind::usage, unknown_shape(o.from));
    if (o.photo.ball || o.photo.ellipse || o.photo.cropped)
        throw Error(Error::Kind::usage,
                    fmt::format("--from {} is a map, but --ball, --ellipse and --cropped tell of a "
                                "photo of a ball; leave one of them out",
                                o.from));
}

void run_convert(const ConvertOptions& o) {
    const Console console(o.common.quiet);
    const UsedThreads threads(o.common);
    const OutputPlan plan = plan_output(o.map.output);
    const ColorConfig colors = ColorConfig::load(o.color.ocio);
    if (o.color.input_space) colors.space(*o.color.input_space);
    check_map_options(o.map, plan, colors);
    use_instructions(o.map);
    check_confidence(o.confidence, plan);
    check_input(o);
    check_output(plan, o.input);
    Input input =
        o.from == "photo" ? photo_input(o, colors, console) : map_input(o, colors, console);

    const ResampleOptions how = resampling(o.map, plan, input.to_world);
    const int size = o.map.size.value_or(natural_size(input.source, *plan.layout));
    auto [map, extras] = converted(o, input, plan, size, how, console);
    if (input.evidence) verify(o, *input.evidence, map, *plan.layout, how.rotation, console);
    input.source = {};
    input.trust.reset();
    input.confidence.reset();
    input.evidence.reset();
    console.watch("").check();
    input.provenance.source = o.input;
    const WrittenMap written =
        write_finished(std::move(map), plan, o.map, how.rotation, std::move(input.provenance),
                       std::move(input.metadata), colors, extras);
    tell(written, plan, o.map, console);
}

}  // namespace

void add_convert(CLI::App& app) {
    auto o = std::make_shared<ConvertOptions>();
    auto* command = app.add_subcommand(
        "convert", "Turn a photo of a mirror ball, or an environment map, into an environment map");
    command->add_option("input", o->input, "Photo, map, or folder of faces")->required();
    command->add_option("-o,--output", o->map.output.output, "File, or folder for faces")
        ->required();
    command->add_option("--from", o->from, "What the input is: photo, or one of the layouts")
        ->capture_default_str();
    add_map_options(*command, o->map);
    add_confidence_flag(*command, o->confidence);
    command
        ->add_flag("--remove-photographer", o->remove_photographer,
                   "Guess the outline of who stands before the ball, and fill it and what the ball "
                   "hides from around; alpha is 0 there. With more photos stitch does better")
        ->group("Output");
    add_grey_options(*command, o->grey);
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
        o->photo.all_rows = o->grey.ball.has_value();
        run_convert(*o);
    });
}

}  // namespace chromeball
