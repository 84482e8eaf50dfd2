#include "shot.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>

#include "commands.h"
#include "core/error.h"
#include "core/parallel.h"

namespace chromeball {
namespace {

constexpr const char* kStages[] = {"track", "solve", "convert", "report"};

/// One line on what became of the frames, and the exit status that says it.
int tell_summary(const Shot& shot, const ShotReport& report) {
    const auto count = [&](FrameOutcome outcome) {
        return std::count_if(report.frames.begin(), report.frames.end(),
                             [&](const FrameReport& f) { return f.outcome == outcome; });
    };
    const auto missing = count(FrameOutcome::missing), failed = count(FrameOutcome::failed);
    const auto lost = missing + failed, all = std::ssize(report.frames);
    shot.console.say(
        fmt::format("{}: {} frames: {} found, {} filled, {} held, {} missing, {} failed; {:.1f} s",
                    report.title, all, count(FrameOutcome::found), count(FrameOutcome::filled),
                    count(FrameOutcome::held), missing, failed, report.wall_seconds));
    if (lost == 0) return 0;
    const auto first =
        std::find_if(report.frames.begin(), report.frames.end(), [](const FrameReport& f) {
            return f.outcome == FrameOutcome::missing || f.outcome == FrameOutcome::failed;
        });
    Frames frames;
    for (const FrameReport& f : report.frames)
        if (f.outcome == FrameOutcome::missing || f.outcome == FrameOutcome::failed)
            frames.push_back(f.frame);
    print_message(fmt::format("error: {} of {} frames were not written: {}; the first: {}\n", lost,
                              all, text_of(frames), first->message));
    if (lost < all) return static_cast<int>(Error::Kind::partial);
    const bool unseen =
        failed == 0 && std::any_of(report.frames.begin(), report.frames.end(),
                                   [&](const FrameReport& f) { return shot.plates->has(f.frame); });
    return static_cast<int>(unseen ? Error::Kind::no_ball : Error::Kind::failed);
}

void submit_shot(const Shot& shot) {
    const ShotOptions& o = shot.options;
    if (o.stage)
        throw Error(Error::Kind::usage,
                    "--farm: submits all stages as jobs, --stage runs one here; drop one of them");
    const auto jobs = o.jobs > 0 ? std::optional(o.jobs) : std::nullopt;
    submit_to_farm(o.farm, shot.frames, shot.work, jobs, o.common.quiet);
}

void run_shot(const ShotOptions& o) {
    const auto start = std::chrono::steady_clock::now();
    // Frames are what runs side by side; within one a single thread works, unless told otherwise.
    const ThreadLimit limit(std::max(1, o.common.threads));
    use_instructions(o.map);
    const std::unique_ptr<Shot> shot = plan_shot(o);
    if (o.farm.wanted()) {
        submit_shot(*shot);
        return;
    }
    const auto runs = [&](const char* stage) { return !o.stage || *o.stage == stage; };
    if (runs("track")) run_track(*shot);
    if (runs("solve")) run_solve(*shot);
    if (runs("convert")) run_convert(*shot, solved_shot(*shot));
    shot->warnings.tell(shot->console);
    if (!runs("convert") && !runs("report")) return;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    const ShotReport report = report_of(*shot, solved_shot(*shot), wall.count());
    const int status = tell_summary(*shot, report);
    if (runs("report")) write_reports(*shot, report);
    if (status != 0) throw CLI::RuntimeError(status);
}

/// An odd number of frames, so that they lie evenly around one.
CLI::Validator odd() {
    return {[](std::string& text) {
                int value = 0;
                if (CLI::detail::lexical_cast(text, value) && value % 2 == 0)
                    return fmt::format("{} is even; an odd number lies evenly around a frame",
                                       value);
                return std::string();
            },
            "", "odd"};
}

void add_stage_options(CLI::App& command, ShotOptions& o) {
    const std::string path = "Path of the ball";
    command
        .add_option("--missing", o.missing,
                    "Frames that read whole but show no ball: hold the nearest outline, skip them, "
                    "or interpolate")
        ->check(CLI::IsMember({"hold", "skip", "interpolate"}))
        ->capture_default_str()
        ->group(path);
    command.add_flag("--lock", o.lock, "The ball stands still in the picture: one outline for all")
        ->group(path);
    command
        .add_option("--key", o.keys,
                    "Correction by hand: the outline in a frame; may be given more than once")
        ->type_name("FRAME:CX,CY,R")
        ->allow_extra_args(false)
        ->group(path);
    command
        .add_option("--smooth-frames", o.smooth_frames,
                    "Make each map the mean of those of so many frames around it; odd")
        ->check(CLI::Range(1, 999))
        ->check(odd())
        ->capture_default_str()
        ->group(path);
    const std::string running = "Running";
    command
        .add_option("--jobs", o.jobs,
                    "Frames worked on side by side; 0: one a processor. Memory grows with it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str()
        ->group(running);
    command
        .add_option("--stage", o.stage,
                    "Only this stage: track (any machine, any frames), solve (once, all frames), "
                    "convert (any machine, any frames), report (default: all four)")
        ->check(CLI::IsMember({kStages[0], kStages[1], kStages[2], kStages[3]}))
        ->group(running);
    command
        .add_option("--work", o.work,
                    "Folder of the stages' files (default: .chromeball/NAME beside the output)")
        ->type_name("DIR")
        ->group(running);
    auto* overwrite = command.add_flag("--overwrite", o.overwrite,
                                       "Do everything again, also what is there and still right");
    overwrite->group(running);
    command
        .add_flag_callback(
            "--resume", [] {},
            "Skip what is whole and matches its plates and settings (this is the default)")
        ->excludes(overwrite)
        ->group(running);
    command
        .add_option("--report", o.reports,
                    "What became of each frame: .json for machines, .html to look at; may be given "
                    "more than once")
        ->type_name("FILE")
        ->allow_extra_args(false)
        ->group(running);
}

}  // namespace

void add_shot(CLI::App& app) {
    auto o = std::make_shared<ShotOptions>();
    auto* command = app.add_subcommand(
        "shot", "Turn every frame of a film plate with a mirror ball into an environment map");
    command
        ->add_option("plates", o->input,
                     "Frames, as 'plate.####.exr' (or %04d, $F4, @ in place of ####), or a film "
                     "clip")
        ->required()
        ->type_name("PATTERN");
    command
        ->add_option("--frames", o->frames,
                     "Which: 1001-1100, 1001-1100x2, 1,5,9-12 (default: all on disk)")
        ->type_name("RANGE");
    command
        ->add_option("-o,--output", o->map.output.output,
                     "Files, as 'probe.####.exr', or folders for faces, as 'probe.####'")
        ->required()
        ->type_name("PATTERN");
    command
        ->add_option("--cameras", o->cameras,
                     "A camera a frame: {\"frames\": {\"1001\": {\"camera_to_world\": [9 or 16 "
                     "numbers], \"focal_px\": F, \"principal\": [x, y]}}}")
        ->type_name("FILE.json");
    add_map_options(*command, o->map);
    add_stage_options(*command, *o);
    add_insert_options(*command, o->insert);
    add_farm_options(*command, o->farm);
    add_status_option(*command);
    add_photo_options(*command, o->photo);
    add_color_options(*command, o->color);
    add_common_options(*command, o->common);
    command->footer(
        "Exit status: 0 every frame written, 3 some are missing or failed, 4 no ball in any, 1 "
        "none written, 130 interrupted. The same words again continue a run that was ended.\n"
        "Examples:\n"
        "  chromeball shot 'plates/sh010.####.exr' --frames 1001-1100 -o 'probes/sh010.####.exr' "
        "--size 512\n"
        "  chromeball shot 'plates/sh010.####.exr' -o 'probes/sh010.####' --layout faces --report "
        "sh010.html\n"
        "  chromeball shot 'plates/sh010.####.exr' -o 'probes/sh010.####.exr' --insert "
        "'creature.####.obj' --insert-output 'comp/sh010.####.exr' --patch\n"
        "  chromeball shot clip.mov -o 'probes/clip.####.exr' --hfov 40 --missing interpolate");
    command->callback([o] { run_shot(*o); });
}

}  // namespace chromeball
