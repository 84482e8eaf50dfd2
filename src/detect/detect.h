#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/outline.h"
#include "core/photo.h"
#include "core/watch.h"
#include "map/camera.h"

namespace chromeball {

/// What is known before the search, and how sure a find must be.
struct DetectOptions {
    /// Confidence from which on a candidate counts as found. Of random pictures, many of them made
    /// to be hard, two of three finds are right, and one of twenty without a ball is a find.
    double threshold = 0.4;
    std::optional<Camera> camera;  ///< with a focal length: the rim is fitted as a cone, 3 unknowns
    /// A place inside the ball wanted, upright display-window pixels; balls elsewhere are left out.
    std::optional<V2d> near = std::nullopt;
    /// Least and greatest radius of the ball wanted, pixels; others are left out.
    std::optional<std::array<double, 2>> radius_range = std::nullopt;
    /// The photo is a window around a place where the ball is expected, as a frame before showed
    /// it: the few best candidates are enough, at a third of the time.
    bool expected = false;
    /// Where the ball is but for a sixth of its radius, in display-window pixels, as frames
    /// before and behind showed it: nothing is sought, its rim is followed from there. A quarter of
    /// the time.
    std::optional<Outline> start = std::nullopt;
    /// With `start`: how far it moved while the shutter was open, pixels, as those frames showed
    /// it. Of zero, motion is only sought where nothing that stood still is near; of more, only
    /// the rim of a ball that moved about so is followed, at a fifth of the time.
    std::optional<V2d> motion = std::nullopt;
};

/// Standard deviations of an outline's numbers, of one with the others unknown.
struct OutlineDeviation {
    double cx = 0, cy = 0, a = 0, b = 0;  ///< pixels
    double angle = 0;  ///< degrees; a near circle's angle is as good as unknown: 52 at most
};

/// A focal length with its standard deviation, pixels.
struct FocalEstimate {
    double focal = 0;
    double deviation = 0;
};

/// One ball that may be there.
struct Candidate {
    Outline outline;  ///< upright display-window pixels
    OutlineDeviation deviation = {};
    double confidence = 0;   ///< 0 to 1: probability that it is a mirror ball, outline within 2 %
    double visible_rim = 0;  ///< part of the rim on which an edge was found, 0 to 1
    double rim_blur = 0;     ///< standard deviation of the edge's blur across the rim, pixels
    /// What the outline's shape says of a focal length that options do not tell: off the optical
    /// axis a ball looks the longer, the wider the lens. Takes the principal point as that of
    /// options.camera, else the middle of the display window. Nothing where it is too round to
    /// tell, or longer in a direction that no lens makes it.
    std::optional<FocalEstimate> focal = std::nullopt;
    /// How far the ball moved while the shutter was open, pixels; which way round cannot be told.
    /// Zero where it stood still as far as the rim shows. The outline is that of the middle of the
    /// exposure; blur along the motion comes on top of rim_blur.
    V2d motion = V2d(0);
    std::vector<double> signs = {};  ///< what `confidence` was weighed from, for its calibration
};

/// The mirror balls of a photo, best first, at most eight; empty where nothing round was found at
/// all. Whether the first one counts is for the caller to say: confidence >= options.threshold.
///
/// With options.near or radius_range only balls that hold the place and have such a radius.
/// Works on the photo's pixels as stored (integers) or tone-compressed (floats). Throws Error of
/// kind `interrupted`.
std::vector<Candidate> find_balls(const Photo& photo, const DetectOptions& options = {},
                                  const Watch& watch = {});

/// A picture to look at: the photo in 8-bit sRGB RGB with the outlines drawn on it, the best one
/// thick, with its centre, and confidence as text. Size of the photo's window.
Photo overlay(const Photo& photo, const std::vector<Candidate>& candidates, double threshold);

}  // namespace chromeball
