#pragma once

#include <atomic>

namespace chromeball {

/// Becomes true on Ctrl-C or SIGTERM, once handle_signals() was called: jobs stop at the next step,
/// temporary files are removed, the exit status is 130.
const std::atomic<bool>& stop_requested();

/// Gives closed standard streams a place, so that no file that is opened later gets their number
/// and what is meant for the user: reading finds nothing, writing fails.
void hold_standard_streams();

/// Installs the handlers; a full file-size limit (SIGXFSZ) and a closed pipe become write errors.
void handle_signals();

}  // namespace chromeball
