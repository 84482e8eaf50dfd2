#include "shot_farm.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>

#include "console.h"
#include "core/error.h"
#include "io/lines.h"
#include "io/write.h"
#include "run_program.h"
#include "shot/farm.h"
#include "shot/stage_files.h"
#include "shot/status.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> farm_names() {
    std::vector<std::string> names{"none"};
    for (const FarmKind& kind : farm_kinds()) names.emplace_back(kind.name);
    return names;
}

void tell_status(const std::string& work) {
    ShotStatus status;
    bool begun = fs::is_directory(fs::path(work) / "farm");
    for (const char* stage : {"track", "", "convert"})
        for (const std::string& file : stage_files((fs::path(work) / stage).string())) {
            status.add(read_text(file));
            begun = true;
        }
    if (!begun)
        throw Error(Error::Kind::failed,
                    fmt::format("{}: no files of a shot's stages; --status wants their folder, "
                                ".chromeball/NAME beside the output, or what --work said",
                                work));
    print_result(status.text());
}

}  // namespace

void add_farm_options(CLI::App& command, FarmOptions& options) {
    const std::string group = "Farm";
    command
        .add_option("--farm", options.farm,
                    "Submit the stages as jobs of a farm instead of doing them here: slurm")
        ->check(CLI::IsMember(farm_names()))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--chunk", options.chunk,
                    "Frames a task of the farm, about: blocks of 16 frame numbers stay together")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str()
        ->group(group);
    command
        .add_option(
            "--farm-option", options.options,
            "A further word for the farm's program, e.g. --farm-option=--partition=gpu; may "
            "be repeated")
        ->type_name("WORD")
        ->allow_extra_args(false)
        ->group(group);
    command
        .add_flag("--farm-dry-run", options.dry_run,
                  "Print a script that would submit the jobs, and submit nothing")
        ->group(group);
}

void add_status_option(CLI::App& command) {
    command
        .add_option_function<std::string>(
            "--status",
            [](const std::string& work) {
                tell_status(work);
                throw CLI::RuntimeError(0);
            },
            "Only tell what is done, from the folder of the stages' files")
        ->type_name("DIR")
        ->group("Running")
        ->trigger_on_parse();
}

void submit_to_farm(const FarmOptions& options, const Frames& frames, const std::string& work,
                    std::optional<int> jobs, bool quiet) {
    const FarmKind& kind = farm_kind(options.farm);
    FarmShot shot;
    shot.program = program_path();
    shot.words = typed_words();
    shot.frames = frames;
    shot.chunk = options.chunk;
    shot.folder = fs::current_path().string();
    shot.logs = (fs::absolute(work) / "farm").lexically_normal().string();
    shot.jobs = jobs;
    shot.options = options.options;
    const std::vector<FarmJob> all = farm_jobs(kind, shot);
    if (options.dry_run) {
        print_result(dry_run(kind, shot, all));
        return;
    }
    make_folder(shot.logs);
    const std::vector<std::string> numbers = submit(kind, shot, all, run_program);
    std::string told;
    for (std::size_t i = 0; i < all.size(); ++i) {
        told += fmt::format("{} {}", all[i].name, numbers[i]);
        if (all[i].tasks > 0) told += fmt::format(" ({} tasks)", all[i].tasks);
        told += '\n';
    }
    print_result(told);
    if (!quiet)
        print_message(
            fmt::format("{} frames given to {}; \"chromeball shot --status {}\" tells what "
                        "is done, logs are in {}\n",
                        frames.size(), kind.name, work, shot.logs));
}

}  // namespace chromeball
