#pragma once

#include <string>
#include <vector>

#include "light/reflectance.h"
#include "photo_job.h"

namespace chromeball {

/// What became of one photo of `detect`.
struct DetectReport {
    std::string photo;
    bool readable = true;
    bool found = false;
    std::string reason;     ///< why nothing was found, or read
    std::string unwritten;  ///< why its overlay or crop could not be written; empty: they were
    Size size;
    double confidence = 0;
    double visible_rim = 0;
    Outline outline;
    CameraChoice camera;
    V3d center_direction{0, 0, -1};
    std::optional<double> distance;
    double hidden_half_angle_degrees = 0;
    std::vector<std::string> warnings;
    std::optional<OutlineDeviation> deviation;  ///< of the outline, when it was searched for
    V2d motion{0, 0};                           ///< of the ball during the exposure, pixels
    std::vector<Candidate> candidates;          ///< all, best first, when they are wanted (--all)
};

/// The contract's JSON: one object for one photo, an array for several, or an object a line.
std::string to_json(const std::vector<DetectReport>& reports, bool lines);

/// What became of one exposure of `merge`.
struct MergedPhotoReport {
    std::string file;
    double exposure_stops = 0;         ///< brighter than the output's unit
    std::optional<double> told_stops;  ///< the same as its tags or --times have it
    double shift_x = 0, shift_y = 0;   ///< what the result shows at p lies at p + shift in it
    double moved = 0;                  ///< part of the picture in which it does not count
};

struct MergeReport {
    std::vector<MergedPhotoReport> photos;  ///< as given
    std::vector<std::string> left_out;      ///< files that show something else
    std::size_t clipped_everywhere = 0;
    std::size_t black_everywhere = 0;
    std::string response;  ///< "linear", "assumed", "solved"
};

std::string to_json(const MergeReport& report);

/// What `calibrate` found.
struct CalibrateReport {
    Reflectance reflectance;
    std::string material;  ///< whose constants; empty: the same at all angles
    std::string ball, grey;
    double residual = 0;
    std::size_t pixels = 0;
};

/// The file that --reflectance reads again.
std::string to_json(const CalibrateReport& report);
/// Nothing where the text is no such file, or its numbers make no reflectance.
std::optional<Reflectance> reflectance_from_json(const std::string& text);

/// What `info` tells, in its order.
struct InfoReport {
    std::string file;
    Size size;
    int channels = 0;
    std::string type;
    std::string color_space;
    std::string layout;  ///< empty: none that is known
    std::string layout_sureness;
    std::optional<double> range_stops;
    std::array<double, 3> mean_radiance{};
    bool over_sphere = false;  ///< whether the mean is weighted by solid angle
    double maximum = 0;
    std::optional<double> covered_steradians;
    std::size_t bad_pixels = 0;
    std::optional<std::string> provenance;  ///< JSON text
    std::vector<std::string> notes;
};

std::string to_json(const InfoReport& report);

/// What `stitch --json` tells.
struct StitchReport {
    struct View {
        std::string file;
        std::array<double, 9> rotation{};  ///< camera to output, row by row
        double exposure_stops = 0;         ///< what it was brightened by
        double residual_degrees = 0;       ///< how far off the other views it is
    };
    std::vector<View> views;
    double covered = 0;  ///< part of the sphere that some view saw
};

std::string to_json(const StitchReport& report);

}  // namespace chromeball
