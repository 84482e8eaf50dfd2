#include "shot/frames.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"

namespace chromeball {
namespace {

TEST(Frames, AreReadFromNumbersRangesStepsAndLists) {
    EXPECT_EQ(parse_frames("7"), Frames({7}));
    EXPECT_EQ(parse_frames("1001-1004"), Frames({1001, 1002, 1003, 1004}));
    EXPECT_EQ(parse_frames("1001-1006x2"), Frames({1001, 1003, 1005}));
    EXPECT_EQ(parse_frames("9-12,1,5,10"), Frames({1, 5, 9, 10, 11, 12}));
    EXPECT_EQ(parse_frames("0"), Frames({0}));
}

TEST(Frames, ThatCannotBeReadAreNamed) {
    const std::pair<const char*, const char*> cases[] = {
        {"", "begins with no frame number"},
        {"x", "\"x\" begins with no frame number"},
        {"1001-x", "expected a number after \"1001-\""},
        {"1001-1010x0", "a step of at least 1"},
        {"1001-1010x", "a step of at least 1"},
        {"10-1", "10 comes after 1"},
        {"1,", "begins with no frame number"},
        {"1 2", "was not expected behind a frame number"},
        {"-5", "begins with no frame number"},
        {"99999999999", "begins with no frame number"},
        {"0-2000000000", "more than"},
    };
    for (const auto& [text, said] : cases) try {
            parse_frames(text);
            ADD_FAILURE() << text;
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), Error::Kind::usage);
            EXPECT_NE(std::string(e.what()).find(said), std::string::npos) << e.what();
        }
}

TEST(Frames, AreWrittenAsShortAsTheyCanBeReadAgain) {
    for (const char* text : {"1001-1048", "1,5,9-12", "7", "1-2"}) {
        EXPECT_EQ(text_of(parse_frames(text)), text);
    }
    EXPECT_EQ(text_of({}), "");
    EXPECT_EQ(gaps_in({1, 2, 5, 7}), Frames({3, 4, 6}));
    EXPECT_EQ(gaps_in({}), Frames());
}

TEST(KeyFrame, IsTheMultipleOf16BelowOrTheFirstThere) {
    const std::set<int> there = {1001, 1002, 1008, 1010, 1030, 1040};
    const auto key = [&](int frame) {
        return key_frame(frame, [&](int n) { return there.contains(n); });
    };
    EXPECT_EQ(key(1001), 1001);  // 992 to 1000 are not there
    EXPECT_EQ(key(1002), 1001);
    EXPECT_EQ(key(1008), 1008);  // a multiple
    EXPECT_EQ(key(1010), 1008);
    EXPECT_EQ(key(1030), 1030);  // 1024 is not there
    EXPECT_EQ(key(1031), 1030);  // itself is taken to be there
    EXPECT_EQ(key(1041), 1040);
}

TEST(KeyFrame, OfTheNextBlockIsTheFirstThere) {
    const std::set<int> there = {1001, 1008, 1030, 1050};
    const auto next = [&](int frame) {
        return next_key_frame(frame, [&](int n) { return there.contains(n); });
    };
    EXPECT_EQ(next(1001), 1008);
    EXPECT_EQ(next(1007), 1008);
    EXPECT_EQ(next(1008), 1030);
    EXPECT_EQ(next(1023), 1030);
    EXPECT_EQ(next(1024), 1050);  // 1040 is not there
    EXPECT_FALSE(next(1040));     // of the block of 1056 nothing is
    EXPECT_EQ(next(980), 1001);   // of the block of 992
    EXPECT_FALSE(next(970));
}

TEST(KeyFrame, OfTheBlockBeforeIsTheFirstThere) {
    const std::set<int> there = {1001, 1008, 1030, 1050};
    const auto previous = [&](int frame) {
        return previous_key_frame(frame, [&](int n) { return there.contains(n); });
    };
    EXPECT_EQ(previous(1008), 1001);
    EXPECT_EQ(previous(1030), 1008);
    EXPECT_EQ(previous(1041), 1030);  // 1024 is not there
    EXPECT_FALSE(previous(1001));
    EXPECT_FALSE(previous(1075));  // of the block of 1056 nothing is
}

}  // namespace
}  // namespace chromeball
