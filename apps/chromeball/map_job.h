#pragma once

#include <CLI/App.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "color/color.h"
#include "console.h"
#include "io/facts.h"
#include "map/orientation.h"
#include "map_files.h"
#include "options.h"
#include "photo_job.h"
#include "resample/resample.h"

namespace chromeball {

/// Which map is made and how it is written; texts as typed.
struct MapOptions {
    OutputOptions output;
    std::optional<std::string> output_space;
    std::optional<std::string> display;
    std::optional<std::string> view;
    std::optional<int> size;
    std::string filter = "adaptive";
    std::optional<std::string> simd;  ///< instructions of the resampler; none: the best there are
    std::optional<std::string> camera_to_world;
    double yaw = 0, pitch = 0, roll = 0;
    std::optional<std::string> reflectance;
};

void add_map_options(CLI::App& command, MapOptions& options);
/// Those of them that every picture of light has, map or not: --float, --bits, colours.
void add_encoding_options(CLI::App& command, MapOptions& options);
/// --confidence, for check_confidence().
void add_confidence_flag(CLI::App& command, bool& wanted);

/// What was typed wrong, before anything is read. Throws Error (usage).
void check_map_options(const MapOptions& options, const OutputPlan& plan,
                       const ColorConfig& colors);

/// --simd, for the whole process. Throws Error (usage) for instructions that this processor lacks.
void use_instructions(const MapOptions& options);

/// --camera-to-world; nothing where it is not given. Throws Error (usage) where it is no rotation.
std::optional<Rotation> told_rotation(const MapOptions& options);
/// From a photo's camera to the world: what is told, else what the file says, else unturned.
Rotation photo_rotation(const MapOptions& options, const Photo& photo,
                        const std::string& camera_axes, const Console& console);

/// The ball of a photo as light in the working space.
struct BallLight {
    Source source;
    Image pixels;      ///< the part of the photo that was taken, if that is to be kept
    Window region;     ///< where that lies
    Affine to_pixels;  ///< from the ball's positions to those of `pixels`
    std::string space;
    std::vector<std::string> warnings;
};
/// Something done to the ball's pixels before they become a source.
using BallStep = std::function<void(BallLight& light)>;
/// lens_blur: standard deviation, pixels. Of a crop (`whole`) all is taken. Pixels that are still
/// in the file are read now; with a step they must have been.
BallLight ball_light(const PhotoJob& job, const MirrorBall& ball, double lens_blur, bool whole,
                     const ColorOptions& color, const MapOptions& options,
                     const ColorConfig& colors, bool keep_pixels = false,
                     const BallStep& step = nullptr);
/// What was taken for which light, and all that is not as it should be.
void tell(const BallLight& light, const Photo& photo, const Console& console);

/// How the map is resampled: rotation into the output's frame, filter.
ResampleOptions resampling(const MapOptions& options, const OutputPlan& plan,
                           const Rotation& to_world);

/// A picture's first three channels: colour transforms take a fourth one for alpha.
Image colors_of(const Image& picture);
/// Channels put together: a picture's, then the fourth one of another, then confidence.
Image joined(const Image& picture, const Image* fourth, const Image* confidence);

/// From the working space into the file's, or onto a display; its name, or the display's and
/// view's.
std::string encode(Image& image, const MapOptions& options, const OutputPlan& plan,
                   const ColorConfig& colors);

/// How a picture is written whose colours encode() has brought into `space`.
WriteOptions write_options(const MapOptions& options, const OutputPlan& plan,
                           const std::string& space, const ColorConfig& colors);

/// A map that was written.
struct WrittenMap {
    std::string space;  ///< or display and view
    int size = 0;       ///< as --size counts
    WriteReport report;
};
/// What a map may have besides its colours.
struct MapExtras {
    Image confidence;     ///< one channel, as large as the map; empty: none
    bool filled = false;  ///< colours are whole where alpha is 0
};
/// Throws Error (usage) where a confidence channel is wanted of a format without one.
void check_confidence(bool wanted, const OutputPlan& plan);

/// Encodes a map of the working space as planned and writes it. The origin's version, layout and
/// rotation are filled in here.
WrittenMap write_finished(Image map, const OutputPlan& plan, const MapOptions& options,
                          const Rotation& rotation, Provenance origin, Metadata metadata,
                          const ColorConfig& colors, const MapExtras& extras = {});

/// What writing changed, as warnings.
std::vector<std::string> warnings_of(const WrittenMap& written, const OutputPlan& plan,
                                     const MapOptions& options);
/// What was written, after those warnings. more: of the map, after its size.
void tell(const WrittenMap& written, const OutputPlan& plan, const MapOptions& options,
          const Console& console, const std::string& more = {});
/// Of values that a format cut off.
std::string clamp_warning(const std::string& path, std::size_t values, FileFormat format);
/// Of pixels that hold no number; empty where there are none.
std::string bad_pixel_warning(const std::string& name, std::size_t count);

}  // namespace chromeball
