#include "shot_farm.h"

#include <fmt/format.h>
#include <CLI/Validators.hpp>

#include <filesystem>

#include "console.h"
#include "core/error.h"
#include "run_program.h"
#include "shot/farm.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> farm_names() {
    std::vector<std::string> names{"none"};
    for (const FarmKind& kind : farm_kinds()) names.emplace_back(kind.name);
    return names;
}

void make_folder(const std::string& path) {
    std::error_code failed;
    fs::create_directories(path, failed);
    if (failed)
        throw Error(
            Error::Kind::failed,
            fmt::format("{}: the folder cannot be made ({}); choose another one with --work", path,
                        failed.message()));
}

}  // namespace

void add_farm_options(CLI::App& command, FarmOptions& options) {
    command
        .add_option("--farm", options.farm,
                    "Submit the stages as jobs of a farm instead of doing them here: slurm")
        ->check(CLI::IsMember(farm_names()))
        ->capture_default_str();
    command
        .add_option("--chunk", options.chunk,
                    "Frames a task of the farm, about: blocks of 16 frame numbers stay together")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command
        .add_option(
            "--farm-option", options.options,
            "A further word for the farm's program, e.g. --farm-option=--partition=gpu; may "
            "be repeated")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->allow_extra_args(false);
    command.add_flag("--farm-dry-run", options.dry_run,
                     "Print a script that would submit the jobs, and submit nothing");
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
