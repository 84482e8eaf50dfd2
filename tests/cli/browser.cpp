#include "cli/browser.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <sstream>

#include "cli/world.h"

namespace chromeball::test {
namespace {

/// Lines that pages cause on the console, as "[...:INFO:CONSOLE:1] ...".
std::string console_lines(const std::string& log) {
    std::string lines;
    std::istringstream all(log);
    for (std::string line; std::getline(all, line);)
        if (line.find("CONSOLE") != std::string::npos) lines += line + '\n';
    return lines;
}

/// The addresses asked for on behalf of a page; the browser's own requests have no origin.
std::set<std::string> page_requests(const std::string& net_log) {
    static const std::regex request(R"re("initiator":"([^"]*)".*"url":"([^"]*)")re");
    std::set<std::string> found;
    std::istringstream events(net_log);
    std::smatch match;
    for (std::string event; std::getline(events, event);)
        if (std::regex_search(event, match, request) && match[1] != "not an origin")
            found.insert(match[2]);
    return found;
}

}  // namespace

const char* browser(const TempFolder& folder) {
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
        if (run_other(folder, {name, "--version"}).status == 0) return name;
    return nullptr;
}

Visit visit(const TempFolder& folder, const char* program, const std::string& page,
            const Words& more, const std::string& fragment) {
    write_bytes(folder / "page.html", page);
    Words words{program,
                "--headless",
                "--no-sandbox",
                "--disable-dev-shm-usage",
                "--no-first-run",
                "--disable-background-networking",
                "--disable-component-update",
                "--hide-scrollbars",
                "--user-data-dir=" + folder / "profile",
                "--enable-logging=stderr",
                "--log-net-log=" + folder / "net.json",
                "--window-size=1300,2400",
                "--screenshot=" + folder / "shot.png"};
    words.insert(words.end(), more.begin(), more.end());
    words.push_back("file://" + folder / "page.html" + fragment);
    const Outcome outcome = run_other(folder, words);
    Visit visit;
    visit.console = console_lines(outcome.err);
    visit.requests = page_requests(read_bytes(folder / "net.json"));
    if (!exists(folder / "shot.png")) {
        ADD_FAILURE() << "no screenshot; status " << outcome.status << "\n" << outcome.err;
        return visit;
    }
    visit.picture = read_floats(folder / "shot.png");
    if (const char* keep = std::getenv("CHROMEBALL_KEEP_SCREENSHOTS")) {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        write_bytes(std::string(keep) + "/" + test->name() + ".png",
                    read_bytes(folder / "shot.png"));
        write_bytes(std::string(keep) + "/" + test->name() + ".html", page);
    }
    return visit;
}

}  // namespace chromeball::test
