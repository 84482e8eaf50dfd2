#pragma once

#include "light/view_cube.h"
#include "map/layouts.h"

namespace chromeball {

/// Smooth values where there are none: a membrane stretched over the gaps from what surrounds them
/// (Laplace's equation), solved coarse to fine.
///
/// picture  of the cube, four channels; the fourth is above 0 where colours are known. Colours are
///          not multiplied by it. Where nothing at all is known the result is 0.
/// Known colours stay as they are; the fourth channel stays.
void fill_gaps(Image& picture);

/// Replaces what a map's channel `confidence` does not believe in at all (less than 0.02 of it,
/// gently) by what lies around, as fill_gaps(); that is then shown, alpha 1.
///
/// map         3 or 4 channels, colour multiplied by alpha
/// confidence  as large; three channels alike
void fill_unbelieved(Image& map, const Image& confidence, const Layout& layout);

}  // namespace chromeball
