#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chromeball {

/// Frame numbers, ascending, each once.
using Frames = std::vector<int>;

/// From what --frames says: single numbers, ranges, ranges with a step, and lists of them:
/// "1001-1100", "1001-1100x2", "1,5,9-12". Throws Error (usage) naming the part that is wrong.
Frames parse_frames(std::string_view text);

/// The shortest such text: "1001-1048", "1,5,9-12".
std::string text_of(const Frames& frames);

/// The numbers between the first and the last frame that are not there.
Frames gaps_in(const Frames& frames);

/// Every so many frame numbers there is a key frame.
constexpr int kKeyInterval = 16;

/// Which block of so many numbers a frame is in; block n begins with frame n times the interval.
int block_of(int frame);

/// The key frame from whose outline a frame's search starts: the multiple of 16 at or below it if
/// that is there, else the lowest number above that multiple which is. The frame itself is taken
/// to be there. A function of the number and of what plates exist, never of what ran before.
int key_frame(int frame, const std::function<bool(int)>& there);

/// The key frame of the block behind the frame's own, to which the ball moves from its own key
/// frame; nothing where no plate of that block is there.
std::optional<int> next_key_frame(int frame, const std::function<bool(int)>& there);
/// The key frame of the block before the frame's; nothing where that has no frames.
std::optional<int> previous_key_frame(int frame, const std::function<bool(int)>& there);

}  // namespace chromeball
