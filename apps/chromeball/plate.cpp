#include "plate.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/facts.h"
#include "io/read.h"
#include "photo_job.h"

namespace chromeball {

namespace {

/// The camera and its ball, as the options tell or as they are found.
void find_ball(const std::string& path, const LightOptions& o, const MapOptions& map,
               const Console& console, Plate& plate) {
    PhotoJob job = open_photo(path, o.photo, console.watch("searching"));
    const MirrorBall ball = seen_ball(job, o.photo.threshold, console);
    plate.view = {job.photo.display, job.camera.camera, ball, lens_blur(job)};
    plate.to_world = photo_rotation(map, job.photo, o.photo.camera_axes, console);
}

}  // namespace

Image plate_pixels(const Photo& photo, const ColorOptions& color, const ColorConfig& colors,
                   std::vector<std::string>& warnings) {
    std::string warning;
    const std::string space = colors.input_space(photo, color.input_space, &warning);
    if (!warning.empty()) warnings.push_back(warning);
    std::size_t bad = 0;
    const Image pixels = colors.to_working(photo, space, std::nullopt, &bad);
    if (bad > 0) warnings.push_back(bad_pixel_warning(photo.name, bad));
    Image picture(photo.display, 4);
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x) {
            const int px = x + photo.window.x, py = y + photo.window.y;
            if (px < 0 || py < 0 || px >= photo.display.width || py >= photo.display.height)
                continue;
            float* to = picture.pixel(px, py);
            std::copy_n(pixels.pixel(x, y), 3, to);
            to[3] = pixels.channels() > 3 ? pixels.pixel(x, y)[3] : 1.0F;
        }
    return picture;
}

Plate read_plate(const std::string& path, const LightOptions& o, const Light& light,
                 const MapOptions& map, const ColorConfig& colors, const Console& console) {
    Plate plate;
    if (light.photo && path == o.input) {
        plate.view = *light.photo;
        plate.to_world = light.to_world;
    } else {
        find_ball(path, o, map, console, plate);
    }
    // Of a ball that is told only some rows were read.
    const Photo whole = read_photo(path, {o.photo.max_pixels, std::nullopt});
    plate.metadata = pass_through(whole.metadata);
    std::vector<std::string> warnings;
    plate.pixels = plate_pixels(whole, o.color, colors, warnings);
    for (const std::string& warning : warnings) console.warn(warning);
    return plate;
}

}  // namespace chromeball
