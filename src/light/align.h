#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/watch.h"
#include "light/response.h"

namespace chromeball {

/// How a photo lies on the reference: what the reference shows at p lies at p + shift.
struct Alignment {
    V2d shift{0, 0};
    double deviation = 0;   ///< standard deviation, pixels
    bool measured = false;  ///< false: the photos share too little; shift is the hint's, or 0
    /// They share much, and nowhere is it alike: it cannot be laid on the others, and shows
    /// something else. Not measured then.
    bool unlike = false;
};

struct AlignOptions {
    /// Where in the reference to look, the ball; absent: everywhere.
    std::optional<Window> region = std::nullopt;
    /// Photos that do not show the region well, such as where no ball was found: the whole picture
    /// lays them on their neighbours. No entries: none.
    std::vector<bool> whole = {};
    /// For each photo a shift known beforehand to a few pixels, from the ball's outlines; an
    /// empty one where there is none. Or no entries at all.
    std::vector<std::optional<V2d>> hints = {};
};

/// Sub-pixel shifts of photos of one size that were exposed differently, by how their light's
/// logarithm fits where both show it: each photo is laid on its neighbour in the order given, the
/// shifts are added up.
///
/// Lucas and Kanade: An Iterative Image Registration Technique, 1981, over a pyramid; here of the
/// logarithm less its local mean, which neither exposure nor a curve that is a little wrong
/// changes, with weights by its noise, and little weight for what moved.
///
/// Where a photo does not show in the region what its neighbour does, since somebody walks through
/// or since the hint is another ball's, the whole picture lays it on the neighbour.
///
/// order       the photos' numbers from dark to bright
/// reference   the number of the photo that stays
std::vector<Alignment> align(std::span<const ExposedPhoto> photos, std::span<const int> order,
                             int reference, const Response& response,
                             const AlignOptions& options = {}, const Watch& watch = {});

}  // namespace chromeball
