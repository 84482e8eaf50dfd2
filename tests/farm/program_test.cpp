#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "cli/program.h"

// `chromeball shot` with a farm whose submitting program is made up.

namespace chromeball::test {
namespace {

class ShotOnAFarm : public ::testing::Test {
protected:
    ShotOnAFarm() {
        std::filesystem::create_directory(folder_ / "probes");
        // Writes down its words, a line each submission, and keeps the scripts.
        write_bytes(folder_ / "sbatch",
                    "#!/bin/sh\necho \"$@\" >>words\nn=$(wc -l <words)\ncat >script.$n\n"
                    "echo \"$n;here\"\n");
        ::chmod((folder_ / "sbatch").c_str(), 0755);
    }
    Outcome shot(Words more) {
        Words words{"shot", "plates/p.####.exr", "-o", "probes/p.####.exr"};
        words.insert(words.end(), more.begin(), more.end());
        words.insert(words.begin(), {"env", path(), CHROMEBALL_PROGRAM});
        return run_other(folder_, words);
    }
    /// The made-up program comes first.
    std::string path() const { return "PATH=" + folder_.path() + ":/usr/bin:/bin"; }
    TempFolder folder_;
};

TEST_F(ShotOnAFarm, SubmitsItsStagesAndTellsTheJobs) {
    const Outcome outcome =
        shot({"--frames", "1001-1040", "--jobs", "2", "--farm", "slurm", "--chunk", "16",
              "--farm-option=--mem=2G", "--farm-option", "--partition=main"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "track 1 (4 tasks)\nsolve 2\nconvert 3 (4 tasks)\nreport 4\n");
    EXPECT_TRUE(outcome.says("--status")) << outcome.err;
    const std::string words = read_bytes(folder_ / "words");
    EXPECT_NE(words.find("--array=0-3 --mem=2G --partition=main\n"), std::string::npos) << words;
    EXPECT_NE(words.find("--cpus-per-task=2"), std::string::npos);
    EXPECT_NE(read_bytes(folder_ / "script.1").find(" --jobs 2 --frames \"$frames\""),
              std::string::npos);
    EXPECT_TRUE(exists(folder_ / "probes/.chromeball/p.exr/farm"));
}

TEST_F(ShotOnAFarm, PrintsAScriptInADryRunAndSubmitsNothing) {
    const Outcome outcome = shot({"--frames", "1001-1040", "--farm", "slurm", "--farm-dry-run"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.out.starts_with("#!/bin/sh\n"));
    EXPECT_FALSE(exists(folder_ / "words"));
}

TEST_F(ShotOnAFarm, SaysWhatIsWrong) {
    const Words farm{"--frames", "1", "--farm", "slurm"};
    const auto with = [&](Words more) {
        more.insert(more.begin(), farm.begin(), farm.end());
        return shot(more);
    };
    const Outcome both = with({"--stage", "track"});
    EXPECT_EQ(both.status, 2);
    EXPECT_TRUE(both.says("--stage")) << both.err;
    EXPECT_EQ(with({"--chunk", "0"}).status, 2);
    EXPECT_EQ(shot({"--farm", "slrum"}).status, 2);
    write_bytes(folder_ / "sbatch", "#!/bin/sh\necho 'no such partition' >&2\nexit 1\n");
    const Outcome refused = with({});
    EXPECT_EQ(refused.status, 1);
    EXPECT_TRUE(refused.says("no such partition")) << refused.err;
}

TEST_F(ShotOnAFarm, IsNotSubmittedAgainByATaskWhoseSettingsFileNamesTheFarm) {
    write_bytes(folder_ / "settings.toml", "[shot]\nfarm = \"slurm\"\nframes = \"1001-1003\"\n");
    const Outcome outcome = shot({"--config", "settings.toml"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string script = read_bytes(folder_ / "script.1");
    ASSERT_NE(script.find("--config settings.toml"), std::string::npos);
    std::filesystem::remove(folder_ / "words");
    write_bytes(folder_ / "task", script);
    const Outcome task = run_other(folder_, {"env", path(), "SLURM_ARRAY_TASK_ID=0", "sh", "task"});
    EXPECT_EQ(task.status, 0) << task.err;
    EXPECT_FALSE(exists(folder_ / "words")) << "it submitted once more";
    EXPECT_TRUE(exists(folder_ / "probes/.chromeball/p.exr/track/1001-1003.jsonl"));
    const Outcome status = run(folder_, {"shot", "--status", "probes/.chromeball/p.exr"});
    EXPECT_EQ(status.status, 0) << status.err;
    EXPECT_NE(status.out.find("track    3 frames: 0 with a ball, 0 without, 3 unreadable"),
              std::string::npos)
        << status.out;
    EXPECT_NE(status.out.find("failed   1002: no such file"), std::string::npos);
    EXPECT_EQ(run(folder_, {"shot", "--status", "probes"}).status, 1);
}

}  // namespace
}  // namespace chromeball::test
