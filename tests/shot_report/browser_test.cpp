#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>
#include <sstream>

#include "cli/program.h"
#include "cli/world.h"
#include "shot/report.h"
#include "shot_report/made_up.h"

// The page as a browser shows it: headless Chromium, where it is installed.

namespace chromeball::test {
namespace {

/// What a browser made of a page.
struct Visit {
    std::string console;             ///< what it said on the console
    std::set<std::string> requests;  ///< what the page asked the network for
    Image picture;
};

const char* browser(const TempFolder& folder) {
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
        if (run_other(folder, {name, "--version"}).status == 0) return name;
    return nullptr;
}

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

Visit visit(const TempFolder& folder, const char* program, const std::string& page,
            const Words& more = {}) {
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
    words.push_back("file://" + folder / "page.html");
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

/// How much of a picture is near an 8-bit colour.
double part_near(const Image& picture, std::array<int, 3> color) {
    std::size_t near = 0;
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            double most = 0;
            for (std::size_t k = 0; k < 3; ++k)
                most = std::max(most, std::abs(255.0 * picture.pixel(x, y)[k] - color[k]));
            near += most < 12;
        }
    return static_cast<double>(near) / static_cast<double>(picture.size().pixels());
}

ShotReport pictured_shot() {
    ShotReport shot = made_up_shot(100);
    for (FrameReport& frame : shot.frames) {
        if (frame.outcome == FrameOutcome::failed || frame.outcome == FrameOutcome::missing)
            continue;
        frame.thumbnail = made_up_png(240, 135, frame.frame);
        frame.probe = made_up_png(128, 64, frame.frame);
    }
    return shot;
}

class ThePageInABrowser : public ::testing::Test {
protected:
    void SetUp() override {
        program_ = browser(folder_);
        if (!program_) GTEST_SKIP() << "no Chromium here: the page is not looked at";
    }
    TempFolder folder_;
    const char* program_ = nullptr;
};

// The measuring device first: it must tell of what it is to exclude below.
TEST_F(ThePageInABrowser, IsWatchedByABrowserThatTellsOfErrorsAndRequests) {
    const Visit bad = visit(folder_, program_,
                            "<!DOCTYPE html><img src=\"http://127.0.0.1:9/x.png\">"
                            "<script>throw new Error('boom')</script>");
    EXPECT_NE(bad.console.find("boom"), std::string::npos);
    EXPECT_TRUE(bad.requests.contains("http://127.0.0.1:9/x.png"));
    EXPECT_GT(part_near(bad.picture, {255, 255, 255}), 0.99) << "a blank page is seen as such";
}

TEST_F(ThePageInABrowser, IsNotBlankSaysNothingAndAsksForNothing) {
    const Visit light = visit(folder_, program_, to_html(pictured_shot()));
    EXPECT_EQ(light.console, "");
    for (const std::string& request : light.requests)
        EXPECT_TRUE(request.starts_with("file:") || request.starts_with("data:")) << request;
    ASSERT_FALSE(light.picture.empty());
    EXPECT_GT(part_near(light.picture, {0xf6, 0xf7, 0xf8}), 0.1) << "its background";
    EXPECT_GT(part_near(light.picture, {0x2f, 0x9e, 0x6b}), 0.001) << "the band of found frames";
    EXPECT_GT(part_near(light.picture, {0x3b, 0x7d, 0xdd}), 0.0001) << "and of filled ones";
    EXPECT_LT(part_near(light.picture, {255, 255, 255}), 0.8) << "more than cards";
}

TEST_F(ThePageInABrowser, IsDarkForThoseWhoLikeItDark) {
    const Visit dark = visit(folder_, program_, to_html(pictured_shot()),
                             {"--blink-settings=preferredColorScheme=0"});
    EXPECT_EQ(dark.console, "");
    EXPECT_GT(part_near(dark.picture, {0x15, 0x18, 0x1b}), 0.1) << "its background";
}

}  // namespace
}  // namespace chromeball::test
