#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "cli/browser.h"
#include "cli/program.h"
#include "cli/world.h"
#include "shot/report.h"
#include "shot_report/made_up.h"

// The page as a browser shows it: headless Chromium, where it is installed.

namespace chromeball::test {
namespace {

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
