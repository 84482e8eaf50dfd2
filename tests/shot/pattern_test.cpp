#include "shot/pattern.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>

#include "core/error.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

FramePattern pattern(const char* text) { return FramePattern::parse(text).value(); }

TEST(Pattern, KnowsTheWaysToWriteANumber) {
    EXPECT_EQ(pattern("a.####.exr").path(7), "a.0007.exr");
    EXPECT_EQ(pattern("a.%04d.exr").path(7), "a.0007.exr");
    EXPECT_EQ(pattern("a.%d.exr").path(7), "a.7.exr");
    EXPECT_EQ(pattern("a.$F4.exr").path(7), "a.0007.exr");
    EXPECT_EQ(pattern("a.$F.exr").path(7), "a.7.exr");
    EXPECT_EQ(pattern("a.@.exr").path(7), "a.7.exr");
    EXPECT_EQ(pattern("a.@@@.exr").path(7), "a.007.exr");
    EXPECT_EQ(pattern("a.##.exr").path(1234), "a.1234.exr");
    EXPECT_EQ(pattern("sh.####/px").path(12), "sh.0012/px");
    EXPECT_EQ(pattern("####/a.####.exr").path(12), "0012/a.0012.exr");
}

TEST(Pattern, TakesTheFirstKindAndLeavesOtherLettersAlone) {
    EXPECT_EQ(pattern("me@home/a#1.%04d.exr").path(5), "me@home/a#1.0005.exr");
    EXPECT_EQ(pattern("me@home/a.####.exr").path(5), "me@home/a.0005.exr");
    EXPECT_EQ(pattern("50%/a.####.exr").path(5), "50%/a.0005.exr");
    EXPECT_FALSE(FramePattern::parse("plate.1001.exr"));
    EXPECT_FALSE(FramePattern::parse(""));
}

TEST(Pattern, ReadsTheNumberBackFromItsOwnPathsOnly) {
    const auto four = pattern("a.####.exr");
    EXPECT_EQ(four.frame_of("a.0042.exr"), 42);
    EXPECT_EQ(four.frame_of("a.12345.exr"), 12345);
    for (const char* other : {"a.42.exr", "a.00042.exr", "a.0042.exr.part", "b.0042.exr",
                              "a.-042.exr", "a..exr", "a.", "", "a.99999999999999.exr"})
        EXPECT_FALSE(four.frame_of(other)) << other;
    EXPECT_EQ(pattern("####/a.####.exr").frame_of("0042/a.0042.exr"), 42);
    EXPECT_FALSE(pattern("####/a.####.exr").frame_of("0042/a.0043.exr"));
}

TEST(Pattern, KnowsItsFolderAndName) {
    EXPECT_EQ(pattern("probes/sh010.####.exr").folder(), "probes");
    EXPECT_EQ(pattern("probes/sh010.####.exr").name(), "sh010.exr");
    EXPECT_EQ(pattern("sh010.####.exr").folder(), ".");
    EXPECT_EQ(pattern("sh010.####.exr").name(), "sh010.exr");
    EXPECT_EQ(pattern("./sh010.####.exr").name(), "sh010.exr");
    EXPECT_EQ(pattern("/####.exr").folder(), "/");
    EXPECT_EQ(pattern("probes/####/env.exr").folder(), "probes");
    EXPECT_EQ(pattern("probes/####/env.exr").name(), "_env.exr");
    EXPECT_EQ(pattern("probes/sh.####").name(), "sh");
    EXPECT_EQ(pattern("####").name(), "shot");
}

TEST(Pattern, FindsItsFilesOnDisk) {
    const fs::path folder = fs::temp_directory_path() / ("pattern" + std::to_string(::getpid()));
    fs::create_directories(folder / "0003");
    fs::create_directories(folder / "0004");
    for (const char* name : {"a.1002.exr", "a.1001.exr", "a.1001.exr.part", "a.99.exr",
                             ".a.1003.exr.part", "0003/b.exr", "0004/other.exr"})
        std::ofstream(folder / name) << "x";
    const std::string top = folder.string();
    EXPECT_EQ(pattern((top + "/a.####.exr").c_str()).on_disk(), Frames({1001, 1002}));
    EXPECT_EQ(pattern((top + "/a.@.exr").c_str()).on_disk(), Frames({99, 1001, 1002}));
    EXPECT_EQ(pattern((top + "/####/b.exr").c_str()).on_disk(), Frames({3}));
    EXPECT_EQ(pattern((top + "/c.####.exr").c_str()).on_disk(), Frames());
    EXPECT_THROW(pattern((top + "/none/a.####.exr").c_str()).on_disk(), Error);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace chromeball
