#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shot/frames.h"

// A shot on a farm: the stages as jobs that wait for each other,
//
//     track (an array of chunks) -> solve (once) -> convert (an array of chunks) -> report (once)
//
// Every task is the program itself with `--stage` and `--frames`, so that a farm does what one
// machine does, and submitting again continues what was interrupted.

namespace chromeball {

/// How a farm's submitting program is talked to. It reads a job's script from standard input and
/// prints the job's number. The words' "{}" stands for what the row says.
struct FarmKind {
    std::string_view name;
    std::vector<std::string_view> submit;  ///< program and the words that every job gets
    std::string_view cancel;               ///< program that ends jobs by their numbers
    std::string_view job_name;             ///< {}: the job's name
    std::string_view folder;               ///< {}: where it runs
    std::string_view log;                  ///< {}: file; of a job without tasks
    std::string_view array_log;            ///< {}: file; of a job with tasks
    std::string_view array;                ///< {}: the last task's index, the first is 0
    std::string_view processors;           ///< {}: number a task
    std::string_view after_any;        ///< {}: numbers of jobs that must have ended, well or not
    std::string_view after_success;    ///< {}: the same, that must have ended well
    std::string_view between_numbers;  ///< what separates those
    std::string_view index_variable;   ///< holds a task's index where it runs
    std::string_view processors_variable;  ///< holds its number of processors, or is not set
    int most_tasks;                        ///< of one array, as farms come configured
    /// A folder's name as a part of {} in the logs' words; nothing where that cannot be said.
    std::optional<std::string> (*log_folder)(std::string_view);
};

/// Every farm there is. Add yours here.
const std::vector<FarmKind>& farm_kinds();
/// Throws Error (usage) that names the ones there are.
const FarmKind& farm_kind(std::string_view name);

/// What is to be run.
struct FarmShot {
    std::string program;               ///< absolute path, on every machine
    std::vector<std::string> words;    ///< as typed behind the program, of farming and frames too
    Frames frames;                     ///< of the shot, all
    int chunk = 96;                    ///< frames a task, about
    std::string folder;                ///< where the words hold: absolute
    std::string logs;                  ///< folder for what tasks say: absolute
    std::optional<int> jobs;           ///< processors a task; without: what `options` ask for
    std::vector<std::string> options;  ///< further words for the farm's program
};

/// Frames in chunks of about `most`, in order, such that no block of 16 frame numbers that begins
/// at a multiple of 16 is parted: a block's frames start from one key frame, which two tasks would
/// otherwise both search. A chunk holds one block at least, and more than `most` frames only then.
std::vector<Frames> chunks_of(const Frames& frames, int most);

/// One word for sh, whatever its bytes: in single quotes unless it needs none.
std::string quoted_for_shell(std::string_view word);

/// The words without those options: each with the number of values (0 or 1) that stand behind it,
/// where they are not joined to it by "=". Behind "--" nothing is an option.
std::vector<std::string> words_without(
    const std::vector<std::string>& words,
    const std::vector<std::pair<std::string_view, int>>& options);

/// One submission.
struct FarmJob {
    std::string name;       ///< "track", "solve", "convert", "report"; arrays in parts: "track.2"
    std::string script;     ///< for sh, whole: needs no other file
    std::size_t tasks = 0;  ///< of its array; 0: no array
    std::vector<std::size_t> after;  ///< jobs it waits for, by their place in the list
    /// Whether these must have ended well. Only convert insists (on the solve): failed frames, and
    /// killed tasks, keep nobody else from being done.
    bool only_after_success = false;
};

/// The jobs of a shot in the order of their submission.
std::vector<FarmJob> farm_jobs(const FarmKind& kind, const FarmShot& shot);

/// A script for sh that would submit the jobs: what --farm-dry-run prints.
std::string dry_run(const FarmKind& kind, const FarmShot& shot, const std::vector<FarmJob>& jobs);

/// What became of a program.
struct ProgramOutcome {
    int status = -1;
    std::string out;
    std::string err;
};
/// Runs a program found on the path, without a shell, with a text as its standard input.
using RunProgram =
    std::function<ProgramOutcome(const std::vector<std::string>& words, const std::string& input)>;

/// Submits the jobs; gives their numbers. Throws Error when the farm's program cannot be run or
/// refuses, telling which jobs are submitted already.
std::vector<std::string> submit(const FarmKind& kind, const FarmShot& shot,
                                const std::vector<FarmJob>& jobs, const RunProgram& run);

}  // namespace chromeball
