#include "shot/cameras.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/error.h"
#include "core/names.h"

namespace chromeball {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& file, const std::string& why) {
    throw Error(
        Error::Kind::usage,
        fmt::format("{}: {}; expected {{\"frames\": {{\"1001\": {{\"camera_to_world\": [9 or "
                    "16 numbers], \"focal_px\": F, \"principal\": [x, y]}}}}}}",
                    file, why));
}

int frame_number(const std::string& key, const std::string& file) {
    int number = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), number);
    if (error != std::errc() || end != key.data() + key.size())
        refuse(file, fmt::format("\"{}\" is no frame number", excerpt(key)));
    return number;
}

std::vector<double> numbers(const Json& json) {
    auto values = json.get<std::vector<double>>();
    for (const double value : values)
        if (!std::isfinite(value)) throw std::domain_error("infinite");
    return values;
}

FrameCamera camera_from(const Json& json) {
    FrameCamera camera;
    if (json.contains("camera_to_world")) {
        camera.to_world = Rotation::nearest(numbers(json.at("camera_to_world")));
        if (!camera.to_world)
            throw std::domain_error(
                "its camera_to_world is no rotation (9 or 16 numbers, row by row; columns must be "
                "perpendicular, of length 1, right-handed, to 1e-3)");
    }
    if (json.contains("focal_px")) {
        camera.focal = json.at("focal_px").get<double>();
        if (!(*camera.focal > 0)) throw std::domain_error("its focal_px must be above 0");
    }
    if (json.contains("principal")) {
        const auto p = numbers(json.at("principal"));
        if (p.size() != 2) throw std::domain_error("its principal must be two numbers");
        camera.principal = V2d(p[0], p[1]);
    }
    return camera;
}

}  // namespace

std::map<int, FrameCamera> cameras_from(std::string_view text, const std::string& file) {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("frames") || !json.at("frames").is_object())
        refuse(file, "holds no object \"frames\"");
    std::map<int, FrameCamera> cameras;
    for (const auto& [key, value] : json.at("frames").items()) {
        const int frame = frame_number(key, file);
        try {
            cameras[frame] = camera_from(value);
        } catch (const Json::exception&) {
            refuse(file, fmt::format("frame {} holds something else than numbers", frame));
        } catch (const std::domain_error& e) {
            refuse(file, fmt::format("frame {}: {}", frame, e.what()));
        }
    }
    return cameras;
}

}  // namespace chromeball
