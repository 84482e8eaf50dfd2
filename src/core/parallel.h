#pragma once

#include <functional>
#include <memory>

#include "core/watch.h"

namespace chromeball {

/// Calls work(first, last) for disjoint ranges that together are [0, rows), on oneTBB's threads,
/// about `grain` rows each.
///
/// The ranges are the same for any number of threads; with work that writes only its own rows so is
/// the result. Throws Error of kind `interrupted` when the watch says stop; what work throws is
/// passed on.
void for_each_band(int rows, int grain, const std::function<void(int first, int last)>& work,
                   const Watch& watch = {});

/// While it lives at most that many threads work, in the whole process; 0: as many as processors.
class ThreadLimit {
public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace chromeball
