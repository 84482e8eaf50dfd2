#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

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
