#include "stop.h"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>

namespace chromeball {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void on_signal(int) { requested = true; }

}  // namespace

const std::atomic<bool>& stop_requested() { return requested; }

void hold_standard_streams() {
    // open() gives the lowest free number; the one past the three means that none was free. A
    // closed output is held open for reading only.
    for (int descriptor = 0; descriptor <= 2;) {
        descriptor = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
        if (descriptor < 0) return;
        if (descriptor > 2) ::close(descriptor);
    }
}

void handle_signals() {
    struct sigaction action = {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    action.sa_handler = SIG_IGN;
    sigaction(SIGXFSZ, &action, nullptr);
    sigaction(SIGPIPE, &action, nullptr);
}

}  // namespace chromeball
