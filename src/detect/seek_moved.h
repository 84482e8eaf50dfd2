#pragma once

#include "detect/draft.h"

namespace chromeball::detecting {

/// Balls that moved during the exposure, near the most promising drafts: those that show the world,
/// and streaks. The rim of such a ball is weak, so `rough` drafts count that were passed over.
std::vector<Draft> seek_moved(const std::vector<Draft>& rough, const Picture& picture);

/// A ball that is known to have moved, from where it must be and from closely around: where several
/// starts end says how sure that is.
std::vector<Draft> follow_moved(const Outline& start, const V2d& motion, const Picture& picture);

}  // namespace chromeball::detecting
