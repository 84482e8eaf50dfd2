#include "shot/status.h"

#include <fmt/format.h>

#include <algorithm>

namespace chromeball {
namespace {

constexpr std::size_t kMostFailures = 50;  ///< told one by one

template <class Frames, class Test>
std::size_t count(const Frames& frames, const Test& test) {
    return static_cast<std::size_t>(std::count_if(
        frames.begin(), frames.end(), [&](const auto& frame) { return test(frame.second); }));
}

std::string reason(const std::string& message, std::string_view otherwise) {
    return message.empty() ? std::string(otherwise) : message;
}

}  // namespace

void ShotStatus::add(std::string_view text) {
    for_each_line(text, [&](std::string_view line) {
        if (const auto track = track_record_from(line))
            tracked_[track->frame] = {.readable = track->there && track->readable,
                                      .found = track->ball && track->ball->sure,
                                      .message = track->message};
        else if (const auto solved = solved_frame_from(line))
            solved_[solved->frame] = {solved->outcome, solved->flagged};
        else if (const auto converted = convert_record_from(line))
            converted_[converted->frame] = {converted->written, converted->message};
    });
}

std::string ShotStatus::text() const {
    const std::string of_all = solved_.empty() ? "" : fmt::format(" of {}", solved_.size());
    const auto unreadable = count(tracked_, [](const Tracked& t) { return !t.readable; });
    const auto found = count(tracked_, [](const Tracked& t) { return t.found; });
    std::string text = fmt::format(
        "track    {}{} frames: {} with a ball, {} without, {} unreadable\n", tracked_.size(),
        of_all, found, tracked_.size() - found - unreadable, unreadable);
    if (solved_.empty()) {
        text += "solve    not done\n";
    } else {
        text += fmt::format("solve    {} frames:", solved_.size());
        for (const FrameOutcome outcome : kOutcomes)
            text += fmt::format(
                " {} {},", count(solved_, [&](const Solved& s) { return s.outcome == outcome; }),
                name_of(outcome));
        text +=
            fmt::format(" {} flagged\n", count(solved_, [](const Solved& s) { return s.flagged; }));
    }
    const auto written = count(converted_, [](const Converted& c) { return c.written; });
    text += fmt::format("convert  {}{} frames written, {} failed\n", written, of_all,
                        converted_.size() - written);

    std::map<int, std::string> failures;
    for (const auto& [frame, track] : tracked_)
        if (!track.readable) failures[frame] = reason(track.message, "cannot be read");
    for (const auto& [frame, converted] : converted_)
        if (!converted.written) failures[frame] = reason(converted.message, "cannot be written");
    std::size_t told = 0;
    for (const auto& [frame, why] : failures) {
        if (++told > kMostFailures) break;
        text += fmt::format("failed   {}: {}\n", frame, why);
    }
    if (failures.size() > kMostFailures)
        text += fmt::format("failed   and {} more\n", failures.size() - kMostFailures);
    return text;
}

}  // namespace chromeball
