#include "io/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
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

/// A file beside the target that vanishes unless it is kept.
class PartFile {
public:
    explicit PartFile(const std::string& target) : target_(target), name_(part_name(target)) {
        // A leftover of an interrupted run may be a link or of another owner.
        ::unlink(name_.c_str());
        descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor_ < 0) throw write_failure(target_, errno);
    }
    ~PartFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (!kept_) ::unlink(name_.c_str());
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

    /// Some file systems report a full disk only here.
    void close() {
        const int result = ::close(std::exchange(descriptor_, -1));
        if (result != 0) throw write_failure(target_, errno);
    }

    void keep() {
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
    part.close();
    part.keep();
}

}  // namespace io

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
