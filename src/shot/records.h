#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shot/solve.h"
#include "shot/track.h"

// The stages' values as lines of JSON, one record a line. Each line tells its stage and the version
// of its schema; lines of others, and what is torn or damaged, are no records.

namespace chromeball {

/// The schema's version; a line of another one is not understood.
constexpr int kRecordVersion = 1;

std::string to_line(const TrackRecord& record);
std::optional<TrackRecord> track_record_from(std::string_view line);

/// The head of the solve's file: what it was made with, and what holds for all frames.
struct SolveHead {
    std::string settings;  ///< hash of what the solve depends on
    /// Solid angle, steradians, that a pixel of the largest ball shows in the mean: maps are as
    /// fine as that asks for, all of one size. 0: no ball.
    double steradians = 0;
    /// Of all frames, pixels, where the outlines tell it and nobody else does.
    std::optional<double> focal = std::nullopt;

    bool operator==(const SolveHead&) const = default;
};
std::string to_line(const SolveHead& head);
std::string to_line(const SolvedFrame& frame);
std::optional<SolveHead> solve_head_from(std::string_view line);
std::optional<SolvedFrame> solved_frame_from(std::string_view line);

/// The stage `convert`, one frame.
struct ConvertRecord {
    int frame = 0;
    std::string settings;  ///< hash of what it was made of and how
    bool written = false;
    double seconds = 0;
    std::string message;  ///< why it was not, or what the user should know
};
std::string to_line(const ConvertRecord& record);
std::optional<ConvertRecord> convert_record_from(std::string_view line);

/// Calls each(line) for every whole line of a text; what follows the last line end is torn.
template <class Each>
void for_each_line(std::string_view text, const Each& each) {
    for (auto end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
        each(text.substr(0, end));
        text.remove_prefix(end + 1);
    }
}

/// Names and values as the text of a JSON object.
std::string json_object(const std::vector<std::pair<std::string, std::string>>& values);

/// A hash of a text as 16 hexadecimal digits (FNV-1a, 64 bits): tells settings apart, keeps no
/// secrets.
std::string hash_of(std::string_view text);

}  // namespace chromeball
