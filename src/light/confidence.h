#pragma once

#include <span>

#include "light/view.h"

namespace chromeball {

/// How far a view's light is to be believed in directions of its camera's frame, 0 to 1: the
/// product of
///
/// * how finely it shows them: the finest angle that a pixel spans (in any view: `finest`, radians)
///   over the coarsest that it spans there, from the mapping's Jacobian, so that light drawn out
///   along the rim counts little;
/// * at a ball's rim, how deep inside: pixels within two of it, or of the lens' blur, mix with what
///   is behind the ball;
/// * what its pixels are trusted (View::trust): clipped, masked;
/// * whether it is shown at all: 0 in the hidden cone and outside the photo.
void confidence(const View& view, double finest, std::span<const V3d> directions,
                std::span<float> out);

/// What to trust of a picture's pixels: 1, or kClipped where a channel has reached `white`. RGB,
/// for a source of its own beside the picture's.
Image trust_of(const Image& pixels, float white);
constexpr float kClipped = 0.1F;
/// Whether that is anywhere below 1.
bool any_doubt(const Image& trust);

}  // namespace chromeball
