#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shot/frames.h"

// A stage's values lie in a folder, in a file for each run: machines never write the same one. A
// file's name tells which frames its run had, so that a task reads those that concern its own
// frames and not all, which at the farm would be tasks times files.

namespace chromeball {

/// The name of the file of a run with these frames, ending in .jsonl; `frames` must not be empty.
std::string stage_file_name(const Frames& frames);

/// Whether a file of such a name may hold records of any of the frames or of their key frames. A
/// run also searches the key frames of its own frames, so blocks of 16 frame numbers count, of
/// which neighbours have a key frame in common. Of names of another make nothing is known: they
/// may.
bool may_hold(std::string_view file_name, const Frames& frames);

/// The paths of a stage's files in its folder, as their names sort; none where it has not begun.
std::vector<std::string> stage_files(const std::string& folder);
/// Of these the ones that may hold records of any of the frames.
std::vector<std::string> stage_files(const std::string& folder, const Frames& frames);

}  // namespace chromeball
