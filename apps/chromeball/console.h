#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "core/watch.h"

namespace chromeball {

/// Called with the number of frames done so far, from one thread at a time.
using Progress = std::function<void(std::size_t done)>;

/// What a command tells the user on stderr: what it decided, warnings, progress.
class Console {
public:
    explicit Console(bool quiet) : quiet_(quiet) {}

    /// A decision, such as which outline was found; silenced by --quiet.
    void say(const std::string& line) const;
    /// Something the user should know before trusting the result; never silenced.
    void warn(const std::string& line) const;
    /// Watches a job: stops it on Ctrl-C; a bar on a terminal, a line a quarter otherwise.
    Watch watch(std::string_view what) const;
    /// Shows how many of so many frames are done, how many a second, and how long it will still
    /// take; nothing where there are none.
    Progress frames(std::string_view what, std::size_t count) const;

private:
    bool quiet_;
};

/// Writes a message to stderr. Where that is closed or full the message is lost, the job is not.
void print_message(const std::string& text);

/// Writes a result to stdout; throws Error when it cannot be written.
void print_result(const std::string& text);

}  // namespace chromeball
