#include "shot/status.h"

#include <gtest/gtest.h>

namespace chromeball::test {
namespace {

std::string tracked(int frame, bool readable, bool found, const std::string& message = "") {
    TrackRecord record;
    record.frame = frame;
    record.readable = readable;
    if (found) record.ball = Sighting{.outline = {1, 2, 3, 3, 0}, .sure = true};
    record.message = message;
    return to_line(record);
}

std::string solved(int frame, FrameOutcome outcome) {
    SolvedFrame record;
    record.frame = frame;
    record.outcome = outcome;
    record.flagged = outcome != FrameOutcome::found;
    return to_line(record);
}

std::string converted(int frame, bool written, const std::string& message = "") {
    ConvertRecord record;
    record.frame = frame;
    record.written = written;
    record.message = message;
    return to_line(record);
}

TEST(ShotStatus, OfAShotThatHasNotBegun) {
    EXPECT_EQ(ShotStatus().text(),
              "track    0 frames: 0 with a ball, 0 without, 0 unreadable\n"
              "solve    not done\nconvert  0 frames written, 0 failed\n");
}

TEST(ShotStatus, CountsEachFrameOnceByItsLastRecord) {
    ShotStatus status;
    status.add(tracked(1, true, true) + tracked(2, false, false, "the file ends early"));
    status.add(tracked(3, true, false) + tracked(4, false, false) + tracked(1, true, true));
    status.add(tracked(4, true, true));
    status.add(to_line(SolveHead{}) + solved(1, FrameOutcome::found) +
               solved(2, FrameOutcome::failed) + solved(3, FrameOutcome::held) +
               solved(4, FrameOutcome::found));
    status.add(converted(1, false, "disk full") + converted(4, true) + converted(1, true) +
               converted(3, false));
    EXPECT_EQ(status.text(),
              "track    4 of 4 frames: 2 with a ball, 1 without, 1 unreadable\n"
              "solve    4 frames: 2 found, 0 filled, 1 held, 0 missing, 1 failed, 2 flagged\n"
              "convert  2 of 4 frames written, 1 failed\n"
              "failed   2: the file ends early\n"
              "failed   3: cannot be written\n");
}

TEST(ShotStatus, PassesOverWhatIsNoRecord) {
    ShotStatus status;
    const std::string line = tracked(7, true, true);
    status.add("rubbish\n{\"v\":99}\n" + line + line.substr(0, line.size() / 2));
    EXPECT_NE(status.text().find("track    1 frames: 1 with a ball"), std::string::npos);
}

TEST(ShotStatus, TellsFiftyFailuresAndCountsTheRest) {
    ShotStatus status;
    for (int frame = 1; frame <= 60; ++frame) status.add(tracked(frame, false, false));
    EXPECT_NE(status.text().find("failed   50: "), std::string::npos);
    EXPECT_EQ(status.text().find("failed   51: "), std::string::npos);
    EXPECT_NE(status.text().find("and 10 more"), std::string::npos);
}

}  // namespace
}  // namespace chromeball::test
