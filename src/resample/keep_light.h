#pragma once

#include "resample/plan.h"

namespace chromeball {

/// Makes a map that was drawn by a plan hold the light of its source's spots exactly: what the
/// filter draws of each one (see Spot) is made weaker or stronger, per channel, so that its
/// integral over the sphere is the spot's. It stays where the filter has put it, no brighter than
/// its own pixels, and alpha what it is. Where nothing outshines the rest, nothing is done.
///
/// Shares of the light just above and below the limit are treated differently: the filter's error
/// of a single pixel, 0.1 to 0.2 of it, of a 4096th of all light.
void keep_light(const Source& source, const Layout& layout, const Plan& plan, ImageView<float> out,
                const Rotation& rotation, const Watch& watch);

}  // namespace chromeball
