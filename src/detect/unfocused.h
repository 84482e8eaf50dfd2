#pragma once

#include <vector>

#include "core/watch.h"
#include "detect/detect.h"
#include "detect/draft.h"
#include "detect/wish.h"

namespace chromeball::detecting {

/// Balls out of focus. A picture that shows nothing sharp holds no more than a smaller one that
/// does, and it is sought and fitted as that.
std::vector<Candidate> unfocused_balls(const Picture& picture, const Wish& wish,
                                       const Watch& watch);

}  // namespace chromeball::detecting
