#include "io/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <utility>

#include "io/messages.h"
#include "io/write.h"

namespace chromeball {
namespace io {
namespace {

std::string folder_of(const std::string& path) {
    const auto slash = path.rfind('/');
    return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

/// The file that is really written: renaming onto a symbolic link would replace the link.
std::string resolved(const std::string& path) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0 || !S_ISLNK(status.st_mode)) return path;
    const std::unique_ptr<char, decltype(&std::free)> real(::realpath(path.c_str(), nullptr),
                                                           &std::free);
    return real ? real.get() : path;
}

std::string part_name(const std::string& path) {
    const auto slash = path.rfind('/');
    const auto at = slash == std::string::npos ? 0 : slash + 1;
    return path.substr(0, at) + "." + path.substr(at) + ".part";
}

std::string way_out(int error_number) {
    switch (error_number) {
        case ENOSPC:
        case EDQUOT:
            return "make room or write elsewhere";
        case EFBIG:
            return "raise the limit on file sizes or write elsewhere";
        case EROFS:
        case EACCES:
        case EPERM:
            return "check the permissions or write elsewhere";
        case ENAMETOOLONG:
            return "choose a shorter name";
        default:
            return "try another place";
    }
}

Error write_failure(const std::string& path, int error_number) {
    return failure(path, fmt::format("cannot be written: {}; {}", system_reason(error_number),
                                     way_out(error_number)));
}

/// Opens a part file for one writer alone, empty; below 0 and errno where that cannot be.
///
/// A lock on it tells a live writer from what a killed run left behind: that is used again. Where
/// the file system knows no locks, what is there is taken for a leftover.
int open_alone(const std::string& name) {
    constexpr int kWaits = 600;  // of 0.1 s, for a writer of the same file to finish
    for (int waited = 0; waited < kWaits;) {
        // A leftover may also be a link, or of another owner.
        int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (file < 0 && (errno == ELOOP || errno == EACCES || errno == EISDIR)) {
            const int reason = errno;
            if (::unlink(name.c_str()) == 0) {
                ++waited;
                continue;
            }
            errno = reason;
            return -1;
        }
        if (file < 0) return -1;
        if (::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            ::close(file);
            ::usleep(100'000);
            ++waited;
            continue;
        }
        // Its writer may have renamed it, between the opening and the lock.
        struct stat mine {
        }, there{};
        if (::fstat(file, &mine) == 0 && ::stat(name.c_str(), &there) == 0 &&
            mine.st_ino == there.st_ino && mine.st_dev == there.st_dev) {
            if (::ftruncate(file, 0) == 0) return file;
            const int reason = errno;
            ::close(file);
            errno = reason;
            return -1;
        }
        ::close(file);
    }
    errno = EBUSY;
    return -1;
}

/// A file beside the target that vanishes unless it is kept.
class PartFile {
public:
    explicit PartFile(const std::string& target) : target_(target), name_(part_name(target)) {
        descriptor_ = open_alone(name_);
        if (descriptor_ < 0) throw write_failure(target_, errno);
    }
    ~PartFile() {
        if (!kept_) ::unlink(name_.c_str());
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    PartFile(const PartFile&) = delete;
    PartFile& operator=(const PartFile&) = delete;

    void write(std::span<const std::byte> bytes) {
        constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // Linux writes at most 2 GB
        while (!bytes.empty()) {
            const ssize_t written =
                ::write(descriptor_, bytes.data(), std::min(bytes.size(), kMostAtOnce));
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) throw write_failure(target_, errno);
            bytes = bytes.subspan(static_cast<std::size_t>(written));
        }
    }

    /// Renames it while it is still locked, so that no other writer takes it for its own.
    void keep() {
        // Some file systems report a full disk only when a file is closed; the lock stays with the
        // first descriptor.
        const int second = ::dup(descriptor_);
        if (second < 0 || ::close(second) != 0) throw write_failure(target_, errno);
        if (::rename(name_.c_str(), target_.c_str()) != 0) throw write_failure(target_, errno);
        kept_ = true;
    }

private:
    std::string target_;
    std::string name_;
    int descriptor_ = -1;
    bool kept_ = false;
};

}  // namespace

void check_target(const std::string& path) {
    if (path.empty()) throw failure("(no name)", "a file to write is needed");
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0) {
        if (S_ISDIR(status.st_mode)) throw failure(path, "is a folder; give the name of a file");
        if (!S_ISREG(status.st_mode))
            throw failure(path, "is not a regular file; give the name of a file");
        if (::access(path.c_str(), W_OK) != 0) throw write_failure(path, errno);
    } else if (path.back() == '/') {
        throw failure(path, "is the name of a folder; give the name of a file");
    }
    const std::string folder = folder_of(path);
    if (::stat(folder.c_str(), &status) != 0 && errno == ENOENT)
        throw failure(
            path, fmt::format("cannot be written: there is no folder {}; make it first", folder));
    if (::stat(folder.c_str(), &status) == 0 && !S_ISDIR(status.st_mode))
        throw failure(path, fmt::format("cannot be written: {} is a file, not a folder", folder));
    if (::access(folder.c_str(), W_OK | X_OK) != 0) throw write_failure(path, errno);
}

void write_whole_file(const std::string& path, std::span<const std::byte> bytes) {
    check_target(path);
    PartFile part(resolved(path));
    part.write(bytes);
    part.keep();
}

}  // namespace io

void remove_leftover(const std::string& path) {
    const std::string name = io::part_name(io::resolved(path));
    const int file = ::open(name.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) return;
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) ::unlink(name.c_str());
    ::close(file);
}

void make_folder(const std::string& path) {
    if (::mkdir(path.c_str(), 0777) == 0) return;
    const int reason = errno;
    struct stat status {};
    const bool exists = ::stat(path.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) return;
    if (exists) throw io::failure(path, "is a file, not a folder; give another name");
    if (reason == ENOENT)
        throw io::failure(path, fmt::format("cannot be made: there is no folder {}; make it first",
                                            io::folder_of(path)));
    throw io::failure(path, fmt::format("cannot be made: {}; {}", io::system_reason(reason),
                                        io::way_out(reason)));
}

void write_file(const std::string& path, std::string_view content) {
    io::write_whole_file(path, std::as_bytes(std::span(content)));
}

}  // namespace chromeball
