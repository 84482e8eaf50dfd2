#pragma once

#include <optional>
#include <vector>

#include "light/view_cube.h"
#include "map/orientation.h"

namespace chromeball {

/// What one view shows, on a cube that all views share.
struct CubeView {
    Image light;  ///< RGBA, colour multiplied by alpha; exposures matched
    CellValues confidence;
    std::optional<V3d> camera;  ///< from the ball towards the camera, where it is known
    double pixel = 0;           ///< radians across the view's finest pixel
    Rotation to_world;          ///< from its camera's frame, whose photo stands upright
};

/// Who stands before a ball: for each view 0 to 1, 1 where its photographer, tripod or camera is
/// seen (or their shadows, or whoever moved near by).
///
/// They are what two views disagree about near the direction towards one's camera. That camera's
/// view is taken to show its own photographer, unless a third view sides with it. Right at a camera
/// that no other view sees behind but at its rim, as of two from opposite sides, he is guessed by
/// his colours. A little beyond their outlines is taken, too.
std::vector<CellValues> photographers(const ViewCube& cube, const std::vector<CubeView>& views);

/// The same of one view, with no other one to compare with: what has the colours that are seen
/// right at the camera and below it rather than those further around, and hangs together with them.
/// A guess; its margin is wider.
CellValues lone_photographer(const ViewCube& cube, const CubeView& view);

}  // namespace chromeball
