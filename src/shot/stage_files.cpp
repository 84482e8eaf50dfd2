#include "shot/stage_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <utility>

#include "shot/records.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".jsonl";

/// The first and last frame that a file's name tells: "1-8", "3", "1-4,7,9-12", and where such a
/// list was too long for a name "1-12-HASH".
std::optional<std::pair<int, int>> span_of(std::string_view name) {
    if (!name.ends_with(kExtension)) return std::nullopt;
    name.remove_suffix(kExtension.size());
    int first = 0, last = 0;
    const char* end = name.data() + name.size();
    const auto begin = std::from_chars(name.data(), end, first);
    if (begin.ec != std::errc()) return std::nullopt;
    if (begin.ptr == end) return std::pair(first, first);
    // Of a list the last number counts, of a hash it is the second.
    const bool list = name.find(',') != std::string_view::npos;
    const auto from = list ? name.find_last_of(",-") : name.find('-');
    if (from == std::string_view::npos) return std::nullopt;
    const auto rest = std::from_chars(name.data() + from + 1, end, last);
    if (rest.ec != std::errc() || (rest.ptr != end && *rest.ptr != '-') || last < first)
        return std::nullopt;
    return std::pair(first, last);
}

}  // namespace

std::string stage_file_name(const Frames& frames) {
    // Lists of frames may be longer than a file's name: their hash stands for them.
    constexpr std::size_t kLongest = 64;
    std::string part = text_of(frames);
    if (part.size() > kLongest)
        part = fmt::format("{}-{}-{}", frames.front(), frames.back(), hash_of(part));
    return part.append(kExtension);
}

bool may_hold(std::string_view file_name, const Frames& frames) {
    const auto span = span_of(file_name);
    if (!span) return true;
    const int first = block_of(span->first) - 1, last = block_of(span->second) + 1;
    const auto from =
        std::lower_bound(frames.begin(), frames.end(), first,
                         [](int frame, int block) { return block_of(frame) < block; });
    return from != frames.end() && block_of(*from) <= last;
}

std::vector<std::string> stage_files(const std::string& folder) {
    std::vector<std::string> files;
    std::error_code none;  // a stage that has not begun has no folder
    for (const auto& entry : fs::directory_iterator(folder, none))
        if (entry.path().extension() == kExtension) files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<std::string> stage_files(const std::string& folder, const Frames& frames) {
    std::vector<std::string> files = stage_files(folder);
    std::erase_if(files, [&](const std::string& file) {
        return !may_hold(fs::path(file).filename().string(), frames);
    });
    return files;
}

}  // namespace chromeball
