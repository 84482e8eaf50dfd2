#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "camera_choice.h"
#include "color/color.h"
#include "console.h"
#include "core/photo.h"
#include "detect/detect.h"
#include "io/read.h"
#include "map/affine.h"
#include "map/mirror_ball.h"
#include "options.h"

namespace chromeball {

/// Where the ball of a photo is, as found or told.
struct FoundBall {
    bool found = false;
    Outline outline;  ///< pixels of the photo that was taken (not of a crop of it)
    std::optional<Candidate> candidate;  ///< when searched: the best one, found or not
    std::vector<Candidate> others;       ///< the others, best first
    Affine to_pixels;                    ///< from those pixels to the photo's display window
    std::string how;                     ///< "found", "--ball", "--ellipse", "--cropped"
    bool circle_given = false;
};

/// A photo read as far as it is needed, its ball and its camera.
struct PhotoJob {
    Photo photo;
    /// How its pixels are read, where that was put off: `photo` has none of them then.
    std::optional<ReadOptions> unread;
    FoundBall ball;
    CameraChoice camera;
    std::vector<std::string> warnings;
};

/// Reads a photo (only the ball's rows when the ball is told) and finds its ball. A ball that is
/// not found is an answer: job.ball.found. Throws Error for bad files and contradicting options.
///
/// put_off     leave the pixels in the file, for ball_light(), when the ball is told
PhotoJob open_photo(const std::string& path, const PhotoOptions& options, const Watch& watch,
                    bool put_off = false);

/// The outline that the numbers of an option's value tell: CX,CY,R or CX,CY,A,B,DEG, as many as one
/// of `counts`; of an ellipse the axes may come in either order. Throws Error (usage), which shows
/// `form`.
Outline parse_outline(std::string_view option, std::string_view value,
                      std::initializer_list<std::size_t> counts, std::string_view form);

/// The one line on a camera that is taken as infinitely far away. more: another way out, as
/// ", --cameras".
std::string unknown_lens_warning(const std::string& name, std::string_view more = "");

/// Of a photo whose data is damaged, but not so that nothing could be decoded.
std::string damage_warning(const Photo& photo);

/// The outline that --ball or --ellipse tells of a photo. Throws Error (usage) where it lies
/// outside.
Outline told_outline(const Photo& photo, const PhotoOptions& options);

/// What a ball is searched with. Throws Error (usage) for options that cannot be understood.
DetectOptions search_options(const PhotoOptions& options, const CameraChoice& camera);

/// The error for a photo whose ball was not found: status 4, with the way out.
Error no_ball(const PhotoJob& job, double threshold);

/// What was drawn to be looked at (an overlay, a contact sheet: 8 bits, 3 channels), 0 to 1.
Image drawn_image(const Photo& picture);

/// How much the lens blurs the rim, pixels, beyond what pixels themselves do.
double lens_blur(const Candidate& candidate);
/// The same of the ball that was found; 0 of one that was told.
double lens_blur(const PhotoJob& job);

/// The ball as a projection of the photo's pixels. Sets the focal length in job.camera when it
/// follows from --distance-radii; adds warnings when the outline and the camera do not fit.
MirrorBall projection_of(PhotoJob& job);

/// One line on the ball and camera, with the words to ask for the same again.
std::string description(const PhotoJob& job, const MirrorBall& ball);

/// projection_of(), told to the user with all warnings. Throws no_ball() where none was found.
MirrorBall seen_ball(PhotoJob& job, double threshold, const Console& console);

}  // namespace chromeball
