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

/// The focal length of a shot whose lens nobody tells, from the shapes of its outlines: a mean of
/// the frames', weighed by their deviations and robust against wrong ones. Its deviation takes
/// neighbours for one sighting, since they share their errors. Nothing where a camera is known, or
/// fewer than a fifth of the outlines tell anything.
std::optional<FocalHint> focal_of_shot(const std::vector<TrackRecord>& records);

/// The ball's path over a shot: smooth in time, without what was seen wrongly, with gaps filled.
///
/// What is smoothed is the cone, not the ellipse. With a focal length it has three numbers (where
/// its axis meets the picture and its half-angle as pixels at the axis), of which the ellipse
/// follows; without one, the same of the ellipse, whose shape is smoothed strongly. Measurements
/// count by their own deviations, which are scaled by what the data say; a Student-t weight
/// overrules those that do not fit, whatever their confidence. Cuts and jumps end a piece of the
/// path, across which nothing is smoothed. The path goes through keys, bent around them within 8
/// frames, and is as stiff as without them; a circle by hand tells place and size, an ellipse the
/// shape too.
///
/// records: one for each frame, ascending; the result has as many. Deterministic.
std::vector<SolvedFrame> solve(const std::vector<TrackRecord>& records,
                               const SolveOptions& options);

}  // namespace chromeball
