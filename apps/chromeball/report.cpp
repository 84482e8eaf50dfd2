#include "report.h"

#include <nlohmann/json.hpp>

#include <numbers>

namespace chromeball {
namespace {

using Json = nlohmann::ordered_json;

/// Three decimals of a pixel are more than anyone measures; directions get six.
double rounded(double value, double steps) { return std::round(value * steps) / steps; }
double pixels(double value) { return rounded(value, 1e4); }

Json json_of(const Outline& e) {
    return {{"cx", pixels(e.cx)},
            {"cy", pixels(e.cy)},
            {"a", pixels(e.a)},
            {"b", pixels(e.b)},
            {"angle", pixels(e.angle)}};
}

Json json_of(const OutlineDeviation& d) {
    return {{"cx", pixels(d.cx)},
            {"cy", pixels(d.cy)},
            {"a", pixels(d.a)},
            {"b", pixels(d.b)},
            {"angle", pixels(d.angle)}};
}

Json motion_of(const V2d& motion) { return {pixels(motion.x), pixels(motion.y)}; }

Json json_of(const Candidate& c) {
    Json j{{"confidence", rounded(c.confidence, 1e4)},
           {"outline", json_of(c.outline)},
           {"outline_deviation", json_of(c.deviation)},
           {"visible_rim", rounded(c.visible_rim, 1e4)}};
    if (c.motion != V2d(0)) j["motion"] = motion_of(c.motion);
    return j;
}

void add_candidates(Json& j, const DetectReport& r) {
    if (r.candidates.empty()) return;
    j["candidates"] = Json::array();
    for (const Candidate& candidate : r.candidates) j["candidates"].push_back(json_of(candidate));
}

Json json_of(const DetectReport& r) {
    Json j{{"photo", r.photo},
           {"width", r.size.width},
           {"height", r.size.height},
           {"found", r.found},
           {"confidence", rounded(r.confidence, 1e4)}};
    if (!r.found) {
        j["reason"] = r.reason;
        j["warnings"] = r.warnings;
        add_candidates(j, r);
        return j;
    }
    const Camera& camera = r.camera.camera;
    const auto or_null = [](const std::optional<double>& value) {
        return value ? Json(rounded(*value, 1e4)) : Json(nullptr);
    };
    j["outline"] = json_of(r.outline);
    if (r.deviation) j["outline_deviation"] = json_of(*r.deviation);
    j["camera"] = {{"focal_px", or_null(camera.focal)},
                   {"principal", {pixels(camera.principal.x), pixels(camera.principal.y)}},
                   {"source", r.camera.source}};
    if (r.camera.deviation) j["camera"]["focal_px_deviation"] = pixels(*r.camera.deviation);
    const V3d& d = r.center_direction;
    j["ball"] = {{"distance_radii", or_null(r.distance)},
                 {"center_direction", {rounded(d.x, 1e8), rounded(d.y, 1e8), rounded(d.z, 1e8)}},
                 {"hidden_half_angle_degrees", rounded(r.hidden_half_angle_degrees, 1e4)}};
    j["visible_rim"] = rounded(r.visible_rim, 1e4);
    if (r.motion != V2d(0)) j["motion"] = motion_of(r.motion);
    j["warnings"] = r.warnings;
    add_candidates(j, r);
    return j;
}

/// File names may hold anything; what is no UTF-8 is replaced rather than thrown at.
std::string text_of(const Json& j, int indent) {
    return j.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string to_json(const std::vector<DetectReport>& reports, bool lines) {
    if (lines) {
        std::string text;
        for (const DetectReport& report : reports) text += text_of(json_of(report), -1) + '\n';
        return text;
    }
    if (reports.size() == 1) return text_of(json_of(reports.front()), 2) + '\n';
    Json all = Json::array();
    for (const DetectReport& report : reports) all.push_back(json_of(report));
    return text_of(all, 2) + '\n';
}

std::string to_json(const MergeReport& r) {
    Json photos = Json::array();
    for (const MergedPhotoReport& p : r.photos) {
        photos.push_back(
            {{"file", p.file},
             {"exposure_stops", rounded(p.exposure_stops, 1e4)},
             {"told_stops", p.told_stops ? Json(rounded(*p.told_stops, 1e4)) : Json(nullptr)},
             {"shift", {rounded(p.shift_x, 1e3), rounded(p.shift_y, 1e3)}},
             {"moved", rounded(p.moved, 1e4)}});
    }
    const Json j{{"photos", photos},
                 {"left_out", r.left_out},
                 {"clipped_everywhere", r.clipped_everywhere},
                 {"black_everywhere", r.black_everywhere},
                 {"response", r.response}};
    return text_of(j, 2) + '\n';
}

std::string to_json(const CalibrateReport& r) {
    Json j{{"reflectance",
            {rounded(r.reflectance.factor[0], 1e5), rounded(r.reflectance.factor[1], 1e5),
             rounded(r.reflectance.factor[2], 1e5)}}};
    if (const auto& constants = r.reflectance.constants) {
        j["material"] = r.material;
        j["n"] = constants->n;
        j["k"] = constants->k;
    }
    j["measured"] = {{"ball", r.ball},
                     {"grey", r.grey},
                     {"residual", rounded(r.residual, 1e4)},
                     {"pixels", r.pixels}};
    return text_of(j, 2) + '\n';
}

std::optional<Reflectance> reflectance_from_json(const std::string& text) {
    const Json j = Json::parse(text, nullptr, false);
    if (!j.is_object()) return std::nullopt;
    try {
        Reflectance r;
        r.factor = j.at("reflectance").get<std::array<double, 3>>();
        if (j.contains("n"))
            r.constants = {j.at("n").get<std::array<double, 3>>(),
                           j.value("k", std::array<double, 3>{})};
        for (std::size_t c = 0; c < 3; ++c) {
            // A factor above 1 is a measurement's error; a tenth more is none any longer.
            const bool good = r.factor[c] > 0 && r.factor[c] <= 1.1 &&
                              (!r.constants || (r.constants->n[c] > 0 && r.constants->k[c] >= 0));
            if (!good || !(r.at(1)[c] > 0)) return std::nullopt;
        }
        return r;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

std::string to_json(const InfoReport& r) {
    Json j{{"file", r.file},         {"width", r.size.width}, {"height", r.size.height},
           {"channels", r.channels}, {"type", r.type},        {"color_space", r.color_space}};
    j["layout"] = r.layout.empty() ? Json(nullptr) : Json(r.layout);
    j["layout_sureness"] = r.layout_sureness;
    j["range_stops"] = r.range_stops ? Json(*r.range_stops) : Json(nullptr);
    j["maximum"] = r.maximum;
    j[r.over_sphere ? "mean_radiance" : "mean_pixel"] = r.mean_radiance;
    j["covered_steradians"] = r.covered_steradians ? Json(*r.covered_steradians) : Json(nullptr);
    j["covered"] =
        r.covered_steradians ? Json(*r.covered_steradians / (4 * std::numbers::pi)) : Json(nullptr);
    j["bad_pixels"] = r.bad_pixels;
    j["provenance"] = r.provenance ? Json::parse(*r.provenance, nullptr, false) : Json(nullptr);
    j["notes"] = r.notes;
    return text_of(j, 2) + '\n';
}

std::string to_json(const StitchReport& r) {
    Json views = Json::array();
    for (const StitchReport::View& view : r.views)
        views.push_back({{"file", view.file},
                         {"rotation", view.rotation},
                         {"exposure_stops", rounded(view.exposure_stops, 1e4)},
                         {"residual_degrees", rounded(view.residual_degrees, 1e4)}});
    return text_of({{"views", views}, {"covered", rounded(r.covered, 1e6)}}, 2) + '\n';
}

}  // namespace chromeball
