#include "shot/workers.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace chromeball {

void for_each_frame(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                    const Watch& watch, const std::function<void(std::size_t)>& told) {
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    std::exception_ptr first;
    std::mutex lock;
    std::size_t done = 0;
    const auto take_frames = [&] {
        while (!failed && !watch.stopping()) {
            const std::size_t i = next++;
            if (i >= count) return;
            try {
                work(i);
                const std::lock_guard hold(lock);
                ++done;
                if (told) told(done);
            } catch (...) {
                const std::lock_guard hold(lock);
                if (!first) first = std::current_exception();
                failed = true;
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        const auto wanted = std::min(static_cast<std::size_t>(std::max(jobs, 1)), count);
        for (std::size_t i = 1; i < wanted; ++i) threads.emplace_back(take_frames);
        take_frames();
    }
    if (first) std::rethrow_exception(first);
    watch.check();
}

}  // namespace chromeball
