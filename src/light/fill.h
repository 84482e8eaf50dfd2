#pragma once

#include "light/view_cube.h"

namespace chromeball {

/// Smooth values where there are none: a membrane stretched over the gaps from what surrounds them
/// (Laplace's equation), solved coarse to fine.
///
/// picture  of the cube, four channels; the fourth is above 0 where colours are known. Colours are
///          not multiplied by it. Where nothing at all is known the result is 0.
/// Known colours stay as they are; the fourth channel stays.
void fill_gaps(Image& picture);

}  // namespace chromeball
