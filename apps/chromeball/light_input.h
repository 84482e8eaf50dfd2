#pragma once

#include <optional>
#include <string>

#include "color/color.h"
#include "console.h"
#include "core/image.h"
#include "core/photo.h"
#include "map/camera.h"
#include "map/layouts.h"
#include "map/mirror_ball.h"
#include "map_job.h"
#include "options.h"

namespace chromeball {

/// What tells where light comes from: a map, or a photo of a ball.
struct LightOptions {
    std::string input;
    std::string from = "auto";
    PhotoOptions photo;
    ColorOptions color;
};

/// The camera of a photo and the ball it sees.
struct PhotoView {
    Size size;  ///< of the photo
    Camera camera;
    MirrorBall ball;
    double lens_blur = 0;  ///< of the ball's rim, see lens_blur()
};

/// An environment map in the working space, in the world's axes.
struct Light {
    Image pixels;
    Image confidence;  ///< as large, three channels alike; empty where the map has none
    const Layout* layout = nullptr;
    std::string space;  ///< the file's
    /// Of a photo: how it saw the ball, and how its camera stood.
    std::optional<PhotoView> photo;
    Rotation to_world;
};

/// --from for maps and photos alike; throws Error (usage) for what is neither.
void check_from(const std::string& from);

/// Reads a map (of the shape told, or that it has by itself) or turns a photo of a ball into one.
/// map: --camera-to-world, for photos. Says what it decides. Throws Error.
Light read_light(const LightOptions& options, const MapOptions& map, const ColorConfig& colors,
                 const Console& console);

/// What a photo's ball shows as a lat-long in the world's axes, as fine as pictures of things in
/// its light can tell.
Image light_map(const BallLight& light, const Rotation& to_world, const Watch& watch);

/// The ball that the options tell of a picture of that size; nothing where they tell none. Throws
/// Error.
std::optional<PhotoView> told_view(const PhotoOptions& options, Size size, const Console& console);

}  // namespace chromeball
