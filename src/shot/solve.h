#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shot/report.h"
#include "shot/track.h"

namespace chromeball {

/// What becomes of a frame that reads whole but shows no ball.
enum class MissingFrames {
    hold,         ///< it gets the outline of the nearest frame that has one
    skip,         ///< nothing is written
    interpolate,  ///< it gets what the smoothed path says, beyond the path's ends as with hold
};

struct SolveOptions {
    MissingFrames missing = MissingFrames::hold;
    /// The outlines are told, not measured: they are taken as they are.
    bool told = false;
    bool lock = false;  ///< the ball stands still in the picture: one outline for all frames
    std::map<int, Outline> keys = {};  ///< corrections by hand, by frame; circles are enough
};

/// The stage `solve`, one frame: where its ball is taken to be.
struct SolvedFrame {
    int frame = 0;
    FrameOutcome outcome = FrameOutcome::missing;
    std::optional<Outline> outline;
    int piece = -1;         ///< of the path, between jumps; -1: on none
    double lens_blur = 0;   ///< standard deviation, pixels; the same throughout a piece of the path
    double confidence = 0;  ///< of the detection
    std::optional<Outline> tracked;
    bool flagged = false;  ///< a person should look at it
    std::string message;
};

/// The ball's path over a shot: smooth in time, without what was seen wrongly, with gaps filled.
///
/// What is smoothed is the cone, not the ellipse. With a focal length it has three numbers (where
/// its axis meets the picture and its half-angle as pixels at the axis), of which the ellipse
/// follows; without one, the same of the ellipse, whose shape is smoothed strongly. Measurements
/// count by their own deviations, which are scaled by what the data say; a Student-t weight
/// overrules those that do not fit, whatever their confidence. Cuts and jumps end a piece of the
/// path, across which nothing is smoothed. Keys win over what was detected.
///
/// records: one for each frame, ascending; the result has as many. Deterministic.
std::vector<SolvedFrame> solve(const std::vector<TrackRecord>& records,
                               const SolveOptions& options);

}  // namespace chromeball
