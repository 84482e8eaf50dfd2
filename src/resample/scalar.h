#pragma once

#include "resample/resample.h"

namespace chromeball::scalar {

/// The reference that defines resample(): double precision, one pixel after the other, with exact
/// Jacobians. The vector kernels differ by their positions' rounding (1e-3 source pixels) and by
/// Jacobians from differences of neighbours.
Image resample(const Source& source, const Layout& layout, int size,
               const ResampleOptions& options = {}, const Watch& watch = {});

/// Into pixels that are 0.
void resample(const Source& source, const Layout& layout, ImageView<float> out,
              const ResampleOptions& options = {}, const Watch& watch = {});

}  // namespace chromeball::scalar
