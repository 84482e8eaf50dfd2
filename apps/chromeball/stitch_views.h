#pragma once

#include <optional>
#include <string>
#include <vector>

#include "color/color.h"
#include "console.h"
#include "light/view.h"
#include "map_job.h"
#include "options.h"

namespace chromeball {

/// What is told of each view: the first of a list belongs to the first view, and so on; "-" and
/// what is missing say nothing of it.
struct ViewOptions {
    std::vector<std::string> from;  ///< one: of all views
    std::vector<std::string> balls;
    std::vector<std::string> ellipses;
    std::vector<std::string> cameras_to_world;
    std::vector<std::string> masks;  ///< files
};

/// How far a photo's pixels are to be trusted where some are not: clipped ones of an integer photo,
/// and those that are bright in `mask`, a picture as large as the photo. Throws Error.
std::optional<Source> trust_source(const PhotoJob& job, const BallLight& light,
                                   const MirrorBall& ball, double lens_blur,
                                   const std::optional<std::string>& mask = {});

/// One view as read.
struct ViewInput {
    std::string file;
    View view;
    std::optional<Rotation> to_world;  ///< where it is told
    std::optional<V3d> camera;         ///< from the ball towards the camera, view's frame
    std::optional<BallModel> ball;     ///< whose outline or camera is not known for sure
    Provenance provenance;
    Metadata metadata;

    /// Takes the ball as changed. For views with a ball.
    void change(const BallChange& change);

private:
    friend ViewInput read_view(const std::string&, std::size_t, const ViewOptions&,
                               const PhotoOptions&, const ColorOptions&, const MapOptions&,
                               const ColorConfig&, const Console&);
    Image pixels_;
    Affine to_pixels_;
    double blur_ = 0;
    Image trust_;
};

/// What was typed wrong, before anything is read. Throws Error (usage).
void check_view_options(const ViewOptions& options, const std::vector<std::string>& files);

/// Reads view number `index`: finds its ball, or takes it as the map that it is. Of a lens that is
/// not known it does not warn: several views tell it. Throws Error.
ViewInput read_view(const std::string& file, std::size_t index, const ViewOptions& options,
                    const PhotoOptions& photo, const ColorOptions& color, const MapOptions& map,
                    const ColorConfig& colors, const Console& console);

}  // namespace chromeball
