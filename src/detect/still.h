#pragma once

#include <vector>

#include "core/watch.h"
#include "detect/draft.h"
#include "detect/wish.h"

namespace chromeball::detecting {

/// What a search found.
struct Found {
    std::vector<Draft> drafts;  ///< best first, one a ball, but for the finest fits
    std::vector<Draft> rough;   ///< places with something round, less sure
};

/// The balls of a picture that stood still. Progress is told up to 0.9.
Found still_balls(const Picture& picture, const Wish& wish, const Watch& watch);

}  // namespace chromeball::detecting
