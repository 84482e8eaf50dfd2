#include "io/whole_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "io/files.h"
#include "io/read.h"
#include "io/write.h"

namespace chromeball {
namespace {

using test::message_of;
using test::pattern;
using test::TempFolder;
using testing::Test;

std::size_t files_in(const TempFolder& folder) {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path()))
        ++count;
    return count;
}

WriteOptions format(FileFormat format) {
    WriteOptions options;
    options.format = format;
    return options;
}

/// What a child process that can write `limit` bytes to a file is told when it writes the picture.
std::string message_under_limit(const std::string& file, FileFormat kind, rlim_t limit) {
    // In this process: a child forked while a library's threads hold locks would wait for ever.
    const auto before_signal = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const rlimit most{limit, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &most);
    const std::string message = message_of([&] {
        write_image(file, pattern({256, 128}, 3).view(), format(kind));
    });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, before_signal);
    return message;
}

TEST(WholeFile, IsNotThereWhenTheDiskFillsUp) {
    const TempFolder folder;
    for (const auto kind :
         {FileFormat::exr, FileFormat::hdr, FileFormat::tif, FileFormat::png, FileFormat::jpg}) {
        const std::string file = folder / ("x." + std::string(extension_of(kind)));
        for (const rlim_t limit : {0, 100, 1000}) {
            const std::string message = message_under_limit(file, kind, limit);
            EXPECT_TRUE(message.starts_with(file + ": cannot be written: ")) << message;
            EXPECT_NE(message.find("File too large"), std::string::npos) << message;
            EXPECT_EQ(files_in(folder), 0u);
        }
    }
}

TEST(WholeFile, LeavesTheOldOneAloneOnFailure) {
    const TempFolder folder;
    const std::string file = folder / "x.exr";
    write_image(file, pattern({8, 8}, 3).view(), {});
    const std::string before = test::read_bytes(file);
    message_under_limit(file, FileFormat::exr, 100);
    EXPECT_TRUE(before == test::read_bytes(file));
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(WholeFile, ReplacesTheOldOneAndLeavesNothingBeside) {
    const TempFolder folder;
    test::write_bytes(folder / "x.exr", "old");
    test::write_bytes(folder / ".x.exr.part", "left over by an interrupted run");
    write_image(folder / "x.exr", pattern({8, 4}, 3).view(), {});
    EXPECT_EQ(read_photo(folder / "x.exr").display, (Size{8, 4}));
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(WholeFile, GoesThroughALinkInsteadOfReplacingIt) {
    const TempFolder folder;
    test::write_bytes(folder / "real.exr", "old");
    std::filesystem::create_symlink("real.exr", folder / "link.exr");
    write_image(folder / "link.exr", pattern({8, 4}, 3).view(), {});
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.exr"));
    EXPECT_EQ(read_photo(folder / "real.exr").display, (Size{8, 4}));
}

TEST(Target, ThatIsAFolderIsRefused) {
    const TempFolder folder;
    std::filesystem::create_directory(folder / "out.exr");
    EXPECT_EQ(message_of([&] {
                  write_image(folder / "out.exr", pattern({2, 2}, 3).view(), {});
              }),
              folder / "out.exr: is a folder; give the name of a file");
    EXPECT_EQ(message_of([&] {
                  write_image(folder / "new/", pattern({2, 2}, 3).view(), {});
              }),
              folder / "new/: is the name of a folder; give the name of a file");
}

TEST(Target, InAMissingFolderIsRefusedWithTheFoldersName) {
    const TempFolder folder;
    EXPECT_EQ(message_of([&] {
                  write_image(folder / "no/x.exr", pattern({2, 2}, 3).view(), {});
              }),
              folder / "no/x.exr: cannot be written: there is no folder " + folder.path() +
                  "/no; make it first");
}

TEST(Target, ThatIsADeviceIsRefused) {
    EXPECT_EQ(message_of([&] {
                  write_image("/dev/null", pattern({2, 2}, 3).view(), {});
              }),
              "/dev/null: is not a regular file; give the name of a file");
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(Target, InAReadOnlyFolderIsRefused) {
    const TempFolder folder;
    std::filesystem::create_directory(folder / "locked");
    ::chmod((folder / "locked").c_str(), 0555);
    // Root may write anywhere: it has to take a lower rank for a moment.
    ::chmod(folder.path().c_str(), 0755);
    constexpr uid_t kNobody = 65534;
    const bool root = ::geteuid() == 0;
    if (root) {
        ASSERT_EQ(::seteuid(kNobody), 0);
    }
    const std::string message = message_of([&] {
        write_image(folder / "locked/x.exr", pattern({2, 2}, 3).view(), {});
    });
    if (root) {
        ASSERT_EQ(::seteuid(0), 0);
    }
    EXPECT_EQ(message, folder /
                           "locked/x.exr: cannot be written: Permission denied; check the "
                           "permissions or write elsewhere");
}

TEST(MakeFolder, MakesOneButNotItsParents) {
    const TempFolder folder;
    make_folder(folder / "faces");
    make_folder(folder / "faces");  // there already: fine
    EXPECT_TRUE(std::filesystem::is_directory(folder / "faces"));
    EXPECT_NE(message_of([&] { make_folder(folder / "a/b"); }).find("there is no folder"),
              std::string::npos);
    test::write_bytes(folder / "file", "x");
    EXPECT_EQ(message_of([&] { make_folder(folder / "file"); }),
              folder / "file: is a file, not a folder; give another name");
}

TEST(WriteFile, WritesText) {
    const TempFolder folder;
    write_file(folder / "a.json", "{}\n");
    write_file(folder / "a.json", "[]\n");
    EXPECT_EQ(test::read_bytes(folder / "a.json"), "[]\n");
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(WholeFile, UsesTheLeftoverOfAKilledRunAgain) {
    const TempFolder folder;
    const std::string file = folder / "x.txt", part = folder / ".x.txt.part";
    std::ofstream(part) << "much longer than what is written now";
    write_file(file, "whole");
    EXPECT_EQ(test::read_bytes(file), "whole");
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(WholeFile, LeavesTheFileOfALiveWriterAlone) {
    const TempFolder folder;
    const std::string file = folder / "x.txt", part = folder / ".x.txt.part";
    const int live = ::open(part.c_str(), O_WRONLY | O_CREAT, 0666);
    ASSERT_EQ(::flock(live, LOCK_EX), 0);
    ASSERT_EQ(::write(live, "half", 4), 4);
    remove_leftover(file);
    EXPECT_EQ(test::read_bytes(part), "half");
    std::jthread other([&] { write_file(file, "second"); });
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    EXPECT_EQ(test::read_bytes(part), "half");  // it waits
    ASSERT_EQ(::rename(part.c_str(), file.c_str()), 0);
    ::close(live);
    other.join();
    EXPECT_EQ(test::read_bytes(file), "second");
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(WholeFile, LeftoversAreRemovedWhereNoOneWrites) {
    const TempFolder folder;
    std::ofstream(folder / ".x.txt.part") << "half";
    remove_leftover(folder / "x.txt");
    remove_leftover(folder / "y.txt");
    EXPECT_EQ(files_in(folder), 0u);
}

}  // namespace
}  // namespace chromeball
