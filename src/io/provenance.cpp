#include <cmath>
#include <nlohmann/json.hpp>

#include "io/channel_names.h"
#include "io/facts.h"

namespace chromeball {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kName = "chromeball";
constexpr const char* kChannels = "channels";

/// ASCII only, as EXIF demands; a name that is no UTF-8 must not stop the writing.
std::string text_of(const Json& json) {
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

/// No file tells where on a machine the photo lay.
std::string without_folders_if_absolute(const std::string& path) {
    return path.starts_with('/') ? path.substr(path.rfind('/') + 1) : path;
}

Json to_json(const Outline& outline) {
    return {{"cx", outline.cx},
            {"cy", outline.cy},
            {"a", outline.a},
            {"b", outline.b},
            {"angle", outline.angle}};
}

Json to_json(const Camera& camera) {
    Json json = Json::object();
    if (camera.focal) json["focal_px"] = *camera.focal;
    json["principal"] = {camera.principal.x, camera.principal.y};
    if (const Distortion& lens = camera.distortion; !lens.none())
        json["distortion"] = {lens.k1, lens.k2, lens.k3};
    return json;
}

Outline outline_from(const Json& json) {
    return {json.at("cx").get<double>(), json.at("cy").get<double>(), json.at("a").get<double>(),
            json.at("b").get<double>(), json.at("angle").get<double>()};
}

Camera camera_from(const Json& json) {
    Camera camera;
    if (json.contains("focal_px")) camera.focal = json.at("focal_px").get<double>();
    camera.principal = {json.at("principal").at(0).get<double>(),
                        json.at("principal").at(1).get<double>()};
    if (json.contains("distortion")) {
        const auto k = json.at("distortion").get<std::array<double, 3>>();
        camera.distortion = {k[0], k[1], k[2]};
    }
    if (camera.focal && !(*camera.focal > 0)) throw std::domain_error("focal length");
    return camera;
}

Provenance from_json(const Json& json) {
    Provenance provenance;
    provenance.version = json.value("version", "");
    provenance.source = json.value("source", "");
    provenance.layout = json.value("layout", "");
    provenance.reflectance = json.value("reflectance", "");
    provenance.fingerprint = json.value("fingerprint", "");
    if (json.contains("outline")) provenance.outline = outline_from(json.at("outline"));
    if (json.contains("camera")) provenance.camera = camera_from(json.at("camera"));
    if (json.contains("rotation")) {
        if (json.at("rotation").size() != 9) throw std::domain_error("rotation");
        provenance.rotation = json.at("rotation").get<std::array<double, 9>>();
    }
    return provenance;
}

/// The JSON text, wherever a format kept it: EXR and HDR under its name, others as a description.
std::optional<std::string> stored_text(const Metadata& metadata) {
    if (auto text = metadata.text(kName)) return text;
    const auto description = metadata.text("ImageDescription");
    const std::string prefix = std::string(kName) + " {";
    if (!description || !description->starts_with(prefix)) return std::nullopt;
    return description->substr(prefix.size() - 1);
}

}  // namespace

Attribute to_attribute(const Provenance& provenance) {
    Json json = Json::object();
    json["version"] = provenance.version;
    json["source"] = without_folders_if_absolute(provenance.source);
    if (!provenance.layout.empty()) json["layout"] = provenance.layout;
    if (provenance.outline) json["outline"] = to_json(*provenance.outline);
    if (provenance.camera) json["camera"] = to_json(*provenance.camera);
    if (provenance.rotation) json["rotation"] = *provenance.rotation;
    if (!provenance.reflectance.empty())
        json["reflectance"] = without_folders_if_absolute(provenance.reflectance);
    if (!provenance.fingerprint.empty()) json["fingerprint"] = provenance.fingerprint;
    return {kName, "string", {}, text_of(json)};
}

std::optional<Provenance> provenance_from(const Metadata& metadata) {
    const auto text = stored_text(metadata);
    if (!text) return std::nullopt;
    const Json json = Json::parse(*text, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    try {
        return from_json(json);
    } catch (const std::exception&) {  // damaged: as good as none
        return std::nullopt;
    }
}

namespace io {

std::string with_channel_names(const std::string& own, const std::vector<std::string>& names) {
    Json json = Json::parse(own, nullptr, false);
    if (!json.is_object()) json = Json::object();
    json[kChannels] = names;
    return text_of(json);
}

std::vector<std::string> channel_names(const Metadata& metadata) {
    const auto text = stored_text(metadata);
    if (!text) return {};
    const Json json = Json::parse(*text, nullptr, false);
    if (!json.is_object() || !json.contains(kChannels) || !json.at(kChannels).is_array()) return {};
    std::vector<std::string> names;
    for (const Json& name : json.at(kChannels))
        names.push_back(name.is_string() ? name.get<std::string>() : std::string());
    return names;
}

}  // namespace io

}  // namespace chromeball
