#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace chromeball::io {

struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using InputFile = std::unique_ptr<std::FILE, FileCloser>;

/// Opens a file for reading; throws Error with the reason.
InputFile open_input(const std::string& path);

/// The first bytes of a file, `most` at most.
std::vector<std::byte> first_bytes(const std::string& path, std::size_t most);

}  // namespace chromeball::io
