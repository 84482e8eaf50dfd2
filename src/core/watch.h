#pragma once

#include <atomic>
#include <functional>

#include "core/error.h"

namespace chromeball {

/// How a long job is watched from outside: asked to stop, and told how far it is. Both may be
/// absent.
struct Watch {
    const std::atomic<bool>* stop = nullptr;  ///< becomes true when the user wants to stop
    std::function<void(double)> progress =
        nullptr;  ///< called with the part done, 0 to 1, from one thread at a time

    bool stopping() const { return stop && stop->load(std::memory_order_relaxed); }
    /// Throws Error of kind `interrupted` once a stop was asked for.
    void check() const {
        if (stopping()) throw Error(Error::Kind::interrupted, "interrupted");
    }
};

}  // namespace chromeball
