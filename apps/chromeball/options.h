#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>

#include <cstdint>
#include <optional>
#include <string>

#include "core/parallel.h"

namespace chromeball {

/// Of every command.
struct CommonOptions {
    bool quiet = false;
    int threads = 0;  ///< 0: all processors
};

/// --threads for as long as this lives: of our own loops and of the libraries that decode and
/// encode.
class UsedThreads {
public:
    explicit UsedThreads(const CommonOptions& options);

private:
    ThreadLimit limit_;
};

/// How colours are read.
struct ColorOptions {
    std::optional<std::string> ocio;
    std::optional<std::string> input_space;
};

/// Where the ball is and which camera took it; texts as typed, taken apart when the job starts.
struct PhotoOptions {
    std::optional<std::string> ball;
    std::optional<std::string> ellipse;
    bool cropped = false;
    double threshold = 0.4;
    std::optional<std::string> near;  ///< of several balls the one that holds this place
    std::optional<std::string> radius_range;

    std::optional<double> focal_mm;
    std::optional<double> sensor_mm;
    std::optional<double> hfov;
    std::optional<double> focal_px;
    std::optional<double> distance_radii;
    bool orthographic = false;
    std::optional<std::string> principal;
    double k1 = 0, k2 = 0, k3 = 0;  ///< radial distortion
    std::optional<std::string> sensors;
    std::string camera_axes = "opengl";

    std::int64_t max_pixels = 400'000'000;
    bool all_rows = false;  ///< read the whole photo, also where the ball is told
};

void add_common_options(CLI::App& command, CommonOptions& options);
void add_color_options(CLI::App& command, ColorOptions& options);
void add_photo_options(CLI::App& command, PhotoOptions& options);

/// Refuses "nan" and "inf", which ranges let through.
CLI::Validator finite();

/// "a, b, c".
std::string comma_list(const std::vector<std::string>& names);

}  // namespace chromeball
