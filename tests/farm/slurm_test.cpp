#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <thread>

#include "cli/program.h"
#include "cli/world.h"
#include "run_program.h"
#include "shot/farm.h"

// Jobs on a real Slurm: the one that with_slurm.sh starts for these tests, never another.

namespace chromeball::test {
namespace {

bool within(double seconds, const std::function<bool()>& true_at_last) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (Clock::now() < end) {
        if (true_at_last()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
}

class OnSlurm : public ::testing::Test {
protected:
    void SetUp() override {
        if (!std::getenv("CHROMEBALL_TEST_SLURM")) GTEST_SKIP() << "runs beside with_slurm.sh only";
    }
    void wait_for_all_jobs() {
        const bool ended = within(150, [this] {
            return run_other(folder_, {"squeue", "--noheader"}).out.empty();
        });
        ASSERT_TRUE(ended) << run_other(folder_, {"squeue"}).out;
    }
    /// What the tasks of a shot said, for when they fail.
    std::string logs(const std::string& folder) {
        return run_other(folder_, {"sh", "-c", "tail -n +1 \"$0\"/*.log", folder}).out;
    }
    TempFolder folder_;
};

/// Thirty-two frames of a ball, in both folders: a photo, in front of which the frame wanders.
void cut_plates(const std::string& folder, const std::string& other) {
    const Image photo = shrunk(read_floats(CHROMEBALL_DATA "/photos/interior.jpg"), 3);
    for (int i = 0; i < 32; ++i) {
        const int left = 20 + static_cast<int>(15 * std::sin(i / 9.0));
        const int top = 10 + static_cast<int>(8 * std::cos(i / 7.0));
        Image plate({photo.width() - 40, photo.height() - 20}, 3);
        for (int y = 0; y < plate.height(); ++y)
            std::copy_n(photo.pixel(left, top + y), plate.width() * 3, plate.row(y));
        const std::string name = "/plates/p." + std::to_string(1001 + i) + ".png";
        write_encoded(folder + name, plate);
        std::filesystem::copy_file(folder + name, other + name);
    }
}

std::size_t lines_of(const std::string& file) {
    const std::string text = read_bytes(file);
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(OnSlurm, AShotWithAKilledTaskGetsTheBytesOfALocalRun) {
    const std::string here = folder_ / "here", there = folder_ / "there";
    for (const std::string& folder : {here, there})
        for (const char* part : {"/plates", "/probes"})
            std::filesystem::create_directories(folder + part);
    cut_plates(here, there);
    // The same words in both places, for the maps' metadata hold paths as typed.
    const auto shot = [&](const std::string& folder, const std::string& more) {
        return run_other(folder_,
                         {"sh", "-c",
                          "cd '" + folder +
                              "' && exec '" CHROMEBALL_PROGRAM "' shot 'plates/p.####.png' "
                              "-o 'probes/p.####.exr' --focal-px 900 --size 32 " +
                              more});
    };
    const Outcome local = shot(here, "--quiet");
    ASSERT_EQ(local.status, 0) << local.err;

    const std::string to_farm = "--farm slurm --chunk 16 --report shot.json";
    const Outcome first = shot(there, to_farm);
    ASSERT_EQ(first.status, 0) << first.err;
    const std::string number = first.out.substr(6, first.out.find(' ', 6) - 6);
    ASSERT_TRUE(first.out.starts_with("track ")) << first.out;
    // Its second task, when it has tracked its key frame.
    const std::string work = there + "/probes/.chromeball/p.exr";
    const std::string file = work + "/track/1008-1023.jsonl";
    ASSERT_TRUE(within(30, [&] { return lines_of(file) > 0; }))
        << logs(work + "/farm") << text_of(folder_.content());
    run_other(folder_, {"scancel", "--signal=KILL", "--full", number + "_1"});
    ASSERT_NO_FATAL_FAILURE(wait_for_all_jobs());
    EXPECT_LT(lines_of(file), 16u) << "it was killed too late to tell anything";
    EXPECT_TRUE(exists(there + "/probes/p.1032.exr")) << logs(work + "/farm");
    const Outcome status = shot(there, "--status '" + work + "'");
    EXPECT_EQ(status.out.find("track    32 of 32"), std::string::npos) << status.out;
    EXPECT_NE(read_bytes(there + "/shot.json").find("not tracked yet"), std::string::npos);

    ASSERT_EQ(shot(there, to_farm).status, 0);
    ASSERT_NO_FATAL_FAILURE(wait_for_all_jobs());
    EXPECT_EQ(run_other(folder_, {"diff", "-r", "--exclude=.chromeball", here + "/probes",
                                  there + "/probes"})
                  .out,
              "")
        << logs(work + "/farm");
    const Outcome done = shot(there, "--status '" + work + "'");
    EXPECT_NE(done.out.find("track    32 of 32 frames: 32 with a ball"), std::string::npos)
        << done.out;
    EXPECT_NE(done.out.find("convert  32 of 32 frames written, 0 failed"), std::string::npos);
    if (const char* keep = std::getenv("CHROMEBALL_KEEP_LOGS"))
        write_bytes(keep, first.out + status.out + done.out + logs(work + "/farm"));
}

TEST_F(OnSlurm, AFailedSolveLeavesNothingWaiting) {
    FarmShot shot;
    shot.program = folder_ / "a shot's program";
    write_bytes(shot.program,
                "#!/bin/sh\ncase \"$*\" in *solve*) exit 1 ;; esac\necho \"$@\" >>done\n");
    ::chmod(shot.program.c_str(), 0755);
    shot.words = {"shot", "plates/a b.####.exr"};
    shot.frames = {1001, 1002, 1020};
    shot.chunk = 2;
    shot.folder = folder_.path();
    shot.logs = folder_ / "logs of 100%";
    std::filesystem::create_directory(shot.logs);
    const FarmKind& slurm = farm_kind("slurm");
    submit(slurm, shot, farm_jobs(slurm, shot), run_program);
    ASSERT_NO_FATAL_FAILURE(wait_for_all_jobs());
    const std::string done = read_bytes(folder_ / "done");
    EXPECT_NE(done.find("plates/a b.####.exr --farm none --stage track --jobs 1 --frames 1020"),
              std::string::npos)
        << done;
    EXPECT_EQ(done.find("--stage convert"), std::string::npos) << "there is nothing to convert by";
    EXPECT_NE(done.find("--stage report"), std::string::npos) << "somebody must tell";
    EXPECT_NE(run_other(folder_, {"ls", shot.logs}).out.find("chromeball-track."),
              std::string::npos);
}

}  // namespace
}  // namespace chromeball::test
