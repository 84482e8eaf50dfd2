#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "cli/browser.h"
#include "cli/program.h"
#include "cli/world.h"
#include "io/write.h"

// The page that one can turn by hand: what is in it, and what a browser makes of it.

namespace chromeball {
namespace {

using namespace test;

/// A world with edges and writing, so to speak: coloured octants, each with a disk.
V3d signs(const V3d& d) {
    V3d color(d.x > 0 ? 0.7 : 0.15, d.y > 0 ? 0.6 : 0.1, d.z > 0 ? 0.8 : 0.2);
    const V3d corner =
        V3d(std::copysign(1.0, d.x), std::copysign(1.0, d.y), std::copysign(1.0, d.z)).normalized();
    if (corner.dot(d) > 0.97) color = V3d(1, 1, 1) - color;
    return color;
}

class Page : public ::testing::Test {
protected:
    Page() {
        const Layout& layout = *find_layout("latlong");
        Image map(layout.picture(256), 3);
        for (int y = 0; y < map.height(); ++y)
            for (int x = 0; x < map.width(); ++x) {
                const V3d c = signs(*LatLong().to_direction(
                    V2d((x + 0.5) / map.width(), (y + 0.5) / map.height())));
                for (int k = 0; k < 3; ++k) map.pixel(x, y)[k] = static_cast<float>(c[k]);
            }
        write_exr(folder_ / "map.exr", map);
    }
    std::string page(const Words& more = {}) {
        Words words{"preview", "map.exr", "--html", "out.html", "--quiet"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = run(folder_, words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        return read_bytes(folder_ / "out.html");
    }
    /// Pages, each in a frame of its own, side by side in one visit: a browser takes seconds to
    /// start.
    struct Shown {
        std::string console;
        std::set<std::string> requests;
        std::vector<Image> pictures;
    };
    Shown shown(const std::vector<std::pair<std::string, std::string>>& pages) {
        std::string all = "<!DOCTYPE html><body style='margin:0;font-size:0'>";
        for (std::size_t i = 0; i < pages.size(); ++i) {
            write_bytes(folder_ / fmt::format("frame{}.html", i), pages[i].first);
            all += fmt::format(
                "<iframe src='frame{}.html{}' style='border:0;width:400px;height:300px'></iframe>",
                i, pages[i].second);
        }
        const Visit all_at_once =
            visit(folder_, program_, all,
                  {"--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                   fmt::format("--window-size={},300", 400 * pages.size())});
        Shown result{all_at_once.console, all_at_once.requests, {}};
        if (all_at_once.picture.size() != Size{400 * int(pages.size()), 300}) {
            ADD_FAILURE() << "the screenshot is " << all_at_once.picture.width() << " wide";
            result.pictures.resize(pages.size());
            return result;
        }
        for (std::size_t i = 0; i < pages.size(); ++i) {
            Image one({400, 300}, 3);
            for (int y = 0; y < 300; ++y)
                for (int x = 0; x < 400; ++x)
                    std::copy_n(all_at_once.picture.pixel(400 * int(i) + x, y), 3, one.pixel(x, y));
            result.pictures.push_back(std::move(one));
        }
        return result;
    }
    Image own(const Words& more) {
        Words words{"preview", "map.exr",  "--background", "--size=400,300",
                    "--quiet", "--bits=8", "-o",           "own.png"};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run(folder_, words).status, 0);
        return read_floats(folder_ / "own.png");
    }
    bool no_browser() {
        program_ = browser(folder_);
        return program_ == nullptr;
    }

    TempFolder folder_;
    const char* program_ = nullptr;
};

double mean_difference(const Image& a, const Image& b) {
    EXPECT_EQ(a.size(), b.size());
    if (a.size() != b.size()) return 255;
    double sum = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x)
            for (int c = 0; c < 3; ++c)
                sum += std::abs(double(a.pixel(x, y)[c]) - double(b.pixel(x, y)[c]));
    return 255 * sum / (3.0 * double(a.size().pixels()));
}

TEST_F(Page, IsOneFileBelowFourMegabytesThatNeedsNothing) {
    for (const char* mesh : {"sphere", "torus", "plane", "knot", "bean", "teapot"}) {
        const std::string text = page({"--mesh", mesh});
        EXPECT_LT(text.size(), 4'000'000u) << mesh;
        EXPECT_EQ(text.find("http"), std::string::npos) << mesh;
        EXPECT_EQ(text.find("src="), std::string::npos) << mesh;
        EXPECT_EQ(text.find('@'), text.npos) << mesh << ": no mark is left";
        EXPECT_NE(text.find("<title>map.exr</title>"), std::string::npos);
    }
    EXPECT_LT(page({"--face=64"}).size(), 700'000u);
    EXPECT_EQ(page({"--face=64"}), page({"--face=64", "--threads=1"})) << "the same bytes";
}

/// What a page says of its map's coverage, 0 to 255, a face after the other.
std::vector<int> coverage_in(const std::string& page) {
    const std::string key = "\"coverage\":\"";
    const std::size_t from = page.find(key) + key.size();
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<int> bytes, coverage;
    unsigned bits = 0;
    int count = 0;
    for (std::size_t i = from; i < page.size() && page[i] != '"' && page[i] != '='; ++i) {
        bits = bits << 6 | static_cast<unsigned>(letters.find(page[i]));
        if ((count += 6) < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<int>(bits >> count & 255U));
    }
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2)  // runs: how many, and of what
        coverage.insert(coverage.end(), static_cast<std::size_t>(bytes[i]), bytes[i + 1]);
    return coverage;
}

TEST_F(Page, MarksWhatTheMapIsNotSureOf) {
    const Image map = read_floats(folder_ / "map.exr");
    Image sure(map.size(), 5);
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            float* to = sure.pixel(x, y);
            std::copy_n(map.pixel(x, y), 3, to);
            to[3] = 1;
            to[4] = y < map.height() / 2 ? 1.0F : 0.25F;  // of what lies below only a little
        }
    WriteOptions options;
    options.full_float = true;
    options.confidence = true;
    write_image(folder_ / "map.exr", sure.view(), options);
    const auto coverage = coverage_in(page({"--face=16"}));
    ASSERT_EQ(coverage.size(), 6U * 16 * 16);
    const auto face = [&](std::size_t k) {
        return std::vector<int>(coverage.begin() + static_cast<std::ptrdiff_t>(k * 256),
                                coverage.begin() + static_cast<std::ptrdiff_t>((k + 1) * 256));
    };
    EXPECT_EQ(face(2), std::vector<int>(256, 255)) << "+Y";
    EXPECT_EQ(face(3), std::vector<int>(256, 64)) << "-Y: a quarter of 255";
    // As before, where the map says nothing of that.
    write_exr(folder_ / "map.exr", map);
    EXPECT_EQ(coverage_in(page({"--face=16"})), std::vector<int>(6U * 16 * 16, 255));
}

TEST_F(Page, IsRefusedWithPicturesAndSets) {
    const auto status = [&](const Words& more) {
        Words words{"preview", "map.exr", "--quiet"};
        words.insert(words.end(), more.begin(), more.end());
        return run(folder_, words).status;
    };
    EXPECT_EQ(status({"--html=a.html", "-o", "a.png"}), 2);
    EXPECT_EQ(status({"--html=a.html", "--set=lookdev"}), 2);
    EXPECT_EQ(status({"--html=a.html", "--face=100"}), 2);
    EXPECT_EQ(status({"--html=map.exr"}), 2);
    EXPECT_EQ(status({"--html=nowhere/a.html"}), 1);
    EXPECT_EQ(status({}), 2) << "neither";
    EXPECT_FALSE(exists(folder_ / "a.html"));
}

TEST_F(Page, ShowsInABrowserWhatPreviewShows) {
    if (no_browser()) GTEST_SKIP() << "no Chromium here: the page is not looked at";
    const std::pair<const char*, const char*> cases[] = {{"bean", "--orbit=30,15,4"},
                                                         {"torus", "--orbit=200,-40,3"},
                                                         {"sphere", "--orbit=110,60,4"}};
    std::vector<std::pair<std::string, std::string>> pages;
    for (const auto& [mesh, orbit] : cases)
        pages.emplace_back(page({"--mesh", mesh, orbit}), "#ui=0");
    const Shown all = shown(pages);
    EXPECT_EQ(all.console, "");
    for (const std::string& request : all.requests)
        EXPECT_TRUE(request.starts_with("file:") || request.starts_with("data:")) << request;
    for (std::size_t i = 0; i < pages.size(); ++i) {
        const auto& [mesh, orbit] = cases[i];
        EXPECT_LT(mean_difference(all.pictures[i], own({"--mesh", mesh, orbit})), 2) << mesh;
        // The measure tells: another side of the map is far from it.
        EXPECT_GT(mean_difference(all.pictures[i], own({"--mesh", mesh, "--orbit=10,30,4"})), 10)
            << mesh;
    }
}

TEST_F(Page, HasItsSwitches) {
    if (no_browser()) GTEST_SKIP() << "no Chromium here: the page is not looked at";
    const std::string text = page({"--mesh=sphere"});
    const char* fragments[] = {"#ui=0",
                               "#ui=0&ev=-2",
                               "#ui=0&mode=vertex",
                               "#ui=0&mode=glass",
                               "#ui=0&mode=rough&rough=0.8",
                               "#ui=0&sky=0",
                               "#ui=1",
                               "#ui=0&az=50"};
    std::vector<std::pair<std::string, std::string>> pages;
    for (const char* fragment : fragments) pages.emplace_back(text, fragment);
    const Shown all = shown(pages);
    EXPECT_EQ(all.console, "");
    for (std::size_t i = 1; i < pages.size(); ++i)
        EXPECT_GT(mean_difference(all.pictures[0], all.pictures[i]), 0.5) << fragments[i];
    // Two stops less are a quarter of the light.
    const auto linear = [](float x) {
        return x <= 0.04045F ? x / 12.92F : std::pow((x + 0.055F) / 1.055F, 2.4F);
    };
    EXPECT_NEAR(linear(all.pictures[0].pixel(20, 20)[2]) / linear(all.pictures[1].pixel(20, 20)[2]),
                4, 0.4);
}

TEST_F(Page, TurnsByMouseAndTouchAndHasASliderForExposure) {
    if (no_browser()) GTEST_SKIP() << "no Chromium here: the page is not looked at";
    const std::string text = page({"--mesh=torus", "--orbit=30,15,4"});
    // What a hand would do, done by the page to itself once it stands.
    const auto with = [&](const std::string& deeds) {
        std::string acting = text;
        const std::string script = R"(<script>
            const view = document.getElementById('view');
            view.setPointerCapture = () => {};  // of pointers that no hand holds
            const at = (kind, id, x, y) => view.dispatchEvent(new PointerEvent(kind,
                {pointerId: id, clientX: x, clientY: y, bubbles: true}));
            const set = (id, key, value) => {
                const control = document.getElementById(id);
                control[key] = value;
                control.dispatchEvent(new Event('input'));
            };
            )" + deeds + "</script>";
        acting.insert(acting.rfind("</body>"), script);
        return acting;
    };
    // A drag, then two fingers that part, then the wheel.
    const std::string hand =
        "at('pointerdown', 1, 100, 100); at('pointermove', 1, 150, 125);"
        "at('pointermove', 1, 200, 150); at('pointerup', 1, 200, 150);"
        "at('pointermove', 1, 300, 300);"
        "at('pointerdown', 1, 100, 100); at('pointerdown', 2, 200, 100);"
        "at('pointermove', 2, 250, 100); at('pointerup', 1, 100, 100);"
        "at('pointercancel', 2, 250, 100);"
        "view.dispatchEvent(new WheelEvent('wheel', {deltaY: 200, cancelable: true}));";
    const std::string panel =
        "set('exposure', 'value', '-1.5'); set('mode', 'value', 'glass');"
        "set('sky', 'checked', false);";
    const std::tuple<std::string, std::string, std::string> cases[] = {
        {hand, "#ui=0", "#ui=0&az=-10&el=35&d=3.2570741"},
        {panel, "#ui=0", "#ui=0&ev=-1.5&mode=glass&sky=0"}};
    std::vector<std::pair<std::string, std::string>> pages{{text, "#ui=0"}};
    for (const auto& [deeds, from, to] : cases) {
        pages.emplace_back(with(deeds), from);
        pages.emplace_back(text, to);
    }
    const Shown all = shown(pages);
    EXPECT_EQ(all.console, "");
    for (std::size_t i = 0; i < std::size(cases); ++i) {
        const Image &done = all.pictures[2 * i + 1], &wanted = all.pictures[2 * i + 2];
        EXPECT_LT(mean_difference(done, wanted), 0.1) << std::get<0>(cases[i]);
        EXPECT_GT(mean_difference(done, all.pictures[0]), 1) << std::get<0>(cases[i]);
    }
}

TEST_F(Page, MarksWhatTheMapLacks) {
    if (no_browser()) GTEST_SKIP() << "no Chromium here: the page is not looked at";
    // A map without its lower half.
    const Image map = read_floats(folder_ / "map.exr");
    Image half(map.size(), 4);
    for (int y = 0; y < map.height() / 2; ++y)
        for (int x = 0; x < map.width(); ++x) {
            std::copy_n(map.pixel(x, y), 3, half.pixel(x, y));
            half.pixel(x, y)[3] = 1;
        }
    write_exr(folder_ / "map.exr", half);
    const Image marked = shown({{page({"--orbit=0,0,4"}), "#ui=0&lacking=1"}}).pictures[0];
    // Below the horizon of the sky, magenta; above it is not.
    const float* below = marked.pixel(20, 280);
    EXPECT_GT(below[0], 0.9F);
    EXPECT_LT(below[1], 0.1F);
    const float* above = marked.pixel(20, 20);
    EXPECT_FALSE(above[0] > 0.9F && above[1] < 0.1F);
}

}  // namespace
}  // namespace chromeball
