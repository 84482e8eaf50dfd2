#pragma once

#include <CLI/App.hpp>

#include <optional>
#include <string>
#include <vector>

#include "shot/frames.h"

namespace chromeball {

/// How a shot is given to a farm.
struct FarmOptions {
    std::string farm = "none";  ///< "none": the shot is done here
    int chunk = 96;
    std::vector<std::string> options;
    bool dry_run = false;

    bool wanted() const { return farm != "none"; }
};

void add_farm_options(CLI::App& command, FarmOptions& options);

/// Submits the stages of a shot as jobs, or prints the script that would (--farm-dry-run); nothing
/// is done here. A task gets the words that this program was started with, with its own --stage,
/// --frames and --farm none: so shot is not to call this where --farm is "none".
///
/// frames   of the whole shot, as asked for or as found on disk
/// work     the folder of the stages' values; logs go to its folder `farm`
/// jobs     what --jobs said, if it did
void submit_to_farm(const FarmOptions& options, const Frames& frames, const std::string& work,
                    std::optional<int> jobs, bool quiet);

/// `--status DIR`: tells what is done and ends the program, whatever else is typed or missing.
void add_status_option(CLI::App& command);

}  // namespace chromeball
