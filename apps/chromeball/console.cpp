#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "stop.h"

namespace chromeball {
namespace {

/// The bar is redrawn in place and wiped when the job is done.
void draw_bar(const std::string& what, double done) {
    constexpr int kWidth = 40;
    const int filled = static_cast<int>(done * kWidth);
    if (done >= 1)
        print_message("\r\033[K");
    else
        print_message(fmt::format("\r\033[K{} [{:=<{}}{: <{}}] {:3.0f} %", what, "", filled, "",
                                  kWidth - filled, 100 * done));
}

using Clock = std::chrono::steady_clock;

/// 0:09, 12:34, 3:00:00.
std::string time_text(double seconds) {
    const auto s = static_cast<long>(std::ceil(seconds));
    if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
    return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

void Console::say(const std::string& line) const {
    if (!quiet_) print_message(fmt::format("{}\n", line));
}

void Console::warn(const std::string& line) const {
    print_message(fmt::format("warning: {}\n", line));
}

Watch Console::watch(std::string_view what) const {
    Watch watch{&stop_requested(), nullptr};
    if (quiet_) return watch;
    const bool terminal = isatty(STDERR_FILENO) == 1;
    watch.progress = [what = std::string(what), terminal,
                      last = std::make_shared<int>(0)](double done) {
        // Percents on a terminal, quarters in a log; each once.
        const int step = static_cast<int>(done * (terminal ? 100 : 4));
        if (step <= *last) return;
        *last = step;
        if (terminal)
            draw_bar(what, done);
        else
            print_message(fmt::format("{}: {} %\n", what, 25 * step));
    };
    return watch;
}

Progress Console::frames(std::string_view what, std::size_t count) const {
    if (quiet_ || count == 0) return nullptr;
    const bool terminal = isatty(STDERR_FILENO) == 1;
    const auto start = Clock::now();
    return [what = std::string(what), count, terminal, start,
            told = std::size_t{0}](std::size_t done) mutable {
        // Every frame on a terminal, quarters in a log.
        const std::size_t step = terminal ? done : 4 * done / count;
        if (step <= told) return;
        told = step;
        const double seconds =
            std::max(1e-3, std::chrono::duration<double>(Clock::now() - start).count());
        const double left = seconds / double(done) * double(count - done);
        const std::string line = fmt::format("{}: {}/{} frames, {:.2f} frames/s, {} left", what,
                                             done, count, double(done) / seconds, time_text(left));
        if (!terminal)
            print_message(line + "\n");
        else
            print_message(done == count ? "\r\033[K" : "\r\033[K" + line);
    };
}

void print_message(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

void print_result(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw Error(Error::Kind::failed,
                    "standard output cannot be written (closed, or its disk is full)");
}

}  // namespace chromeball
