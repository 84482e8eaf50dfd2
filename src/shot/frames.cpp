#include "shot/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>

#include "core/error.h"
#include "core/names.h"

namespace chromeball {
namespace {

constexpr std::int64_t kMostFrames = 10'000'000;

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
    throw Error(Error::Kind::usage,
                fmt::format("--frames {}: {}; write 1001-1100, 1001-1100x2 or 1,5,9-12",
                            excerpt(text), why));
}

/// Takes a number off the front.
std::optional<int> take_number(std::string_view& text) {
    if (text.empty() || text.front() < '0' || text.front() > '9') return std::nullopt;
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

bool take(std::string_view& text, char mark) {
    if (text.empty() || text.front() != mark) return false;
    text.remove_prefix(1);
    return true;
}

void add_range(Frames& frames, std::string_view part, std::string_view whole) {
    std::string_view rest = part;
    const auto first = take_number(rest);
    if (!first) refuse(whole, fmt::format("\"{}\" begins with no frame number", excerpt(part)));
    int last = *first, step = 1;
    if (take(rest, '-')) {
        const auto end = take_number(rest);
        if (!end) refuse(whole, fmt::format("expected a number after \"{}-\"", *first));
        last = *end;
        if (take(rest, 'x')) {
            const auto by = take_number(rest);
            if (!by || *by == 0)
                refuse(whole,
                       fmt::format("expected a step of at least 1 after \"{}-{}x\"", *first, last));
            step = *by;
        }
    }
    if (!rest.empty())
        refuse(whole, fmt::format("\"{}\" was not expected behind a frame number", excerpt(rest)));
    if (last < *first) refuse(whole, fmt::format("{} comes after {}", *first, last));
    const std::int64_t count = (std::int64_t{last} - *first) / step + 1;
    if (count + static_cast<std::int64_t>(frames.size()) > kMostFrames)
        refuse(whole, fmt::format("more than {} frames", kMostFrames));
    for (std::int64_t i = 0; i < count; ++i) frames.push_back(static_cast<int>(*first + i * step));
}

}  // namespace

Frames parse_frames(std::string_view text) {
    Frames frames;
    std::string_view rest = text;
    while (true) {
        const auto comma = rest.find(',');
        add_range(frames, rest.substr(0, comma), text);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return frames;
}

std::string text_of(const Frames& frames) {
    std::string text;
    for (std::size_t i = 0; i < frames.size();) {
        std::size_t end = i + 1;
        while (end < frames.size() && frames[end] == frames[end - 1] + 1) ++end;
        if (!text.empty()) text += ',';
        text += fmt::format("{}", frames[i]);
        if (end > i + 1) text += fmt::format("-{}", frames[end - 1]);
        i = end;
    }
    return text;
}

Frames gaps_in(const Frames& frames) {
    Frames gaps;
    for (std::size_t i = 1; i < frames.size(); ++i)
        for (int n = frames[i - 1] + 1; n < frames[i]; ++n) gaps.push_back(n);
    return gaps;
}

int block_of(int frame) {
    return frame >= 0 ? frame / kKeyInterval : -((kKeyInterval - 1 - frame) / kKeyInterval);
}

int key_frame(int frame, const std::function<bool(int)>& there) {
    for (int key = block_of(frame) * kKeyInterval; key < frame; ++key)
        if (there(key)) return key;
    return frame;
}

namespace {

std::optional<int> key_frame_of_block(int block, const std::function<bool(int)>& there) {
    const int first = block * kKeyInterval;
    for (int key = first; key < first + kKeyInterval; ++key)
        if (there(key)) return key;
    return std::nullopt;
}

}  // namespace

std::optional<int> next_key_frame(int frame, const std::function<bool(int)>& there) {
    return key_frame_of_block(block_of(frame) + 1, there);
}

std::optional<int> previous_key_frame(int frame, const std::function<bool(int)>& there) {
    return key_frame_of_block(block_of(frame) - 1, there);
}

}  // namespace chromeball
