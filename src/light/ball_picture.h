#pragma once

#include <cmath>

#include "core/image.h"
#include "map/affine.h"
#include "map/mirror_ball.h"

namespace chromeball {

/// A ball's picture: pixels in the working space (3 or 4 channels) and where the ball lies in them.
struct BallPicture {
    const Image* pixels = nullptr;
    MirrorBall ball;   ///< of a grey ball: its outline and camera; what it would mirror
    Affine to_pixels;  ///< from the positions that `ball` knows to those in `pixels`
};

/// What a pixel shows of a ball.
struct ShownByBall {
    V3d view;       ///< from the camera
    V3d normal;     ///< of the ball there
    V3d direction;  ///< that is mirrored there
    double steradians = 0;
};

/// Calls f(x, y, shown) for the pixels that show the ball, row by row.
template <class F>
void for_ball(const BallPicture& picture, F f) {
    const Affine back = picture.to_pixels.inverse();
    const double area = std::abs(back.determinant());
    for (int y = 0; y < picture.pixels->height(); ++y)
        for (int x = 0; x < picture.pixels->width(); ++x) {
            const V2d position = back(Vec2<double>(x + 0.5, y + 0.5));
            const auto d = picture.ball.to_direction(position);
            if (!d) continue;
            const V3d direction = V3d(*d).normalized(), view = picture.ball.ray(position);
            // direction = view - 2 (view.n) n
            const ShownByBall shown{view, (direction - view).normalized(), direction,
                                    picture.ball.solid_angle(position) * area};
            if (std::isfinite(shown.steradians)) f(x, y, shown);
        }
}

}  // namespace chromeball
