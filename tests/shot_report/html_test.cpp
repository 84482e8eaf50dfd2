#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "shot/html_parts.h"
#include "shot/report.h"
#include "shot_report/made_up.h"

namespace chromeball::test {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

bool is_utf8(const std::string& text) {
    // What `escaped` leaves alone but for the five letters that it escapes.
    std::string plain;
    for (const char c : text)
        if (std::string_view("&<>\"'").find(c) == std::string_view::npos) plain += c;
    return html::escaped(plain) == plain;
}

TEST(EscapedText, HoldsNothingThatHtmlWouldReadAsMarkup) {
    EXPECT_EQ(html::escaped("a<b>&\"c\"'d'"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;d&#39;");
    EXPECT_EQ(html::escaped("caf\xC3\xA9 \xF0\x9F\x94\xAE\n\t"),
              "caf\xC3\xA9 \xF0\x9F\x94\xAE\n\t");
}

TEST(EscapedText, ReplacesWhatIsNoUtf8AndWhatNobodyCanSee) {
    const std::string gap = "\xEF\xBF\xBD";
    EXPECT_EQ(html::escaped("a\xFF z"), "a" + gap + " z");
    EXPECT_EQ(html::escaped(std::string_view("a\0b\x1B[31m\x7F", 9)),
              "a" + gap + "b" + gap + "[31m" + gap);
    EXPECT_EQ(html::escaped("cut \xE2\x82"), "cut " + gap + gap);
    EXPECT_EQ(html::escaped("\xC0\xBC"), gap + gap) << "an overlong <";
    EXPECT_EQ(html::escaped("\xED\xA0\x80"), gap + gap + gap) << "a surrogate";
    EXPECT_EQ(html::escaped("\xF4\x90\x80\x80"), gap + gap + gap + gap) << "beyond the last";
}

TEST(DataUri, IsThatOfPicturesOnly) {
    EXPECT_EQ(html::data_uri("\x89PNG\r\n\x1A\n"), "data:image/png;base64,iVBORw0KGgo=");
    EXPECT_EQ(html::data_uri("\x89PNG\r\n\x1A\n."), "data:image/png;base64,iVBORw0KGgou");
    EXPECT_EQ(html::data_uri("\x89PNG\r\n\x1A\n.."), "data:image/png;base64,iVBORw0KGgouLg==");
    EXPECT_EQ(html::data_uri("\xFF\xD8\xFF\xE0"), "data:image/jpeg;base64,/9j/4A==");
    EXPECT_EQ(html::data_uri("<svg onload=x>"), "");
    EXPECT_EQ(html::data_uri(""), "");
}

TEST(IndentedJson, BreaksObjectsIntoLinesAndLeavesListsAndTextsAlone) {
    EXPECT_EQ(html::indented_json(R"({"a": {"b":[1,2, 3]},"c":"{,:[\"]", "d":{}})"),
              "{\n  \"a\": {\n    \"b\": [1, 2, 3]\n  },\n  \"c\": \"{,:[\\\"]\",\n  \"d\": {}\n}");
    EXPECT_EQ(html::indented_json("}}]\"\\"), "\n}\n}]\"\\") << "no JSON, no harm";
}

TEST(ThePage, CountsOutcomesAndTellsTheSpeed) {
    const std::string page = to_html(made_up_shot(100));
    EXPECT_EQ(count(page, "<b>88</b>found"), 1u);
    EXPECT_EQ(count(page, "<b>8</b>filled"), 1u);
    EXPECT_EQ(count(page, "<b>2</b>held"), 1u);
    EXPECT_EQ(count(page, "<b>1</b>missing"), 1u);
    EXPECT_EQ(count(page, "<b>1</b>failed"), 1u);
    EXPECT_NE(page.find("100 frames, 1001 to 1100"), std::string::npos);
    EXPECT_NE(page.find("20.00 frames/s, 5.0 s with 2 jobs"), std::string::npos);
}

TEST(ThePage, HasARowForEveryFrameAndFlaggedFramesFirst) {
    const std::string page = to_html(made_up_shot(100));
    EXPECT_EQ(count(page, "<tr id=\"f"), 100u);
    EXPECT_EQ(count(page, "<figure class=\"card "), 5u);
    const auto flagged = page.find("id=\"flagged\"");
    EXPECT_LT(flagged, page.find("id=\"track\""));
    EXPECT_LT(page.find("the file ends early"), page.find("id=\"track\""));
    for (const char* id : {"track", "timing", "frames", "settings"})
        EXPECT_EQ(count(page, "id=\"" + std::string(id) + '"'), 1u) << id;
}

TEST(ThePage, IsInOrderOfFramesWhateverTheReportsOrder) {
    ShotReport shot = made_up_shot(50);
    const std::string page = to_html(shot);
    std::swap(shot.frames[3], shot.frames[40]);
    std::swap(shot.frames[0], shot.frames[49]);
    EXPECT_EQ(to_html(shot), page);
}

TEST(ThePage, LoadsNothingFromAnywhereAndRunsNothing) {
    ShotReport shot = made_up_shot(60);
    shot.title = "http://example.com/a.####.exr";
    shot.frames[5].thumbnail = made_up_png(40, 20, 1);
    shot.frames[5].probe = made_up_png(40, 20, 2);
    const std::string page = to_html(shot);
    EXPECT_EQ(count(page, "default-src 'none'"), 1u);
    for (const char* banned : {"<script", "<link", "<iframe", "<object", "<embed", "@import",
                               "url(", "javascript:", "xmlns", "<base", "http-equiv=\"refresh"})
        EXPECT_EQ(count(page, banned), 0u) << banned;
    const std::regex reference(
        R"re(\s(src|href|srcset|action|data|poster|background)\s*=\s*"([^"]*)")re");
    std::size_t pictures = 0;
    for (auto m = std::sregex_iterator(page.begin(), page.end(), reference);
         m != std::sregex_iterator(); ++m) {
        const std::string target = (*m)[2];
        pictures += target.starts_with("data:image/png;base64,");
        EXPECT_TRUE(target.starts_with("#") || target.starts_with("data:image/")) << target;
    }
    EXPECT_EQ(pictures, 2u);
    EXPECT_FALSE(std::regex_search(page, std::regex(R"(<[^>]*\son\w+\s*=)")));
}

TEST(ThePage, ShowsAnyTextAsText) {
    ShotReport shot = made_up_shot(3);
    shot.title = "a<b>&\"'\xFF\x01.####.exr";
    shot.settings_json = "{\"name\":\"</pre><script>alert(1)</script>\xC3\"}";
    shot.frames[1].message = "<img src=x onerror=alert(1)> \xED\xA0\x80";
    shot.frames[1].flagged = true;
    shot.frames[1].thumbnail = "\"><script>";  // no picture
    const std::string page = to_html(shot);
    EXPECT_TRUE(is_utf8(page));
    EXPECT_EQ(count(page, "<script"), 0u);
    EXPECT_EQ(count(page, "<img"), 0u);
    EXPECT_EQ(count(page, "&lt;img src=x onerror=alert(1)&gt;"), 2u) << "on the card, in the table";
    EXPECT_EQ(count(page, "a&lt;b&gt;&amp;&quot;&#39;"), 2u) << "in the title, in the heading";
}

TEST(ThePage, StandsAnyNumbers) {
    ShotReport shot = made_up_shot(4);
    const double odd[] = {NAN, INFINITY, -INFINITY, 1e300};
    for (std::size_t i = 0; i < 4; ++i) {
        shot.frames[i].outline = Outline{odd[i], odd[3 - i], odd[i], odd[i], 0};
        shot.frames[i].tracked = Outline{-odd[i], 1, 2, -1, 0};
        shot.frames[i].confidence = odd[i];
        shot.frames[i].seconds = odd[i];
    }
    shot.frames[0].frame = -2147483647 - 1;
    shot.frames[3].frame = 2147483647;
    shot.wall_seconds = NAN;
    const std::string page = to_html(shot);
    EXPECT_EQ(count(page, "<tr id=\"f"), 4u);
    const std::regex drawn(R"re(\sd="([^"]*)")re");
    for (auto m = std::sregex_iterator(page.begin(), page.end(), drawn);
         m != std::sregex_iterator(); ++m)
        EXPECT_TRUE(std::regex_match((*m)[1].str(), std::regex("[MLHVhvz0-9. -]*"))) << (*m)[1];
}

TEST(ThePage, OfNoFramesOrOneIsAPage) {
    ShotReport shot = made_up_shot(1);
    EXPECT_EQ(count(to_html(shot), "1 frame, 1001 to 1001"), 1u);
    shot.frames.clear();
    EXPECT_EQ(count(to_html(shot), ">0 frames"), 1u);
    EXPECT_TRUE(to_html(shot).ends_with("</body></html>\n"));
}

/// Pictures of about the size that a shot's have.
void add_pictures(ShotReport& shot, std::size_t thumbnail, std::size_t probe) {
    for (FrameReport& frame : shot.frames) {
        frame.thumbnail = "\x89PNG\r\n\x1A\n" + std::string(thumbnail, 't');
        frame.probe = "\x89PNG\r\n\x1A\n" + std::string(probe, 'p');
    }
}

TEST(ThePage, ShowsAllPicturesOfAHundredFramesWithinThreeMegabytes) {
    ShotReport shot = made_up_shot(100);
    add_pictures(shot, 12000, 8000);
    const std::string page = to_html(shot);
    EXPECT_EQ(count(page, "<img "), 200u);
    EXPECT_LT(page.size(), 3'000'000u);
}

TEST(ThePage, OfTenThousandFramesStaysReadable) {
    ShotReport shot = made_up_shot(10000);
    add_pictures(shot, 3000, 2000);
    const std::string page = to_html(shot);
    EXPECT_EQ(count(page, "<tr id=\"f"), 10000u);
    EXPECT_LE(count(page, "<img "), 400u);
    EXPECT_GE(count(page, "<img "), 300u) << "200 frames, a plate and a probe each";
    EXPECT_LT(page.size(), 6'000'000u);
    // The drawings do not grow with the frames.
    const auto drawings = [](const std::string& text) {
        return text.find("id=\"probes\"") - text.find("id=\"track\"");
    };
    ShotReport longer = made_up_shot(40000);
    add_pictures(longer, 3000, 2000);
    const double growth = double(drawings(to_html(longer))) / double(drawings(page));
    EXPECT_LT(growth, 1.2);
}

TEST(ThePage, OfManyFlaggedFramesStillShowsTheWholeShot) {
    ShotReport shot = made_up_shot(2000);
    for (FrameReport& frame : shot.frames) frame.flagged = frame.frame < 2500;
    add_pictures(shot, 100, 100);
    const std::string page = to_html(shot);
    EXPECT_EQ(count(page, "<figure class=\"card "), count(page, "outline drawn"));
    EXPECT_GE(count(page, "outline drawn"), 100u);
    EXPECT_EQ(count(page, "<p><a class=\"number\""), 1000u) << "lines; the rest is in the table";
    EXPECT_NE(page.find("more in the table below"), std::string::npos);
    EXPECT_GE(count(page, "plate of frame 2"), 30u) << "frames 2500 and on, a fourth of them";
}

TEST(ThePage, PrefersThePicturesOfFlaggedFramesAndSpreadsTheOthers) {
    ShotReport shot = made_up_shot(10000);
    for (FrameReport& frame : shot.frames) frame.flagged = frame.frame % 100 == 0;
    add_pictures(shot, 100, 0);
    const std::string page = to_html(shot);
    EXPECT_EQ(count(page, "outline drawn"), 100u) << "every card has its picture";
    const auto plates = page.substr(page.find("id=\"plates\""));
    const std::regex number("plate of frame ([0-9]+)");
    int before = 1000, widest = 0, shown = 0;
    for (auto m = std::sregex_iterator(plates.begin(), plates.end(), number);
         m != std::sregex_iterator(); ++m, ++shown) {
        const int frame = std::stoi((*m)[1]);
        widest = std::max(widest, frame - before);
        before = frame;
    }
    EXPECT_EQ(shown, 100);
    EXPECT_EQ(count(page, "<figure class=\"card "), 100u);
    EXPECT_LT(std::max(widest, 11000 - before), 200)
        << "evenly: 100 of 10000, within a factor of 2";
}

/// The y of the dots or the line of a class, by their order.
std::vector<double> heights(const std::string& page, const std::string& of_class) {
    std::vector<double> all;
    const auto at = page.find("class=\"" + of_class + "\" d=\"");
    if (at == std::string::npos) return all;
    const std::string path = page.substr(at, page.find("/>", at) - at);
    const std::regex point("[ML]([0-9.-]+) ([0-9.-]+)");
    for (auto m = std::sregex_iterator(path.begin(), path.end(), point);
         m != std::sregex_iterator(); ++m)
        all.push_back(std::stod((*m)[2]));
    return all;
}

TEST(TheCurves, RiseWhereTheValueRisesAndBreakWhereThereIsNone) {
    ShotReport shot = made_up_shot(20);
    for (std::size_t i = 0; i < 20; ++i) {
        shot.frames[i].outline = Outline{100.0 + static_cast<double>(i), 50, 10, 10, 0};
        shot.frames[i].tracked = shot.frames[i].outline;
    }
    const std::string page = to_html(shot);
    const std::vector<double> x = heights(page, "line x");
    ASSERT_EQ(x.size(), 20u);
    for (std::size_t i = 1; i < x.size(); ++i)
        EXPECT_NEAR(x[i] - x[i - 1], x[1] - x[0], 0.03);  // two roundings to 0.01
    EXPECT_LT(x[1], x[0]) << "up is less";
    shot.frames[10].outline.reset();
    const auto moves = [](const std::string& text) {
        const auto at = text.find("class=\"line x\" d=\"");
        return count(text.substr(at, text.find("/>", at) - at), "M");
    };
    EXPECT_EQ(moves(page), 1u);
    EXPECT_EQ(moves(to_html(shot)), 2u);
}

std::string first_chart(const std::string& page) {
    const auto at = page.find("class=\"chart\"");
    return page.substr(at, page.find("</figure>", at) - at);
}

TEST(TheCurves, MarkOverruledDetectionsAtTheEdgeInsteadOfStretchingTheScale) {
    ShotReport shot = made_up_shot(20);
    const std::vector<double> before = heights(first_chart(to_html(shot)), "line x");
    shot.frames[7].outcome = FrameOutcome::filled;
    shot.frames[7].tracked->cx += 5000;
    const std::string page = first_chart(to_html(shot));
    const std::vector<double> after = heights(page, "line x");
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 2);
    EXPECT_EQ(heights(page, "dots outside").size(), 1u);
    EXPECT_EQ(heights(page, "dots overruled").size(), 0u);
}

TEST(TheCurves, KeepTheOneFrameThatSticksOutOfThousands) {
    ShotReport shot = made_up_shot(8000);
    for (FrameReport& frame : shot.frames) {
        frame.outline = Outline{100, 50, 10, 10, 0};
        frame.tracked.reset();
    }
    shot.frames[4321].outline->cx = 200;
    const std::vector<double> x = heights(to_html(shot), "line x");
    const auto [low, high] = std::minmax_element(x.begin(), x.end());
    EXPECT_GT(*high - *low, 100);
    EXPECT_LT(x.size(), 2500u);
}

}  // namespace
}  // namespace chromeball::test
