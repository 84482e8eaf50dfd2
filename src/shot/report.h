#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/outline.h"

namespace chromeball {

/// What became of one frame of a shot, the worst last.
enum class FrameOutcome {
    found,    ///< the outline was detected in this frame
    filled,   ///< the outline is the solve's: hidden, or detected wrongly, in this frame
    held,     ///< a neighbour's outline on this frame's pixels
    missing,  ///< no outline: nothing was written
    failed,   ///< could not be read or written
};
/// All of them, in that order.
inline constexpr std::array kOutcomes = {FrameOutcome::found, FrameOutcome::filled,
                                         FrameOutcome::held, FrameOutcome::missing,
                                         FrameOutcome::failed};

/// "found", "filled", "held", "missing", "failed".
std::string_view name_of(FrameOutcome outcome);
/// Back from a name; nothing where there is no such outcome.
std::optional<FrameOutcome> outcome_named(std::string_view name);

/// One frame as the reports tell it.
struct FrameReport {
    int frame = 0;
    FrameOutcome outcome = FrameOutcome::missing;
    std::optional<Outline> outline;  ///< in force, solved; upright display-window pixels
    std::optional<Outline> tracked;  ///< as detected in the frame itself
    double confidence = 0;           ///< of the detection, 0 to 1
    double seconds = 0;              ///< spent on the frame, all stages
    std::string message;             ///< why it failed or was overruled; may be empty
    bool flagged = false;            ///< a person should look at it

    /// PNG files as bytes, for the page; empty: none.
    std::string thumbnail;  ///< the plate, small, with its outline drawn
    std::string probe;      ///< the map, small
};

/// A whole shot as the reports tell it.
struct ShotReport {
    std::string title;          ///< the plates' pattern as typed
    std::string settings_json;  ///< an object
    std::vector<FrameReport> frames;
    double wall_seconds = 0;
    int jobs = 1;
};

/// For machines: {"frames": [...], "settings": {...}, "summary": {...}}, frames in order, without
/// pictures.
std::string to_json(const ShotReport& report);

/// For people: one self-contained HTML page (no network): flagged frames first, with thumbnails;
/// the track's curves with the solved ones; a contact strip of the probes; timing.
std::string to_html(const ShotReport& report);

}  // namespace chromeball
