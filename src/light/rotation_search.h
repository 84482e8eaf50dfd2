#pragma once

#include <span>
#include <vector>

#include "core/watch.h"
#include "light/view.h"

namespace chromeball {

/// Rotations that may take the frame of `free` to that of `fixed`, the likeliest first: all of
/// SO(3) is tried in steps of 5 degrees on coarse pictures, and the best ones that lie apart are
/// given.
///
/// No feature points: what two cameras around a ball both see lies near the rim of at least one of
/// them, where a pixel is drawn out many times along one direction and hardly across, so that
/// patches of the same thing do not look alike, and blank walls or a few lamps give none at all.
/// The light itself, averaged over 5 degrees, is the same in both views and enough to tell 150 000
/// rotations apart, in less than a second.
///
/// What only one view shows must not choose among them: each camera sees its own photographer
/// large and dark in its best part, and by correlation a rotation that lays one photographer on
/// the other can beat the right one (3 of 82 random pairs of random places). So far-off values are
/// drawn in for the first choice, and the last is made by likeness(): then 90 such pairs and 60 of
/// photographed places were all found.
/// Views of different places are known by align_views()' agreement.
std::vector<Rotation> likely_rotations(const ViewPyramid& fixed, const ViewPyramid& free, int most,
                                       const Watch& watch = {});

/// The angle of the turn from one to the other, radians; good to 1e-7.
double angle_between(const Rotation& a, const Rotation& b);

/// How alike two views' samples are over what both show, by weight: one less the mean magnitude of
/// their differences over that of the same samples paired at random. 1: they are the same but for a
/// factor a channel (exposure, tint); about 0: they have nothing to do with each other; -1: they
/// share too little to tell. Differences count up to what is usual at random: a photographer whom
/// one of them shows costs his part of the sphere, however dark he is.
double likeness(std::span<const ViewPyramid::Sample> a, std::span<const ViewPyramid::Sample> b);

}  // namespace chromeball
