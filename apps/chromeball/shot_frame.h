#pragma once

#include <string>

#include "io/write.h"
#include "map/orientation.h"
#include "photo_job.h"
#include "shot.h"

// One frame of a solved shot, as its map and what is put into its plate are made from.

namespace chromeball {

/// The frame's photo, as far as its ball needs it, with the solved outline as its ball. Throws
/// Error.
PhotoJob solved_job(const Shot& shot, const SolveHead& head, const SolvedFrame& frame);

/// From the frame's camera to the world: as told for all, by --cameras, or as its file says.
Rotation frame_to_world(const Shot& shot, const Photo& photo, int frame);

/// One line of all that the frame's ball depends on: its plate, where it is, how blurred.
std::string words_of(const Shot& shot, const SolvedFrame& frame);

/// Whether a file is there, whole, not older than the frame's plate, and made of what the
/// fingerprint says. Takes away what a run that was killed left beside it.
bool is_current(const Shot& shot, int frame, const std::string& file,
                const std::string& fingerprint, FileFormat format);

}  // namespace chromeball
