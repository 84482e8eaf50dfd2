#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// Runs the program itself, as a user would.

namespace chromeball::test {

/// A folder of its own that vanishes with the test; the working directory of what runs in it.
class TempFolder {
public:
    TempFolder();
    ~TempFolder();
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;
    std::string operator/(const std::string& name) const { return path_ + "/" + name; }
    const std::string& path() const { return path_; }
    /// What lies in it, below it too, sorted; hidden files as well, folders end in '/'.
    std::vector<std::string> content() const;

private:
    std::string path_;
};

using Words = std::vector<std::string>;

/// How a run differs from an ordinary one. Standard input is always closed.
struct Circumstances {
    std::vector<std::pair<std::string, std::string>> environment;  ///< added to ours
    std::optional<rlim_t> memory_bytes;                            ///< address space
    std::optional<rlim_t> file_size_bytes;                         ///< of any file written
    std::string stdout_path;  ///< written there instead of captured
    bool stdout_closed = false;
    bool stderr_closed = false;
};

/// What became of a run.
struct Outcome {
    int status = -1;  ///< exit status; -N: ended by signal N
    std::string out;
    std::string err;
    double seconds = 0;

    bool says(const std::string& text) const { return err.find(text) != std::string::npos; }
    /// Lines of stderr that begin with a word, as "error: " or "warning: ".
    std::size_t lines_with(const std::string& beginning) const;
};

/// A run that goes on while the test does something else.
class Running {
public:
    Running(const TempFolder& folder, const Words& words, const Circumstances& how = {});
    ~Running();
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    /// What it has said on stderr so far.
    std::string said() const;
    bool ended();
    void signal(int number) const;
    Outcome wait();

private:
    pid_t process_ = -1;
    int out_ = -1, err_ = -1;
    double start_ = 0;
    std::optional<Outcome> outcome_;
};

/// Runs `chromeball words...` in the folder.
Outcome run(const TempFolder& folder, const Words& words, const Circumstances& how = {});

/// Runs several at a time: starting a process costs more than what most of them do.
std::vector<Outcome> run_all(const TempFolder& folder, const std::vector<Words>& commands);

/// Runs another program, found on the path; status 127 where it is not installed.
Outcome run_other(const TempFolder& folder, const Words& words);

std::string read_bytes(const std::string& path);
void write_bytes(const std::string& path, std::string_view bytes);
bool exists(const std::string& path);

/// "a b c", for messages.
std::string text_of(const Words& words);

}  // namespace chromeball::test
