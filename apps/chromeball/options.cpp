#include "options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>

#include "io/threads.h"

namespace chromeball {

UsedThreads::UsedThreads(const CommonOptions& options) : limit_(options.threads) {
    set_coding_threads(options.threads);
}

std::string comma_list(const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return list;
}

CLI::Validator finite() {
    return {[](std::string& text) {
                double value = 0;
                if (CLI::detail::lexical_cast(text, value) && !std::isfinite(value))
                    return fmt::format("{} is no finite number", text);
                return std::string();
            },
            "", "finite"};
}

void add_common_options(CLI::App& command, CommonOptions& options) {
    command.add_flag("--quiet", options.quiet,
                     "No progress and no remarks on stderr; errors and warnings stay");
    command.add_option("--threads", options.threads, "Worker threads; 0: one a processor")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
}

void add_color_options(CLI::App& command, ColorOptions& options) {
    command
        .add_option("--ocio", options.ocio,
                    "OpenColorIO config (default: $OCIO, else the built-in one)")
        ->type_name("FILE")
        ->group("Colour");
    command
        .add_option(
            "--input-space", options.input_space,
            "Colour space of the input (default: the file's tag, else the config's file rules)")
        ->type_name("SPACE")
        ->group("Colour");
}

void add_photo_options(CLI::App& command, PhotoOptions& options) {
    const std::string ball = "Ball (pixels of the upright photo; default: found by itself)";
    command.add_option("--ball", options.ball, "Its outline, a circle")
        ->type_name("CX,CY,R")
        ->group(ball);
    command
        .add_option(
            "--ellipse", options.ellipse,
            "Its outline, an ellipse: semi-axes and the long one's angle from +x towards +y (down)")
        ->type_name("CX,CY,A,B,DEG")
        ->group(ball);
    command
        .add_flag("--cropped", options.cropped,
                  "The photo is the ball cut out: it touches the four edges")
        ->group(ball);
    command
        .add_option("--threshold", options.threshold,
                    "Confidence from which on a ball counts as found")
        ->check(finite())
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str()
        ->group(ball);
    command.add_option("--near", options.near, "Of several balls the one that holds this place")
        ->type_name("X,Y")
        ->group(ball);
    command
        .add_option("--radius-range", options.radius_range,
                    "Least and greatest radius to look for, pixels")
        ->type_name("MIN,MAX")
        ->group(ball);
    command.add_option("--max-pixels", options.max_pixels, "Refuse larger pictures")
        ->check(CLI::PositiveNumber)
        ->capture_default_str()
        ->group(ball);

    const std::string camera =
        "Camera (default: from the file's EXIF or EXR metadata, else orthographic)";
    command.add_option("--focal-mm", options.focal_mm, "Focal length, mm; goes with --sensor-mm")
        ->check(finite())
        ->check(CLI::PositiveNumber)
        ->group(camera);
    command
        .add_option("--sensor-mm", options.sensor_mm,
                    "Width of the sensor that the photo's width shows, mm")
        ->check(finite())
        ->check(CLI::PositiveNumber)
        ->group(camera);
    command.add_option("--hfov", options.hfov, "Horizontal field of view, degrees")
        ->check(finite())
        ->check(CLI::Range(0.001, 179.999))
        ->group(camera);
    command.add_option("--focal-px", options.focal_px, "Focal length, pixels")
        ->check(finite())
        ->check(CLI::PositiveNumber)
        ->group(camera);
    command
        .add_option("--distance-radii", options.distance_radii,
                    "Distance from camera to ball, ball radii; the focal length follows")
        ->check(finite())
        ->check(CLI::Range(1.0, 1e9))
        ->group(camera);
    command.add_flag("--orthographic", options.orthographic, "The camera is infinitely far away")
        ->group(camera);
    command
        .add_option("--principal", options.principal,
                    "Where the optical axis meets the photo (default: its middle)")
        ->type_name("X,Y")
        ->group(camera);
    const auto term = [&](const char* name, double& value, const char* help) {
        command.add_option(name, value, help)->capture_default_str()->group(camera);
    };
    term("--k1", options.k1,
         "Radial lens distortion as OpenCV (Brown) has it; needs a focal length");
    term("--k2", options.k2, "... of r^4");
    term("--k3", options.k3, "... of r^6");
    command
        .add_option("--sensors", options.sensors,
                    "Table of your own sensors, for EXIF with a focal length and no more: lines "
                    "make,model,width,height with mm")
        ->type_name("FILE.csv")
        ->group(camera);
    command
        .add_option("--camera-axes", options.camera_axes, "Axes of worldToCamera in EXR metadata")
        ->check(CLI::IsMember({"opengl", "opencv", "renderman"}))
        ->capture_default_str()
        ->group(camera);
}

}  // namespace chromeball
