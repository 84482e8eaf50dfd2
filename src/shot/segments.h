#pragma once

#include <array>
#include <vector>

namespace chromeball {

/// Where the ball was seen in one frame, for finding out which sightings belong together.
struct Waypoint {
    int frame = 0;
    double x = 0, y = 0, radius = 0;  ///< pixels
    double trust = 1;                 ///< what it costs to overrule it: 1 a sure sighting
    bool certain = false;             ///< told by hand: never overruled
};

/// Which waypoints lie on the ball's path, and which piece of it each belongs to.
///
/// The path is the chain of waypoints with the least cost: overruling one costs its trust, a jump
/// (a cut, a ball moved between takes) as much as four. So the detection of another thing in a few
/// frames is overruled, and what stays at a new place is a new piece; beside what a hand placed a
/// jump costs sixteen. How fast a ball may move
/// before it counts as a jump follows from how fast it moves around there.
///
/// Gives for each waypoint the number of its piece, from 0, or -1 where it is overruled.
std::vector<int> pieces_of(const std::vector<Waypoint>& waypoints);

}  // namespace chromeball
