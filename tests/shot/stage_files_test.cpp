#include "shot/stage_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numeric>

namespace chromeball {
namespace {

namespace fs = std::filesystem;

Frames from_to(int first, int last, int step = 1) {
    Frames frames;
    for (int n = first; n <= last; n += step) frames.push_back(n);
    return frames;
}

TEST(StageFiles, AreNamedByTheirFrames) {
    EXPECT_EQ(stage_file_name({7}), "7.jsonl");
    EXPECT_EQ(stage_file_name(from_to(1001, 1024)), "1001-1024.jsonl");
    EXPECT_EQ(stage_file_name({1, 2, 5, 9}), "1-2,5,9.jsonl");
    const std::string even = stage_file_name(from_to(1000, 1998, 2));
    EXPECT_LT(even.size(), 80U);
    EXPECT_TRUE(even.starts_with("1000-1998-")) << even;
    EXPECT_NE(even, stage_file_name(from_to(1000, 1998, 1)));
    Frames other = from_to(1000, 1998, 2);
    other[5] += 1;
    EXPECT_NE(even, stage_file_name(other));
}

TEST(StageFiles, MayHoldTheFramesOfTheirRunAndOfItsBlocks) {
    const Frames runs[] = {{7},           from_to(1001, 1024), {1, 2, 5, 9},
                           {5, 900, 901}, {100, 200, 300},     from_to(1000, 1998, 2)};
    for (const Frames& run : runs) {
        const std::string name = stage_file_name(run);
        for (const int frame : run) EXPECT_TRUE(may_hold(name, {frame})) << name << " " << frame;
        // The key frames of its frames, and what has those key frames.
        EXPECT_TRUE(may_hold(name, {run.front() / 16 * 16})) << name;
        EXPECT_TRUE(may_hold(name, {run.back() / 16 * 16 + 16})) << name;
        EXPECT_TRUE(may_hold(name, {run.back() / 16 * 16 + 31})) << name;
        EXPECT_FALSE(may_hold(name, {run.front() / 16 * 16 - 17})) << name;
        EXPECT_FALSE(may_hold(name, {run.back() / 16 * 16 + 32})) << name;
        EXPECT_TRUE(may_hold(name, from_to(0, 5000))) << name;
    }
    EXPECT_FALSE(may_hold("100-140.jsonl", {10, 70, 300, 400}));
    EXPECT_TRUE(may_hold("100-140.jsonl", {10, 120, 400}));
    EXPECT_TRUE(may_hold("by hand.jsonl", {10}));
    EXPECT_TRUE(may_hold("12-x.jsonl", {1000}));
    EXPECT_TRUE(may_hold("90-5.jsonl", {1000}));
}

TEST(StageFiles, AreListedByNameAndByWhatTheyMayHold) {
    const fs::path folder = fs::path(testing::TempDir()) / "chromeball_stage_files";
    fs::remove_all(folder);
    EXPECT_TRUE(stage_files(folder.string()).empty());
    fs::create_directory(folder);
    for (const char* name : {"133-140.jsonl", "1-16.jsonl", "101-120.jsonl", "note.txt"})
        std::ofstream(folder / name) << "x";
    const auto names = [](const std::vector<std::string>& files) {
        std::vector<std::string> all;
        for (const std::string& file : files) all.push_back(fs::path(file).filename().string());
        return all;
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(names(stage_files(folder.string())),
              (Names{"1-16.jsonl", "101-120.jsonl", "133-140.jsonl"}));
    EXPECT_EQ(names(stage_files(folder.string(), {134, 135})),
              (Names{"101-120.jsonl", "133-140.jsonl"}));
    EXPECT_EQ(names(stage_files(folder.string(), {3})), Names{"1-16.jsonl"});
    EXPECT_TRUE(stage_files(folder.string(), {300}).empty());
    fs::remove_all(folder);
}

}  // namespace
}  // namespace chromeball
