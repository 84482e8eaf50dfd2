#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chromeball {

/// A camera's sensor, as data/sensors.csv and users' own files list them.
struct Sensor {
    std::string make;   ///< the maker's name begins with it, any case
    std::string model;  ///< the model's name begins with it, any case
    double width_mm = 0;
    double height_mm = 0;
};

/// The text of data/sensors.csv, put into the program when it is built.
std::string_view built_in_sensors();

/// Rows `make,model,width,height`; lines that start with # are remarks. Throws Error naming `file`
/// and the line that is none.
std::vector<Sensor> parse_sensors(std::string_view text, const std::string& file);

/// The sensors built in; those of `file`, if any, come first and win.
std::vector<Sensor> sensors_with(const std::optional<std::string>& file);

/// The sensor of a camera: of the rows that fit, the one with the longest model name, the first of
/// those. nullptr where none fits.
const Sensor* find_sensor(const std::vector<Sensor>& sensors, std::string_view make,
                          std::string_view model);

}  // namespace chromeball
