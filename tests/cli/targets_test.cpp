#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <thread>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"

// Where results go: targets that cannot be written, and runs that end before their time.

namespace chromeball {
namespace {

using namespace test;
namespace fs = std::filesystem;

/// A folder with a map to convert.
class Targets : public testing::Test {
protected:
    Targets() { write_exr(folder / "world.exr", world_map(*find_layout("latlong"), 32)); }

    Words to(const std::string& target, const Words& more = {}) const {
        Words words{"convert", "world.exr", "--from", "latlong", "-o", target};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }

    TempFolder folder;
};

TEST_F(Targets, AMissingFolderIsNotMadeButNamed) {
    expect_refusal(folder, to("gone/map.exr"), 1, {"gone/map.exr", "no folder gone", "make it"});
    expect_refusal(folder, to("gone/faces", {"--layout", "faces"}), 1,
                   {"gone/faces", "no folder gone", "make it"});
}

TEST_F(Targets, AFileIsNoFolderToWriteTo) {
    write_bytes(folder / "notes", "precious");
    expect_refusal(folder, to("notes/map.exr"), 1, {"notes/map.exr", "notes is a file"});
    expect_refusal(folder, to("notes", {"--layout", "faces"}), 1, {"notes", "is a file"});
}

TEST_F(Targets, AFolderIsNoFileToWriteTo) {
    fs::create_directory(folder / "probe.exr");
    expect_refusal(folder, to("probe.exr"), 1, {"probe.exr", "is a folder"});
    fs::create_directory(folder / "faces");
    fs::create_directory(folder / "faces/px.exr");
    expect_refusal(folder, to("faces", {"--layout", "faces"}), 1, {"px.exr", "is a folder"});
}

TEST_F(Targets, WhereNothingCanBeWrittenIsToldBeforeTheWork) {
    // Permissions do not stop root; the kernel's own file system does.
    expect_refusal(folder, to("/proc/map.exr"), 1, {"/proc/map.exr", "cannot be written"});
    expect_refusal(folder, to("/dev/null/map.exr"), 1, {"/dev/null/map.exr"});
    const Outcome outcome =
        run(folder, {"convert", "missing.exr", "--from", "latlong", "-o", "gone/map.exr"});
    EXPECT_TRUE(outcome.says("gone/map.exr")) << outcome.err;
}

TEST_F(Targets, TheInputIsNeverReplaced) {
    write_exr(folder / "photo.exr", ball_photo({64, 64}, distant_ball(32, 32, 28)));
    expect_refusals(folder, {{to("world.exr"), {"world.exr", "would replace the input"}, 2},
                             {to("./world.exr"), {"world.exr", "would replace the input"}, 2},
                             {{"convert", "photo.exr", "--ball", "32,32,28", "-o", "photo.exr"},
                              {"photo.exr", "would replace the input"},
                              2},
                             {{"detect", "photo.exr", "--crop", "photo.exr"},
                              {"photo.exr", "would replace the input"},
                              2},
                             {{"detect", "photo.exr", "world.exr", "--crop", "."},
                              {"photo.exr", "would replace the input"},
                              2}});
}

TEST_F(Targets, AnExistingResultIsReplacedByARerun) {
    write_bytes(folder / "map.exr", "old");
    ASSERT_EQ(run(folder, to("map.exr")).status, 0);
    EXPECT_EQ(read_floats(folder / "map.exr").height(), 64);
    EXPECT_EQ(folder.content(), (std::vector<std::string>{"map.exr", "world.exr"}));
}

/// A disk of 16 KB, where one may be mounted: in a namespace of this process alone.
class SmallDisk {
public:
    explicit SmallDisk(const std::string& place) : place_(place) {
        fs::create_directory(place);
        mounted_ = ::unshare(CLONE_NEWNS) == 0 &&
                   ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                   ::mount("small", place.c_str(), "tmpfs", 0, "size=16k") == 0;
    }
    ~SmallDisk() {
        if (mounted_) ::umount2(place_.c_str(), MNT_DETACH);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    bool mounted() const { return mounted_; }
    bool read_only() const {
        return ::mount("small", place_.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) == 0;
    }

private:
    std::string place_;
    bool mounted_ = false;
};

TEST_F(Targets, AFullDiskLeavesWhatWasThereAndNothingElse) {
    SmallDisk disk(folder / "disk");
    write_bytes(folder / "disk/map.exr", "precious");
    const Words words = to("disk/map.exr", {"--size", "128", "--float"});
    const Words faces = to("disk/faces", {"--size", "32", "--layout", "faces", "--float"});
    if (disk.mounted()) {
        std::cout << "a tmpfs of 16 KB is full\n";
        expect_refusal(folder, words, 1, {"disk/map.exr", "No space left", "make room"});
        expect_refusal(folder, faces, 1, {"disk/faces/", "No space left", "make room"});
    } else {
        std::cout << "no tmpfs can be mounted: the size of files is limited instead\n";
        Circumstances limited;
        limited.file_size_bytes = 12000;
        expect_refusal(folder, words, 1, {"disk/map.exr", "File too large", "limit"}, limited);
        expect_refusal(folder, faces, 1, {"disk/faces/", "File too large", "limit"}, limited);
    }
    EXPECT_EQ(read_bytes(folder / "disk/map.exr"), "precious");
}

TEST_F(Targets, AReadOnlyDiskIsTold) {
    SmallDisk disk(folder / "disk");
    if (!disk.mounted() || !disk.read_only()) GTEST_SKIP() << "nothing can be mounted";
    expect_refusal(folder, to("disk/map.exr"), 1, {"disk/map.exr", "Read-only"});
    expect_refusal(folder, to("disk/faces", {"--layout", "faces"}), 1, {"disk/faces", "Read-only"});
}

/// Waits until a run has said something, at most 20 s.
bool wait_for(Running& running, const std::string& text) {
    for (int i = 0; i < 2000; ++i) {
        if (running.said().find(text) != std::string::npos) return true;
        if (running.ended()) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

TEST_F(Targets, CtrlCInTheMiddleLeavesNothingAndIsStatus130) {
    write_bytes(folder / "map.exr", "precious");
    for (const int number : {SIGINT, SIGTERM}) {
        const auto before = folder.content();
        Running running(folder, to(number == SIGINT ? "map.exr" : "new.exr", {"--size", "2048"}));
        ASSERT_TRUE(wait_for(running, "25 %")) << running.wait().err;
        const auto start = std::chrono::steady_clock::now();
        running.signal(number);
        const Outcome outcome = running.wait();
        const auto took = std::chrono::steady_clock::now() - start;
        EXPECT_EQ(outcome.status, 130) << outcome.err;
        EXPECT_LT(took, std::chrono::seconds(3));
        EXPECT_EQ(outcome.lines_with("error: interrupted"), 1U) << outcome.err;
        EXPECT_EQ(folder.content(), before);
        EXPECT_EQ(read_bytes(folder / "map.exr"), "precious");
    }
}

TEST_F(Targets, CtrlCLeavesNoFolderOfFaces) {
    Running running(folder, to("faces", {"--layout", "faces", "--size", "1024"}));
    ASSERT_TRUE(wait_for(running, "25 %")) << running.wait().err;
    running.signal(SIGINT);
    EXPECT_EQ(running.wait().status, 130);
    EXPECT_EQ(folder.content(), std::vector<std::string>{"world.exr"});
}

TEST_F(Targets, AClosedOrFullStandardOutputIsStatusOne) {
    Circumstances closed, full;
    closed.stdout_closed = true;
    full.stdout_path = "/dev/full";
    const std::vector<Words> printing{
        {"info", "world.exr"}, {"detect", "world.exr"}, {"convert", "--help"}};
    for (const Words& words : printing) {
        EXPECT_EQ(run(folder, words, closed).status, 1) << text_of(words);
        const Outcome outcome = run(folder, words, full);
        EXPECT_EQ(outcome.status, 1) << text_of(words);
        EXPECT_TRUE(outcome.says("standard output")) << outcome.err;
    }
    // What prints nothing needs none.
    EXPECT_EQ(run(folder, to("map.exr"), closed).status, 0);
    EXPECT_EQ(read_floats(folder / "map.exr").height(), 64);
}

TEST_F(Targets, AClosedStandardErrorHarmsNothing) {
    Circumstances closed;
    closed.stderr_closed = true;
    EXPECT_EQ(run(folder, to("map.exr"), closed).status, 0);
    EXPECT_EQ(read_floats(folder / "map.exr").height(), 64);
    closed.stdout_closed = true;
    EXPECT_EQ(run(folder, {"info", "world.exr"}, closed).status, 1);
}

}  // namespace
}  // namespace chromeball
