#include "shot/records.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "shot/cameras.h"

namespace chromeball {
namespace {

TrackRecord full_record() {
    TrackRecord r;
    r.frame = 1010;
    r.settings = "abc";
    r.plate = "12-34";
    r.ball = Sighting{{0.1 + 0.2, 2, 30, 29, 44}, V2d(0.1, 0.2),     0.3, 0.9, 0.8, 0.7, true,
                      FocalHint{1234.5, 67.8},    V2d(-3.5, 1 / 3.0)};
    r.display = {1920, 1080};
    r.camera.focal = 1000.0 / 3;
    r.camera.principal = V2d(960, 540);
    r.camera.distortion = {0.1, -0.2, 0};
    r.distance = 12.5;
    r.seconds = 0.25;
    r.message = "\"quoted\"\nin two lines";
    return r;
}

TEST(Records, ComeBackFromTheirLinesExactly) {
    const TrackRecord r = full_record();
    const std::string line = to_line(r);
    EXPECT_EQ(line.find('\n'), line.size() - 1);
    const auto back = track_record_from(line);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->frame, r.frame);
    EXPECT_EQ(back->ball, r.ball);
    EXPECT_EQ(back->camera.focal, r.camera.focal);
    EXPECT_EQ(back->camera.distortion.k2, r.camera.distortion.k2);
    EXPECT_EQ(back->message, r.message);
    EXPECT_EQ(to_line(*back), line);

    SolvedFrame f;
    f.frame = 3;
    f.outcome = FrameOutcome::held;
    f.outline = Outline{1.0 / 3, 2, 3, 2, 1};
    f.piece = 2;
    f.lens_blur = 0.1;
    ASSERT_TRUE(solved_frame_from(to_line(f)));
    EXPECT_EQ(solved_frame_from(to_line(f))->outline, f.outline);
    EXPECT_EQ(to_line(*solved_frame_from(to_line(f))), to_line(f));

    for (const SolveHead& head : {SolveHead{"xyz", 1e-4}, SolveHead{"xyz", 1e-4, 1000.0 / 3}})
        EXPECT_EQ(solve_head_from(to_line(head)), head);
    const ConvertRecord c{5, "s", true, 0.5, "m"};
    EXPECT_EQ(to_line(convert_record_from(to_line(c)).value()), to_line(c));
}

TEST(Records, DoNotComeFromDamagedOrForeignLines) {
    const std::string line = to_line(full_record());
    for (std::size_t length = 0; length + 2 < line.size(); length += 7)
        EXPECT_FALSE(track_record_from(line.substr(0, length))) << length;
    EXPECT_FALSE(convert_record_from(line));
    std::string other = line;
    other.replace(other.find("\"v\":1"), 5, "\"v\":9");
    EXPECT_FALSE(track_record_from(other));
    std::string wrong = line;
    wrong.replace(wrong.find("1010"), 4, "\"a\" ");
    EXPECT_FALSE(track_record_from(wrong));
    EXPECT_FALSE(track_record_from("[]"));
    EXPECT_FALSE(track_record_from("\xff\xfe"));
}

TEST(Records, OfATornLastLineAreNone) {
    int count = 0;
    for_each_line("a\nb\ntorn", [&](std::string_view line) { count += line.size() == 1; });
    EXPECT_EQ(count, 2);
}

TEST(Hash, TellsTextsApart) {
    EXPECT_EQ(hash_of("abc").size(), 16U);
    EXPECT_EQ(hash_of(""), "cbf29ce484222325");  // FNV-1a's own start
    EXPECT_EQ(hash_of("a"), "af63dc4c8601ec8c");
    EXPECT_NE(hash_of("ab"), hash_of("ba"));
}

TEST(Cameras, AreReadFrameByFrame) {
    const auto cameras = cameras_from(
        R"({"frames": {"1001": {"camera_to_world": [0,0,1,0,1,0,-1,0,0], "focal_px": 1200,
            "principal": [960, 540]}, "1002": {}}})",
        "c.json");
    ASSERT_EQ(cameras.size(), 2U);
    EXPECT_EQ(cameras.at(1001).focal, 1200);
    EXPECT_EQ(cameras.at(1001).principal, V2d(960, 540));
    EXPECT_EQ(cameras.at(1001).to_world->at(0, 2), 1);
    EXPECT_FALSE(cameras.at(1002).focal);
}

TEST(Cameras, ThatAreWrongAreNamed) {
    const std::pair<const char*, const char*> cases[] = {
        {"", "holds no object"},
        {"{\"frames\": []}", "holds no object"},
        {"{\"frames\": {\"x\": {}}}", "\"x\" is no frame number"},
        {"{\"frames\": {\"7\": {\"focal_px\": -1}}}", "frame 7: its focal_px must be above 0"},
        {"{\"frames\": {\"7\": {\"focal_px\": \"a\"}}}", "frame 7 holds something else"},
        {"{\"frames\": {\"7\": {\"principal\": [1]}}}", "frame 7: its principal"},
        {"{\"frames\": {\"7\": {\"camera_to_world\": [1,0,0,0,1,0,0,0,-1]}}}", "is no rotation"},
        {"{\"frames\": {\"7\": 3}}", ""},
    };
    for (const auto& [text, said] : cases) try {
            const auto cameras = cameras_from(text, "c.json");
            if (*said) ADD_FAILURE() << text;
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), Error::Kind::usage);
            EXPECT_NE(std::string(e.what()).find(said), std::string::npos) << e.what();
        }
}

}  // namespace
}  // namespace chromeball
