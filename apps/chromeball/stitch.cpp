#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "color/color.h"
#include "commands.h"
#include "console.h"
#include "core/error.h"
#include "io/facts.h"
#include "light/blend.h"
#include "light/rotation.h"
#include "map_files.h"
#include "map_job.h"
#include "options.h"
#include "photo_job.h"
#include "report.h"
#include "stitch_views.h"

namespace chromeball {
namespace {

struct StitchOptions {
    std::vector<std::string> files;
    ViewOptions views;
    CommonOptions common;
    PhotoOptions photo;
    ColorOptions color;
    MapOptions map;
    std::string fill = "smooth";
    bool confidence = false;
    bool lone_photographer = false;
    bool json = false;
};

constexpr double kDegrees = 180 / std::numbers::pi;

/// Where views belong that are not told; refuses those that fit nowhere.
ViewAlignment aligned(std::vector<ViewInput>& views, const Console& console) {
    std::vector<Unturned> unturned;
    for (const ViewInput& view : views)
        unturned.push_back({ViewPyramid(view.view), view.to_world, view.ball});
    ViewAlignment alignment = align_views(std::move(unturned), console.watch("aligning"));
    for (std::size_t i = 0; i < views.size(); ++i) {
        ViewInput& view = views[i];
        if (!view.to_world && alignment.agreement[i] < kLeastAgreement)
            throw Error(
                Error::Kind::failed,
                fmt::format("{}: does not show the place that the other views show: turned as well "
                            "as can be it differs from them by {:.0f} % of what views differ by "
                            "that are turned at random ({:.0f} % is the most); if it does, give "
                            "--camera-to-world for each view",
                            view.file, 100 * (1 - alignment.agreement[i]),
                            100 * (1 - kLeastAgreement)));
        if (view.ball) {
            const BallChange& change = alignment.change[i];
            view.change(change);
            const Outline& e = *view.provenance.outline;
            console.say(fmt::format(
                "{}: from how the views agree, --ellipse "
                "{:.2f},{:.2f},{:.2f},{:.2f},{:.2f}{}",
                view.file, e.cx, e.cy, e.a, e.b, e.angle,
                change.inverse_distance > 0
                    ? fmt::format(" and --distance-radii {:.2f}", 1 / change.inverse_distance)
                    : ""));
        }
        console.say(fmt::format("{}: off the other views by {:.3f} degrees, agreement {:.2f}",
                                view.file, alignment.residual[i] * kDegrees,
                                alignment.agreement[i]));
    }
    return alignment;
}

/// Photographers vanish where another view sees behind them, and not at its very rim.
void warn_of_sides(const std::vector<PlacedView>& views, const std::vector<std::string>& files,
                   const Console& console) {
    constexpr double kSame = 20 / kDegrees, kOpposite = 160 / kDegrees;
    for (std::size_t i = 0; i < views.size(); ++i)
        for (std::size_t j = i + 1; j < views.size(); ++j) {
            if (!views[i].camera || !views[j].camera) continue;
            const double cosine =
                (views[i].to_world * *views[i].camera).dot(views[j].to_world * *views[j].camera);
            const double apart = std::acos(std::clamp(cosine, -1.0, 1.0));
            if (apart > kOpposite && views.size() == 2)
                console.warn(
                    fmt::format("{} and {} are taken from opposite sides: each shows what is "
                                "behind the other's photographer at its very rim, drawn out to "
                                "a few pixels; one more from the side, or two a quarter turn "
                                "apart, do better",
                                files[i], files[j]));
            if (apart < kSame)
                console.warn(
                    fmt::format("{} and {} are taken from the same side: what is behind "
                                "the photographer there neither shows",
                                files[i], files[j]));
        }
}

/// Those that the views do not tell either.
void warn_of_unknown_lenses(const std::vector<ViewInput>& views, const ViewAlignment& alignment,
                            const Console& console) {
    for (std::size_t i = 0; i < views.size(); ++i) {
        const bool solved = i < alignment.change.size() && alignment.change[i].inverse_distance > 0;
        if (views[i].ball && !views[i].ball->camera_known && !solved)
            console.warn(unknown_lens_warning(views[i].file));
    }
}

void run_stitch(const StitchOptions& o) {
    const Console console(o.common.quiet);
    const UsedThreads threads(o.common);
    const OutputPlan plan = plan_output(o.map.output);
    const ColorConfig colors = ColorConfig::load(o.color.ocio);
    if (o.color.input_space) colors.space(*o.color.input_space);
    check_map_options(o.map, plan, colors);
    check_confidence(o.confidence, plan);
    use_instructions(o.map);
    check_view_options(o.views, o.files);
    for (const std::string& file : o.files) check_output(plan, file);

    std::vector<ViewInput> inputs;
    for (std::size_t i = 0; i < o.files.size(); ++i)
        inputs.push_back(
            read_view(o.files[i], i, o.views, o.photo, o.color, o.map, colors, console));
    if (inputs.size() == 1)
        console.warn(fmt::format(
            "{}: one view does not show what is behind the ball, nor behind "
            "its photographer{}",
            inputs.front().file, o.lone_photographer ? "" : ": see --remove-photographer"));
    ViewAlignment alignment;
    if (inputs.size() > 1) {
        alignment = aligned(inputs, console);
    } else {
        alignment.to_world = {inputs.front().to_world.value_or(Rotation())};
        alignment.residual = {0};
    }
    warn_of_unknown_lenses(inputs, alignment, console);
    std::vector<PlacedView> views;
    for (std::size_t i = 0; i < inputs.size(); ++i)
        views.push_back({std::move(inputs[i].view), alignment.to_world[i], inputs[i].camera});
    warn_of_sides(views, o.files, console);

    const ResampleOptions how = resampling(o.map, plan, Rotation());
    BlendOptions blending;
    blending.filter = how.filter;
    blending.to_output = how.rotation;
    blending.fill = o.fill == "smooth";
    blending.confidence = o.confidence;
    blending.lone_photographer = o.lone_photographer;
    const auto finest =
        std::min_element(views.begin(), views.end(), [](const PlacedView& a, const PlacedView& b) {
            return a.view.source.mean_solid_angle < b.view.source.mean_solid_angle;
        });
    const int size = o.map.size.value_or(natural_size(finest->view.source, *plan.layout));
    Blended blended = blend(views, *plan.layout, size, blending, console.watch("stitching"));
    views.clear();
    console.watch("").check();

    Provenance provenance = std::move(inputs.front().provenance);
    provenance.source = o.files.front();
    const WrittenMap written = write_finished(
        std::move(blended.map), plan, o.map, how.rotation * alignment.to_world.front(),
        std::move(provenance), std::move(inputs.front().metadata), colors,
        {std::move(blended.confidence), blending.fill});
    tell(written, plan, o.map, console,
         fmt::format(", {:.2f} % of the sphere seen", 100 * blended.covered));
    if (!o.json) return;
    StitchReport report;
    report.covered = blended.covered;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const auto& gain = blended.gains[i];
        report.views.push_back({inputs[i].file, (how.rotation * alignment.to_world[i]).rows(),
                                std::log2((gain[0] + gain[1] + gain[2]) / 3),
                                alignment.residual[i] * kDegrees});
    }
    print_result(to_json(report));
}

/// In place of an option for one photo, the same once a view.
CLI::Option* once_a_view(CLI::App& command, const std::string& name,
                         std::vector<std::string>& values, const std::string& help) {
    std::string group = "Views";
    if (CLI::Option* one = command.get_option_no_throw(name)) {
        group = one->get_group();
        command.remove_option(one);
    }
    return command.add_option(name, values, help)
        ->type_size(1)
        ->allow_extra_args(false)
        ->group(group);
}

}  // namespace

void add_stitch(CLI::App& app) {
    auto o = std::make_shared<StitchOptions>();
    auto* command = app.add_subcommand(
        "stitch",
        "Turn several views of a mirror ball into one full sphere, without photographers");
    command->add_option("views", o->files, "Photos of the ball from several sides, or maps")
        ->required();
    command->add_option("-o,--output", o->map.output.output, "File, or folder for faces")
        ->required();
    add_map_options(*command, o->map);
    add_photo_options(*command, o->photo);
    once_a_view(
        *command, "--from", o->views.from,
        "What a view is: photo, or one of the layouts; once, or once a view (default: a map "
        "if chromeball wrote it as one, else a photo)")
        ->type_name("SHAPE");
    once_a_view(*command, "--ball", o->views.balls, "Its outline, a circle; once a view")
        ->type_name("CX,CY,R");
    once_a_view(*command, "--ellipse", o->views.ellipses,
                "Its outline, an ellipse: semi-axes and the long one's angle from +x towards +y "
                "(down); once a view")
        ->type_name("CX,CY,A,B,DEG");
    once_a_view(
        *command, "--camera-to-world", o->views.cameras_to_world,
        "Rotation, row by row: 9 or 16 numbers; once a view, in their order, - for one to be "
        "found (default: the file's worldToCamera, else found from what the views show; then "
        "the first view's frame is the world)")
        ->type_name("M");
    once_a_view(*command, "--mask", o->views.masks,
                "Picture as large as the view, bright where it must not be used; once a view, in "
                "their order, - for none")
        ->type_name("FILE");
    command
        ->add_option("--fill", o->fill,
                     "What no view saw: smooth: the colours around it, alpha 0; none: left empty")
        ->check(CLI::IsMember({"smooth", "none"}))
        ->capture_default_str()
        ->group("Output");
    add_confidence_flag(*command, o->confidence);
    command
        ->add_flag(
            "--remove-photographer", o->lone_photographer,
            "Of one view alone: guess the photographer's outline and fill it (with more views "
            "that is done without asking)")
        ->group("Output");
    command->add_flag("--json", o->json, "Rotations and exposures on stdout")->group("Output");
    add_color_options(*command, o->color);
    add_common_options(*command, o->common);
    command->footer(
        "Examples:\n"
        "  chromeball stitch front.jpg side.jpg -o probe.exr\n"
        "  chromeball stitch a.exr b.exr c.exr --focal-mm 85 --sensor-mm 36 --layout faces -o "
        "probe\n"
        "  chromeball stitch a.exr b.exr --mask - --mask b-mask.png --confidence -o probe.exr");
    command->callback([o] { run_stitch(*o); });
}

}  // namespace chromeball
