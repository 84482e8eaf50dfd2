#include "run_program.h"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/error.h"

extern char** environ;

namespace chromeball {
namespace {

[[noreturn]] void refuse(const std::string& what, int number) {
    throw Error(Error::Kind::failed, what + ": " + std::strerror(number));
}

/// A nameless file in memory: unlike a pipe it never fills up, whoever reads or writes first.
class MemoryFile {
public:
    explicit MemoryFile(const char* name) : descriptor_(::memfd_create(name, MFD_CLOEXEC)) {
        if (descriptor_ < 0) refuse("a file in memory", errno);
    }
    ~MemoryFile() { ::close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    int descriptor() const { return descriptor_; }

    void fill(const std::string& text) {
        for (std::size_t done = 0; done < text.size();) {
            const ssize_t count = ::write(descriptor_, text.data() + done, text.size() - done);
            if (count < 0 && errno != EINTR) refuse("a file in memory", errno);
            if (count > 0) done += static_cast<std::size_t>(count);
        }
        ::lseek(descriptor_, 0, SEEK_SET);
    }
    std::string text() const {
        std::string all;
        std::array<char, 4096> part;
        for (;;) {
            const ssize_t count =
                ::pread(descriptor_, part.data(), part.size(), static_cast<off_t>(all.size()));
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return all;
            all.append(part.data(), static_cast<std::size_t>(count));
        }
    }

private:
    int descriptor_;
};

/// Which descriptors the program gets; what the system allots is given back.
class Streams {
public:
    Streams(const MemoryFile& in, const MemoryFile& out, const MemoryFile& err) {
        ::posix_spawn_file_actions_init(&actions_);
        ::posix_spawn_file_actions_adddup2(&actions_, in.descriptor(), STDIN_FILENO);
        ::posix_spawn_file_actions_adddup2(&actions_, out.descriptor(), STDOUT_FILENO);
        ::posix_spawn_file_actions_adddup2(&actions_, err.descriptor(), STDERR_FILENO);
    }
    ~Streams() { ::posix_spawn_file_actions_destroy(&actions_); }
    Streams(const Streams&) = delete;
    Streams& operator=(const Streams&) = delete;

    const posix_spawn_file_actions_t* actions() const { return &actions_; }

private:
    posix_spawn_file_actions_t actions_;
};

}  // namespace

ProgramOutcome run_program(const std::vector<std::string>& words, const std::string& input) {
    std::vector<std::string> texts = words;
    std::vector<char*> arguments;
    for (std::string& text : texts) arguments.push_back(text.data());
    arguments.push_back(nullptr);

    MemoryFile in("in"), out("out"), err("err");
    in.fill(input);
    const Streams streams(in, out, err);
    pid_t process = 0;
    const int failed = ::posix_spawnp(&process, arguments[0], streams.actions(), nullptr,
                                      arguments.data(), environ);
    if (failed == ENOENT || failed == EACCES) return {127, "", std::strerror(failed)};
    if (failed != 0) refuse(words.front(), failed);
    int status = 0;
    while (::waitpid(process, &status, 0) < 0)
        if (errno != EINTR) refuse(words.front(), errno);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), out.text(),
            err.text()};
}

std::vector<std::string> typed_words() {
    std::ifstream file("/proc/self/cmdline", std::ios::binary);
    const std::string all{std::istreambuf_iterator<char>(file), {}};
    std::vector<std::string> words;
    for (std::size_t at = 0; at < all.size();) {
        const std::size_t end = all.find('\0', at);
        words.push_back(all.substr(at, end - at));
        at = end == std::string::npos ? all.size() : end + 1;
    }
    if (!words.empty()) words.erase(words.begin());
    return words;
}

std::string program_path() {
    std::error_code failed;
    const auto path = std::filesystem::read_symlink("/proc/self/exe", failed);
    if (failed) refuse("/proc/self/exe", failed.value());
    return path.string();
}

}  // namespace chromeball
