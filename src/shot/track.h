#pragma once

#include <optional>
#include <string>

#include "core/image.h"
#include "core/outline.h"
#include "core/photo.h"
#include "map/camera.h"

namespace chromeball {

/// A focal length that the shape of an outline tells, with its standard deviation, pixels.
struct FocalHint {
    double focal = 0;
    double deviation = 0;

    bool operator==(const FocalHint&) const = default;
};

/// A ball as seen in one frame.
struct Sighting {
    Outline outline;             ///< upright display-window pixels
    V2d centre_deviation{0, 0};  ///< standard deviations, pixels
    double radius_deviation = 0;
    double confidence = 0;   ///< 0 to 1
    double visible_rim = 0;  ///< 0 to 1
    double lens_blur = 0;    ///< standard deviation, pixels
    /// Whether it counts as found; a weaker one is only held against what the others tell.
    bool sure = false;
    std::optional<FocalHint> focal = std::nullopt;  ///< where nobody tells the lens
    V2d motion{0, 0};  ///< while the shutter was open, pixels; which way round is open

    bool operator==(const Sighting&) const = default;
};

/// The stage `track`, one frame: what its plate shows.
struct TrackRecord {
    int frame = 0;
    std::string settings;  ///< hash of what the search depends on
    std::string plate;     ///< size and date of the file, so that a new one is searched again
    bool there = true;     ///< false: there is no such file
    bool readable = true;
    std::optional<Sighting> ball;
    Size display;  ///< of the plate
    Camera camera;
    std::optional<double> distance;  ///< --distance-radii: the focal length follows
    double seconds = 0;
    std::string message;  ///< why it could not be read, or what the user should know
};

/// Where a ball is between two frames in which it was seen: `part` of the way from one to the
/// other, or beyond if it goes on as it went, up to 3. Nothing where the two are so unlike that a
/// cut lies between them, or where it would vanish.
std::optional<Outline> outline_between(const Outline& before, const Outline& after, double part);

/// Whether two frames some way apart may show the same ball, near where it was and about as large.
bool may_be_same(const Outline& one, const Outline& other);

/// How far a ball moved while the shutter was open, on the way from one such motion to another.
/// Nothing where they are so unlike that what is between cannot be told.
std::optional<V2d> motion_between(const V2d& before, const V2d& after, double part);

/// The part of a picture to look at for a ball that was at an outline some frames ago: `margin`
/// radii further than the rim on all sides, cut to the picture.
Window search_window(const Outline& last, double margin, const Window& picture);

/// Whether an outline lies inside of a window so well that its rim was seen whole; where the
/// window ends with the picture itself the ball may reach beyond.
bool well_inside(const Outline& outline, const Window& window, const Window& picture);

/// What two windows share; of size 0 where they share nothing.
Window shared_window(const Window& one, const Window& other);

/// A photo's description with pixels, still 0, for what its window and another one share.
Photo empty_part(Photo description, const Window& window);

/// Copies the pixels that a photo and a part of the same photo share into the part.
void copy_shared(const Photo& photo, Photo& part);

}  // namespace chromeball
