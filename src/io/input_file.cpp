#include "io/input_file.h"

#include <fmt/format.h>

#include <cerrno>

#include "io/messages.h"

namespace chromeball::io {

InputFile open_input(const std::string& path) {
    InputFile file(std::fopen(path.c_str(), "rb"));
    if (!file)
        throw failure(
            path, fmt::format("cannot be opened: {}; check its permissions", system_reason(errno)));
    return file;
}

std::vector<std::byte> first_bytes(const std::string& path, std::size_t most) {
    const InputFile file = open_input(path);
    std::vector<std::byte> bytes(most);
    bytes.resize(std::fread(bytes.data(), 1, most, file.get()));
    if (std::ferror(file.get()))
        throw failure(path, fmt::format("cannot be read: {}", system_reason(errno)));
    return bytes;
}

}  // namespace chromeball::io
