#include "shot/report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace chromeball {
namespace {

using Json = nlohmann::ordered_json;

/// A ten-thousandth of a pixel is more than anyone measures.
double rounded(double value) { return std::round(value * 1e4) / 1e4; }

Json to_json(const Outline& o) {
    return {{"cx", rounded(o.cx)},
            {"cy", rounded(o.cy)},
            {"a", rounded(o.a)},
            {"b", rounded(o.b)},
            {"angle", rounded(o.angle)}};
}

Json to_json(const FrameReport& f) {
    Json json = {{"frame", f.frame}, {"outcome", name_of(f.outcome)}};
    if (f.outline) json["outline"] = to_json(*f.outline);
    if (f.tracked) json["tracked"] = to_json(*f.tracked);
    json["confidence"] = rounded(f.confidence);
    json["seconds"] = rounded(f.seconds);
    json["message"] = f.message;
    json["flagged"] = f.flagged;
    return json;
}

Json summary_of(const ShotReport& report) {
    Json json = {{"frames", report.frames.size()}};
    for (const FrameOutcome outcome : kOutcomes)
        json[std::string(name_of(outcome))] =
            std::count_if(report.frames.begin(), report.frames.end(),
                          [&](const FrameReport& f) { return f.outcome == outcome; });
    json["flagged"] = std::count_if(report.frames.begin(), report.frames.end(),
                                    [](const FrameReport& f) { return f.flagged; });
    json["wall_seconds"] = rounded(report.wall_seconds);
    json["jobs"] = report.jobs;
    return json;
}

}  // namespace

std::string_view name_of(FrameOutcome outcome) {
    switch (outcome) {
        case FrameOutcome::found:
            return "found";
        case FrameOutcome::filled:
            return "filled";
        case FrameOutcome::held:
            return "held";
        case FrameOutcome::missing:
            return "missing";
        case FrameOutcome::failed:
            break;
    }
    return "failed";
}

std::optional<FrameOutcome> outcome_named(std::string_view name) {
    for (const FrameOutcome outcome : kOutcomes)
        if (name_of(outcome) == name) return outcome;
    return std::nullopt;
}

std::string to_json(const ShotReport& report) {
    Json json = {{"frames", Json::array()}};
    for (const FrameReport& frame : report.frames) json["frames"].push_back(to_json(frame));
    Json settings = Json::parse(report.settings_json, nullptr, false);
    json["settings"] = settings.is_object() ? settings : Json::object();
    json["summary"] = summary_of(report);
    return json.dump(1, ' ', true, Json::error_handler_t::replace) + "\n";
}

}  // namespace chromeball
