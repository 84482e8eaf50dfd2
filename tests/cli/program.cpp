#include "cli/program.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

extern char** environ;

namespace chromeball::test {
namespace {

namespace fs = std::filesystem;

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

std::string all_of(int descriptor) {
    std::string text;
    std::array<char, 65536> part;
    for (off_t at = 0;;) {
        const ssize_t count = ::pread(descriptor, part.data(), part.size(), at);
        if (count <= 0) return text;
        text.append(part.data(), static_cast<std::size_t>(count));
        at += count;
    }
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

/// Our environment without what would change the results, and with what is asked for.
std::vector<std::string> environment_of(const Circumstances& how) {
    std::vector<std::string> all;
    for (char** one = environ; *one; ++one)
        if (std::strncmp(*one, "OCIO=", 5) != 0) all.emplace_back(*one);
    for (const auto& [name, value] : how.environment) all.push_back(name + "=" + value);
    return all;
}

void set_limit(__rlimit_resource what, const std::optional<rlim_t>& bytes) {
    if (!bytes) return;
    const rlimit limit{*bytes, *bytes};
    ::setrlimit(what, &limit);
}

/// Starts a program; of it remain its process and the files of what it says.
pid_t start(const std::string& program, const std::string& folder, const Words& words,
            const Circumstances& how, int out, int err) {
    std::vector<std::string> arguments{program};
    arguments.insert(arguments.end(), words.begin(), words.end());
    std::vector<std::string> environment = environment_of(how);
    const auto argv = pointers(arguments), envp = pointers(environment);
    const pid_t process = ::fork();
    if (process < 0) throw std::runtime_error("fork failed");
    if (process > 0) return process;
    // From here on only what is allowed after fork in a program with threads.
    if (::chdir(folder.c_str()) != 0) ::_exit(126);
    if (!how.stdout_path.empty()) out = ::open(how.stdout_path.c_str(), O_WRONLY);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    ::close(STDIN_FILENO);
    if (how.stdout_closed) ::close(STDOUT_FILENO);
    if (how.stderr_closed) ::close(STDERR_FILENO);
#ifndef __SANITIZE_ADDRESS__  // which reserves more address space than any limit
    set_limit(RLIMIT_AS, how.memory_bytes);
#endif
    set_limit(RLIMIT_FSIZE, how.file_size_bytes);
    ::execvpe(argv[0], argv.data(), envp.data());
    ::_exit(127);
}

}  // namespace

TempFolder::TempFolder() {
    std::string pattern = (fs::temp_directory_path() / "cliXXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder: " + pattern);
    path_ = pattern;
}

TempFolder::~TempFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::vector<std::string> TempFolder::content() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path_))
        names.push_back(fs::relative(entry.path(), path_).string() +
                        (entry.is_directory() ? "/" : ""));
    std::sort(names.begin(), names.end());
    return names;
}

std::size_t Outcome::lines_with(const std::string& beginning) const {
    std::istringstream lines(err);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line);) count += line.starts_with(beginning);
    return count;
}

Running::Running(const TempFolder& folder, const Words& words, const Circumstances& how)
    : out_(::memfd_create("out", MFD_CLOEXEC)),
      err_(::memfd_create("err", MFD_CLOEXEC)),
      start_(now()) {
    process_ = start(CHROMEBALL_PROGRAM, folder.path(), words, how, out_, err_);
}

Running::~Running() {
    if (!outcome_) {
        ::kill(process_, SIGKILL);
        wait();
    }
    ::close(out_);
    ::close(err_);
}

std::string Running::said() const { return all_of(err_); }

bool Running::ended() {
    siginfo_t info{};
    return outcome_ ||
           (::waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
            info.si_pid == process_);
}

void Running::signal(int number) const { ::kill(process_, number); }

Outcome Running::wait() {
    if (outcome_) return *outcome_;
    int status = 0;
    ::waitpid(process_, &status, 0);
    Outcome outcome;
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    outcome.out = all_of(out_);
    outcome.err = all_of(err_);
    outcome.seconds = now() - start_;
    outcome_ = outcome;
    return outcome;
}

Outcome run(const TempFolder& folder, const Words& words, const Circumstances& how) {
    return Running(folder, words, how).wait();
}

std::vector<Outcome> run_all(const TempFolder& folder, const std::vector<Words>& commands) {
    std::vector<Outcome> outcomes(commands.size());
    std::atomic<std::size_t> next = 0;
    std::vector<std::jthread> workers;
    const unsigned count = std::clamp(std::thread::hardware_concurrency(), 2U, 8U);
    for (unsigned i = 0; i < count; ++i)
        workers.emplace_back([&] {
            for (std::size_t at; (at = next++) < commands.size();)
                outcomes[at] = run(folder, commands[at]);
        });
    workers.clear();
    return outcomes;
}

Outcome run_other(const TempFolder& folder, const Words& words) {
    const int out = ::memfd_create("out", MFD_CLOEXEC), err = ::memfd_create("err", MFD_CLOEXEC);
    const pid_t process =
        start(words.front(), folder.path(), {words.begin() + 1, words.end()}, {}, out, err);
    int status = 0;
    ::waitpid(process, &status, 0);
    Outcome outcome;
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    outcome.out = all_of(out);
    outcome.err = all_of(err);
    ::close(out);
    ::close(err);
    return outcome;
}

std::string read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::string& path, std::string_view bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), std::ssize(bytes));
}

bool exists(const std::string& path) { return fs::exists(fs::symlink_status(path)); }

std::string text_of(const Words& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

}  // namespace chromeball::test
