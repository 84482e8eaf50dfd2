#pragma once

#include <cstddef>
#include <functional>

#include "core/watch.h"

namespace chromeball {

/// Calls work(i) once for every i below count, on `jobs` threads that each own one frame at a
/// time, begun in order. Calls told(done) after each, from one thread at a time.
///
/// What work throws ends the whole: no further frame is begun, those under way are waited for, and
/// the first exception is passed on. Throws Error of kind `interrupted` when the watch says stop.
void for_each_frame(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                    const Watch& watch,
                    const std::function<void(std::size_t done)>& told = nullptr);

}  // namespace chromeball
