#include "io/sensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/names.h"

namespace chromeball {
namespace {

bool begins_with(std::string_view text, std::string_view beginning) {
    const auto same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) ==
               std::tolower(static_cast<unsigned char>(b));
    };
    return text.size() >= beginning.size() &&
           std::equal(beginning.begin(), beginning.end(), text.begin(), same);
}

std::string_view cut(std::string_view& rest, char at) {
    const auto end = rest.find(at);
    const std::string_view part = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    return part;
}

std::optional<double> millimetres(std::string_view text) {
    while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
    while (text.starts_with(' ')) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value > 0.5 && value < 200))
        return std::nullopt;
    return value;
}

std::optional<Sensor> parse_row(std::string_view line) {
    Sensor sensor;
    sensor.make = cut(line, ',');
    sensor.model = cut(line, ',');
    const auto width = millimetres(cut(line, ',')), height = millimetres(cut(line, ','));
    if (sensor.make.empty() || sensor.model.empty() || !width || !height || !line.empty())
        return std::nullopt;
    sensor.width_mm = *width;
    sensor.height_mm = *height;
    return sensor;
}

}  // namespace

std::vector<Sensor> parse_sensors(std::string_view text, const std::string& file) {
    std::vector<Sensor> sensors;
    for (int number = 1; !text.empty(); ++number) {
        std::string_view line = cut(text, '\n');
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (line.empty() || line.starts_with('#')) continue;
        const auto sensor = parse_row(line);
        if (!sensor)
            throw Error(Error::Kind::failed,
                        fmt::format("{}: line {}, \"{}\": expected make,model,width,height with "
                                    "millimetres, as in NIKON,NIKON D750,35.9,24.0",
                                    file, number, excerpt(line)));
        sensors.push_back(*sensor);
    }
    return sensors;
}

std::vector<Sensor> sensors_with(const std::optional<std::string>& file) {
    std::vector<Sensor> sensors;
    if (file) {
        std::ifstream stream(*file);
        const std::string text{std::istreambuf_iterator<char>(stream),
                               std::istreambuf_iterator<char>()};
        if (!stream || text.empty())
            throw Error(
                Error::Kind::failed,
                fmt::format("{}: this table of sensors cannot be read, or is empty", *file));
        sensors = parse_sensors(text, *file);
    }
    const auto built_in = parse_sensors(built_in_sensors(), "data/sensors.csv");
    sensors.insert(sensors.end(), built_in.begin(), built_in.end());
    return sensors;
}

const Sensor* find_sensor(const std::vector<Sensor>& sensors, std::string_view make,
                          std::string_view model) {
    const Sensor* best = nullptr;
    for (const Sensor& sensor : sensors)
        if (begins_with(make, sensor.make) && begins_with(model, sensor.model) &&
            (!best || sensor.model.size() > best->model.size()))
            best = &sensor;
    return best;
}

}  // namespace chromeball
