#pragma once

#include <vector>

#include "core/watch.h"
#include "detect/detect.h"
#include "detect/draft.h"
#include "detect/wish.h"

namespace chromeball::detecting {

constexpr double kFound = 0.5;  ///< confidence from which on nothing else needs to be sought

void sort_by_confidence(std::vector<Candidate>& balls);

/// The finest fits of drafts, those that moved have them already, and how sure they are; best
/// first, in pixels of the picture.
std::vector<Candidate> finished(std::vector<Draft> drafts, const Picture& picture, const Wish& wish,
                                const Watch& watch);

}  // namespace chromeball::detecting
