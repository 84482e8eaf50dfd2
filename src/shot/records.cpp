#include "shot/records.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace chromeball {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kTrack = "track", kSolve = "solve", kSolved = "solved",
                           kConvert = "convert";

Json record(std::string_view stage) { return {{"v", kRecordVersion}, {"stage", stage}}; }

std::string line_of(const Json& json) {
    return json.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n";
}

/// The object on a line of a stage; calls `take` with it. Nothing where it is none, or damaged.
template <class Take>
auto taken(std::string_view line, std::string_view stage, const Take& take)
    -> std::optional<decltype(take(Json()))> {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    try {
        if (json.at("v") != kRecordVersion || json.at("stage") != stage) return std::nullopt;
        return take(json);
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

Json to_json(const Outline& o) { return {o.cx, o.cy, o.a, o.b, o.angle}; }

Outline outline_from(const Json& json) {
    const auto n = json.get<std::array<double, 5>>();
    return {n[0], n[1], n[2], n[3], n[4]};
}

Json to_json(const Sighting& ball) {
    Json json = {
        {"outline", to_json(ball.outline)},
        {"deviation", {ball.centre_deviation.x, ball.centre_deviation.y, ball.radius_deviation}},
        {"confidence", ball.confidence},
        {"visible_rim", ball.visible_rim},
        {"lens_blur", ball.lens_blur},
        {"sure", ball.sure}};
    if (ball.motion.length2() > 0) json["motion"] = {ball.motion.x, ball.motion.y};
    if (ball.focal) json["focal_px"] = {ball.focal->focal, ball.focal->deviation};
    return json;
}

Sighting sighting_from(const Json& json) {
    Sighting ball;
    ball.outline = outline_from(json.at("outline"));
    const auto deviation = json.at("deviation").get<std::array<double, 3>>();
    ball.centre_deviation = V2d(deviation[0], deviation[1]);
    ball.radius_deviation = deviation[2];
    ball.confidence = json.at("confidence");
    ball.visible_rim = json.at("visible_rim");
    ball.lens_blur = json.at("lens_blur");
    ball.sure = json.at("sure");
    if (json.contains("motion")) {
        const auto motion = json.at("motion").get<std::array<double, 2>>();
        ball.motion = V2d(motion[0], motion[1]);
    }
    if (json.contains("focal_px")) {
        const auto hint = json.at("focal_px").get<std::array<double, 2>>();
        ball.focal = FocalHint{hint[0], hint[1]};
    }
    return ball;
}

Json to_json(const Camera& camera) {
    Json json = {{"principal", {camera.principal.x, camera.principal.y}}};
    if (camera.focal) json["focal_px"] = *camera.focal;
    if (const Distortion& lens = camera.distortion; !lens.none())
        json["distortion"] = {lens.k1, lens.k2, lens.k3};
    return json;
}

Camera camera_from(const Json& json) {
    Camera camera;
    const auto principal = json.at("principal").get<std::array<double, 2>>();
    camera.principal = V2d(principal[0], principal[1]);
    if (json.contains("focal_px")) camera.focal = json.at("focal_px").get<double>();
    if (json.contains("distortion")) {
        const auto k = json.at("distortion").get<std::array<double, 3>>();
        camera.distortion = {k[0], k[1], k[2]};
    }
    return camera;
}

}  // namespace

std::string to_line(const TrackRecord& r) {
    Json json = record(kTrack);
    json["frame"] = r.frame;
    json["settings"] = r.settings;
    json["plate"] = r.plate;
    json["there"] = r.there;
    json["readable"] = r.readable;
    if (r.ball) json["ball"] = to_json(*r.ball);
    json["display"] = {r.display.width, r.display.height};
    json["camera"] = to_json(r.camera);
    if (r.distance) json["distance_radii"] = *r.distance;
    json["seconds"] = r.seconds;
    json["message"] = r.message;
    return line_of(json);
}

std::optional<TrackRecord> track_record_from(std::string_view line) {
    return taken(line, kTrack, [](const Json& json) {
        TrackRecord r;
        r.frame = json.at("frame");
        r.settings = json.at("settings");
        r.plate = json.at("plate");
        r.there = json.at("there");
        r.readable = json.at("readable");
        if (json.contains("ball")) r.ball = sighting_from(json.at("ball"));
        const auto display = json.at("display").get<std::array<int, 2>>();
        r.display = {display[0], display[1]};
        r.camera = camera_from(json.at("camera"));
        if (json.contains("distance_radii")) r.distance = json.at("distance_radii").get<double>();
        r.seconds = json.at("seconds");
        r.message = json.at("message");
        return r;
    });
}

std::string to_line(const SolveHead& head) {
    Json json = record(kSolve);
    json["settings"] = head.settings;
    json["steradians"] = head.steradians;
    if (head.focal) json["focal_px"] = *head.focal;
    return line_of(json);
}

std::optional<SolveHead> solve_head_from(std::string_view line) {
    return taken(line, kSolve, [](const Json& json) {
        SolveHead head;
        head.settings = json.at("settings");
        head.steradians = json.at("steradians");
        if (json.contains("focal_px")) head.focal = json.at("focal_px").get<double>();
        return head;
    });
}

std::string to_line(const SolvedFrame& f) {
    Json json = record(kSolved);
    json["frame"] = f.frame;
    json["outcome"] = name_of(f.outcome);
    if (f.outline) json["outline"] = to_json(*f.outline);
    json["piece"] = f.piece;
    json["lens_blur"] = f.lens_blur;
    json["confidence"] = f.confidence;
    if (f.tracked) json["tracked"] = to_json(*f.tracked);
    json["flagged"] = f.flagged;
    json["message"] = f.message;
    return line_of(json);
}

std::optional<SolvedFrame> solved_frame_from(std::string_view line) {
    return taken(line, kSolved, [](const Json& json) {
        SolvedFrame f;
        f.frame = json.at("frame");
        f.outcome = outcome_named(json.at("outcome").get<std::string>()).value();
        if (json.contains("outline")) f.outline = outline_from(json.at("outline"));
        f.piece = json.at("piece");
        f.lens_blur = json.at("lens_blur");
        f.confidence = json.at("confidence");
        if (json.contains("tracked")) f.tracked = outline_from(json.at("tracked"));
        f.flagged = json.at("flagged");
        f.message = json.at("message");
        return f;
    });
}

std::string to_line(const ConvertRecord& r) {
    Json json = record(kConvert);
    json["frame"] = r.frame;
    json["settings"] = r.settings;
    json["written"] = r.written;
    json["seconds"] = r.seconds;
    json["message"] = r.message;
    return line_of(json);
}

std::optional<ConvertRecord> convert_record_from(std::string_view line) {
    return taken(line, kConvert, [](const Json& json) {
        ConvertRecord r;
        r.frame = json.at("frame");
        r.settings = json.at("settings");
        r.written = json.at("written");
        r.seconds = json.at("seconds");
        r.message = json.at("message");
        return r;
    });
}

std::string json_object(const std::vector<std::pair<std::string, std::string>>& values) {
    Json json = Json::object();
    for (const auto& [name, value] : values) json[name] = value;
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::string hash_of(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return fmt::format("{:016x}", hash);
}

}  // namespace chromeball
