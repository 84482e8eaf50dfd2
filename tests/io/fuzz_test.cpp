#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <random>

#include "io/files.h"
#include "io/read.h"
#include "io/write.h"

namespace chromeball {
namespace {

using test::TempFolder;

/// Reads the file in this process; anything but a photo or an Error is a failure.
bool reads_or_refuses(const std::string& file) {
    try {
        const Photo photo = read_photo(file, {.max_pixels = 4'000'000});
        return photo.pixels.size() == photo.window.size.pixels() *
                                          static_cast<std::size_t>(photo.channels) *
                                          bytes_per_value(photo.type);
    } catch (const Error&) {
        return true;
    } catch (...) {
        return false;
    }
}

std::string mutated(std::string bytes, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    const std::size_t header = std::min<std::size_t>(bytes.size(), 512);
    for (std::size_t i = 1 + below(4); i > 0; --i) {
        const std::size_t at = 4 + below((below(3) ? header : bytes.size()) - 4);
        constexpr unsigned char kNasty[] = {0x00, 0x01, 0x7f, 0x80, 0xff};
        bytes[at] = static_cast<char>(below(2) ? kNasty[below(5)] : below(256));
    }
    if (below(8) == 0) bytes.resize(4 + below(bytes.size() - 4));
    return bytes;
}

/// A child of little memory and time reads many mutated files; nothing may crash or hang it.
void survive_mutations(FileFormat format) {
    const TempFolder folder;
    WriteOptions options;
    options.format = format;
    write_image(folder / "seed", test::pattern({33, 17}, 3).view(), options);
    const std::string seed = test::read_bytes(folder / "seed");
    const pid_t child = ::fork();
    if (child == 0) {
        std::signal(SIGALRM, SIG_DFL);
        ::alarm(60);
#if !defined(__SANITIZE_ADDRESS__)
        const rlimit memory{rlim_t{2} << 30, rlim_t{2} << 30};
        ::setrlimit(RLIMIT_AS, &memory);
#endif
        std::mt19937 random(4711);
        int failed = 0;
        for (int i = 0; i < 150; ++i) {
            test::write_bytes(folder / "x", mutated(seed, random));
            failed += !reads_or_refuses(folder / "x");
        }
        ::_exit(failed != 0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_FALSE(WIFSIGNALED(status)) << "signal " << WTERMSIG(status);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(MutatedFiles, AreReadOrRefusedInExr) { survive_mutations(FileFormat::exr); }
TEST(MutatedFiles, AreReadOrRefusedInPng) { survive_mutations(FileFormat::png); }
TEST(MutatedFiles, AreReadOrRefusedInJpeg) { survive_mutations(FileFormat::jpg); }
TEST(MutatedFiles, AreReadOrRefusedInTiff) { survive_mutations(FileFormat::tif); }
TEST(MutatedFiles, AreReadOrRefusedInHdr) { survive_mutations(FileFormat::hdr); }

}  // namespace
}  // namespace chromeball
