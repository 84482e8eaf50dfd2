#pragma once

#include <CLI/App.hpp>

#include <optional>
#include <string>
#include <vector>

#include "color/color.h"
#include "console.h"
#include "core/photo.h"
#include "light/grey_ball.h"
#include "map_job.h"
#include "photo_job.h"

namespace chromeball {

/// A diffuse ball beside the mirror ball; texts as typed.
struct GreyOptions {
    std::optional<std::string> ball;
    std::string reflectance = "0.18";
    std::optional<double> clip;
};

void add_grey_options(CLI::App& command, GreyOptions& options);

/// What was typed wrong. Throws Error (usage).
void check_grey_options(const GreyOptions& options);

/// A ball in a part of a photo, in the working space.
struct GreyPicture {
    Image pixels;
    BallPicture picture;       ///< of `pixels`; valid while this stays where it is
    std::vector<char> usable;  ///< one a pixel: not clipped
};

/// The grey ball of a photo. `level`: stored number from which on channels are clipped.
void load_grey_ball(const Photo& photo, const Camera& camera, const std::string& circle,
                    const std::string& space, double level, const ColorConfig& colors,
                    GreyPicture& picture);

/// From which stored number on a photo counts as clipped: --clip, else where its numbers pile up.
double clipped_from(const std::shared_ptr<const Photo>& photo, const std::optional<double>& clip);

/// Which pixels of a part of a photo have a clipped channel.
std::vector<char> clipped_pixels(const Photo& photo, const Window& region, double level);

/// For ball_light: finds the light that clipped parts of the mirror ball lack, tells, and adds it.
/// All that is given has to outlive it.
BallStep grey_ball_step(const GreyOptions& options, const PhotoJob& job, const MirrorBall& ball,
                        const ColorConfig& colors, const Console& console);

}  // namespace chromeball
