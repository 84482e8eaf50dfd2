#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <thread>

#include "cli/program.h"
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
        const bool ended = within(60, [this] {
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

/// Does as shot does, in the large: frames are tracked, a solve sees all of them, probes depend on
/// it; what is whole and of the same solve is not done again. Tracking waits for its end at frame
/// 1050 where a file `wait` lies.
constexpr std::string_view kShotInTheLarge = R"sh(#!/bin/sh
stage= frames= failed=0
while [ $# -gt 0 ]; do
    case $1 in
        --stage) stage=$2; shift ;;
        --frames) frames=$2; shift ;;
    esac
    shift
done
mkdir -p track probes
write() { cat >"$1.$$.part" && mv "$1.$$.part" "$1"; }
numbers() { echo "$frames" | tr , '\n' | while IFS=- read -r a b; do seq "$a" "${b:-$a}"; done; }
case $stage in
    track)
        for f in $(numbers); do
            if [ "$f" = 1050 ] && [ -e wait ]; then : >waiting; exec sleep 100; fi
            [ -e "track/$f" ] || echo "seen $f" | write "track/$f"
        done ;;
    solve)
        for f in $(numbers); do cat "track/$f" 2>/dev/null || echo "unseen $f"; done | write solved
        ! grep -q unseen solved || failed=3 ;;
    convert)
        sum=$(cksum <solved)
        for f in $(numbers); do
            probe="probe $f of $sum"
            [ "$(cat "probes/$f" 2>/dev/null)" = "$probe" ] || echo "$probe" | write "probes/$f"
        done ;;
    report) for f in $(numbers); do cat "probes/$f"; done | write report ;;
esac
exit $failed
)sh";

struct LargeShot {
    explicit LargeShot(const std::string& folder) {
        std::system(("mkdir -p '" + folder + "/logs of it'").c_str());
        shot.program = folder + "/a shot's program";
        write_bytes(shot.program, kShotInTheLarge);
        ::chmod(shot.program.c_str(), 0755);
        shot.words = {"shot", "plates/a b.####.exr"};
        shot.frames.resize(100);
        std::iota(shot.frames.begin(), shot.frames.end(), 1001);
        shot.chunk = 32;
        shot.folder = folder;
        shot.logs = folder + "/logs of it";
    }
    std::vector<std::string> submit() const {
        const FarmKind& slurm = farm_kind("slurm");
        return chromeball::submit(slurm, shot, farm_jobs(slurm, shot), run_program);
    }
    FarmShot shot;
};

TEST_F(OnSlurm, AKilledTaskStopsNobodyElseAndTheNextSubmissionMendsIt) {
    const std::string here = folder_ / "here", there = folder_ / "there";
    const LargeShot local(here), far(there);
    for (const char* stage : {"track", "solve", "convert", "report"})
        ASSERT_EQ(run_other(folder_, {"sh", "-c",
                                      "cd here && './a shot'\\''s program' --stage " +
                                          std::string(stage) + " --frames 1001-1100"})
                      .status,
                  0);

    write_bytes(there + "/wait", "");
    const auto numbers = far.submit();
    ASSERT_TRUE(within(30, [&] { return exists(there + "/waiting"); })) << logs(far.shot.logs);
    // 1050 is of the second chunk: the task of index 1.
    const Outcome killed =
        run_other(folder_, {"scancel", "--signal=KILL", "--full", numbers[0] + "_1"});
    EXPECT_EQ(killed.status, 0) << killed.err;
    ASSERT_NO_FATAL_FAILURE(wait_for_all_jobs());
    EXPECT_TRUE(exists(there + "/track/1049")) << "what the task had done stays";
    EXPECT_FALSE(exists(there + "/track/1050"));
    EXPECT_TRUE(exists(there + "/track/1100")) << logs(far.shot.logs);
    EXPECT_TRUE(exists(there + "/probes/1100")) << "the others went on";
    EXPECT_TRUE(exists(there + "/report")) << logs(far.shot.logs);

    run_other(folder_, {"rm", there + "/wait"});
    far.submit();
    ASSERT_NO_FATAL_FAILURE(wait_for_all_jobs());
    for (const char* name : {"/track", "/probes", "/solved", "/report"})
        EXPECT_EQ(run_other(folder_, {"diff", "-r", here + name, there + name}).out, "") << name;
}

TEST_F(OnSlurm, AFailedSolveLeavesNothingWaiting) {
    const std::string there = folder_ / "there";
    LargeShot far(there);
    write_bytes(far.shot.program,
                "#!/bin/sh\ncase \"$*\" in *solve*) exit 1 ;; esac\n"
                "echo \"$@\" >>done\n");
    far.submit();
    ASSERT_NO_FATAL_FAILURE(wait_for_all_jobs());
    const std::string done = read_bytes(there + "/done");
    EXPECT_NE(done.find("--stage track"), std::string::npos);
    EXPECT_EQ(done.find("--stage convert"), std::string::npos) << "there is nothing to convert by";
    EXPECT_NE(done.find("--stage report"), std::string::npos) << "somebody must tell";
}

}  // namespace
}  // namespace chromeball::test
