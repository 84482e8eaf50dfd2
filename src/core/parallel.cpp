#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>

namespace chromeball {

void for_each_band(int rows, int grain, const std::function<void(int, int)>& work,
                   const Watch& watch) {
    const int bands = (rows + grain - 1) / grain;
    std::mutex telling;
    int done = 0;
    tbb::parallel_for(0, bands, [&](int band) {
        if (watch.stopping()) return;
        work(band * grain, std::min(rows, (band + 1) * grain));
        if (!watch.progress) return;
        const std::lock_guard lock(telling);
        watch.progress(static_cast<double>(++done) / bands);
    });
    watch.check();
}

struct ThreadLimit::State {
    // Made in its place: a global_control can be copied, but the limit goes with the original.
    explicit State(int threads)
        : control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)) {
    }
    tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
    if (threads > 0) state_ = std::make_unique<State>(threads);
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace chromeball
