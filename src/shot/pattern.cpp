#include "shot/pattern.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>

#include "core/error.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

constexpr int kMostDigits = 9;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A place for the number at the front of a text: how long it is written, how many digits it asks.
struct Found {
    std::size_t length;
    int digits;
};

std::optional<Found> run_of(std::string_view text, char mark) {
    const auto end = std::min(text.find_first_not_of(mark), text.size());
    if (end == 0 || end > kMostDigits) return std::nullopt;
    return Found{end, static_cast<int>(end)};
}

std::optional<Found> hashes(std::string_view text) { return run_of(text, '#'); }
std::optional<Found> ats(std::string_view text) { return run_of(text, '@'); }

/// %d, %04d.
std::optional<Found> printf_place(std::string_view text) {
    if (text.starts_with("%d")) return Found{2, 1};
    if (text.size() >= 4 && text[0] == '%' && text[1] == '0' && is_digit(text[2]) &&
        text[2] != '0' && text[3] == 'd')
        return Found{4, text[2] - '0'};
    return std::nullopt;
}

/// $F, $F4.
std::optional<Found> houdini_place(std::string_view text) {
    if (!text.starts_with("$F")) return std::nullopt;
    if (text.size() > 2 && is_digit(text[2]) && text[2] != '0') return Found{3, text[2] - '0'};
    return Found{2, 1};
}

using Finder = std::optional<Found> (*)(std::string_view);
constexpr std::array<Finder, 4> kKinds = {printf_place, houdini_place, hashes, ats};

std::string number(int frame, int digits) { return fmt::format("{:0{}}", frame, digits); }

}  // namespace

std::optional<FramePattern> FramePattern::parse(std::string_view text) {
    for (const Finder find : kKinds) {
        FramePattern pattern;
        pattern.text_ = text;
        for (std::size_t i = 0; i < text.size();) {
            if (const auto found = find(text.substr(i))) {
                pattern.places_.push_back({pattern.literal_.size(), found->digits});
                i += found->length;
            } else {
                pattern.literal_ += text[i++];
            }
        }
        if (!pattern.places_.empty()) return pattern;
    }
    return std::nullopt;
}

std::string FramePattern::path(int frame) const {
    std::string path;
    std::size_t from = 0;
    for (const Place& place : places_) {
        path += literal_.substr(from, place.at - from) + number(frame, place.digits);
        from = place.at;
    }
    return path + literal_.substr(from);
}

std::optional<int> FramePattern::frame_of(std::string_view path) const {
    const std::size_t at = places_.front().at;
    if (path.size() <= at) return std::nullopt;
    int frame = 0;
    const auto [end, error] = std::from_chars(path.data() + at, path.data() + path.size(), frame);
    if (error != std::errc() || frame < 0) return std::nullopt;
    // Making the path again settles the digits, the other places and the letters.
    if (this->path(frame) != path) return std::nullopt;
    return frame;
}

std::string FramePattern::folder() const {
    const auto slash = literal_.rfind('/', places_.front().at == 0 ? 0 : places_.front().at - 1);
    if (slash == std::string::npos || slash >= places_.front().at) return ".";
    return slash == 0 ? "/" : literal_.substr(0, slash);
}

std::string FramePattern::name() const {
    const std::string folder = this->folder();
    std::string rest =
        literal_.substr(folder == "." && !literal_.starts_with("./") ? 0 : folder.size() + 1);
    std::replace(rest.begin(), rest.end(), '/', '_');
    std::string name;
    for (const char c : rest)  // the dots on both sides of a place become one
        if (!(c == '.' && (name.empty() || name.back() == '.'))) name += c;
    while (!name.empty() && name.back() == '.') name.pop_back();
    return name.empty() ? "shot" : name;
}

Frames FramePattern::on_disk() const {
    const std::string folder = this->folder();
    std::error_code error;
    fs::directory_iterator entries(folder, error);
    if (error)
        throw Error(Error::Kind::failed,
                    fmt::format("{}: its folder {} cannot be read: {}; check the path", text_,
                                folder, error.message()));
    // Of the part with the first place the number can be read; the rest must then be there.
    FramePattern part = *this;
    const auto end = literal_.find('/', places_.front().at);
    const bool deeper = end != std::string::npos;
    if (deeper) {
        part.literal_ = literal_.substr(0, end);
        std::erase_if(part.places_, [&](const Place& place) { return place.at > end; });
    }
    const bool plain = folder == "." && !literal_.starts_with("./");
    const std::string before = plain ? "" : folder == "/" ? "/" : folder + "/";
    Frames frames;
    for (; entries != fs::directory_iterator(); entries.increment(error)) {
        if (error) break;
        const auto frame = part.frame_of(before + entries->path().filename().string());
        if (frame && (!deeper || fs::exists(path(*frame), error))) frames.push_back(*frame);
    }
    std::sort(frames.begin(), frames.end());
    return frames;
}

}  // namespace chromeball
