#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "color/color.h"
#include "console.h"
#include "map_job.h"
#include "options.h"
#include "shot/cameras.h"
#include "shot/frames.h"
#include "shot/pattern.h"
#include "shot/records.h"
#include "shot/solve.h"
#include "shot_farm.h"
#include "shot_insert.h"
#include "shot_plates.h"

namespace chromeball {

/// What `shot` is told; texts as typed.
struct ShotOptions {
    std::string input;
    std::optional<std::string> frames;
    CommonOptions common;
    PhotoOptions photo;
    ColorOptions color;
    MapOptions map;
    std::optional<std::string> cameras;
    std::optional<std::string> stage;  ///< absent: all
    std::optional<std::string> work;
    std::string missing = "hold";
    bool lock = false;
    std::vector<std::string> keys;
    int smooth_frames = 1;
    std::vector<std::string> reports;
    int jobs = 0;  ///< 0: one a processor
    FarmOptions farm;
    InsertOptions insert;
    bool overwrite = false;
};

/// Warnings that many frames share, told once with the first frame's name and the others' number.
class SharedWarnings {
public:
    /// name: of the frame's file, left out of the text where it begins with it.
    void add(const std::string& name, const std::string& text);
    void tell(const Console& console) const;

private:
    mutable std::mutex lock_;
    std::map<std::string, std::pair<std::string, int>> all_;  ///< text -> first name, count
};

/// A shot as it runs: all that is decided before the first frame.
struct Shot {
    ShotOptions options;
    Console console{false};
    std::unique_ptr<Plates> plates;
    Frames frames;  ///< asked for, whether there or not
    std::optional<FramePattern> output;
    OutputPlan plan;  ///< of the first frame; the others differ by their path
    std::optional<ColorConfig> colors;
    std::map<int, FrameCamera> cameras;
    SolveOptions solving;
    std::string work;  ///< folder of the stages' files
    int jobs = 1;
    // Hashes of what each stage depends on, besides the plates; convert: the map, and what is put
    // into the plate.
    std::string track_settings, solve_settings, map_settings, convert_settings;
    mutable SharedWarnings warnings;

    OutputPlan plan_of(int frame) const;
    /// The options with what --cameras tells of the frame, where no flag does.
    PhotoOptions photo_options(int frame) const;
    /// The name of this run's file of a stage: machines that have other frames have other files.
    std::string stage_file(const std::string& stage) const;
    /// All lines of a stage that may tell of the shot's frames, whoever wrote them.
    std::string stage_text(const std::string& stage) const;
    std::string solve_file() const;
};

/// Decides all that; throws Error for what cannot be.
std::unique_ptr<Shot> plan_shot(const ShotOptions& options);

/// Finds the ball in the frames; skips those whose records are there and still right.
void run_track(const Shot& shot);
/// What the track's records say of frames; a frame without a record is said not to be tracked.
std::vector<TrackRecord> track_records(const Shot& shot);

/// Smooths the path and writes it down.
void run_solve(const Shot& shot);
struct SolvedShot {
    SolveHead head;
    std::map<int, SolvedFrame> frames;
};
/// As written down; throws Error where it is not there or was made with other settings.
SolvedShot solved_shot(const Shot& shot);

/// Writes the maps; skips those that are whole and match. Stops where nothing can be written.
void run_convert(const Shot& shot, const SolvedShot& solved);

/// What the conversion's records say, the last of each frame.
std::map<int, ConvertRecord> convert_records(const Shot& shot);

/// Puts the stages' records together and writes the reports asked for.
ShotReport report_of(const Shot& shot, const SolvedShot& solved, double wall_seconds);
void write_reports(const Shot& shot, ShotReport report);

}  // namespace chromeball
