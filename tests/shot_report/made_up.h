#pragma once

#include <string>

#include "shot/report.h"

namespace chromeball::test {

/// A shot that never was: a ball that drifts and breathes from frame 1001 on, detected with some
/// noise; one hidden for a while, some frames held, one without a ball, one unreadable. No
/// pictures.
ShotReport made_up_shot(int frames);

/// A PNG file, its pixels a function of the seed.
std::string made_up_png(int width, int height, int seed);

}  // namespace chromeball::test
