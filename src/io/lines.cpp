#include "io/lines.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "io/input_file.h"
#include "io/messages.h"

namespace chromeball {
namespace {

/// An open file that closes itself.
class Descriptor {
public:
    explicit Descriptor(const std::string& path)
        : number_(::open(path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666)) {}
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const { return number_; }

private:
    int number_;
};

Error append_failure(const std::string& path, int reason) {
    return io::failure(path, fmt::format("cannot be written: {}; make room, or name another "
                                         "folder with --work",
                                         io::system_reason(reason)));
}

bool ends_torn(int file) {
    const off_t end = ::lseek(file, 0, SEEK_END);
    char last = '\n';
    return end > 0 && ::pread(file, &last, 1, end - 1) == 1 && last != '\n';
}

}  // namespace

void append_line(const std::string& path, std::string_view line) {
    const Descriptor file(path);
    if (file.number() < 0) throw append_failure(path, errno);
    // Half of another's line looks torn: one at a time. Where a file system has no locks each line
    // is still one write, and an empty line too many does no harm.
    while (::flock(file.number(), LOCK_EX) != 0 && errno == EINTR) {
    }
    std::string text(ends_torn(file.number()) ? "\n" : "");
    text += line;
    if (!line.ends_with('\n')) text += '\n';
    ssize_t written = 0;
    do {
        written = ::write(file.number(), text.data(), text.size());
    } while (written < 0 && errno == EINTR);
    if (written < 0) throw append_failure(path, errno);
    if (static_cast<std::size_t>(written) != text.size()) throw append_failure(path, ENOSPC);
}

std::string read_text(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error) && !error) return {};
    const auto size = std::filesystem::file_size(path, error);
    if (error) throw io::failure(path, fmt::format("cannot be read: {}", error.message()));
    const auto bytes = io::first_bytes(path, size);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace chromeball
