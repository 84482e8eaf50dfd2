#include "light_input.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/error.h"
#include "inspect.h"
#include "io/read.h"
#include "light/fill.h"
#include "map_input.h"
#include "photo_job.h"
#include "resample/resample.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

/// nullptr: a photo.
const Layout* layout_of(const LightOptions& o) {
    if (o.from == "photo") return nullptr;
    if (o.from != "auto") return find_layout(o.from);
    if (fs::is_directory(o.input)) return find_layout("faces");
    if (o.photo.cropped) return nullptr;
    return guess_layout(read_header(o.input, {o.photo.max_pixels, std::nullopt}), nullptr).layout;
}

Light photo_light(const LightOptions& o, const MapOptions& map, const ColorConfig& colors,
                  const Console& console) {
    PhotoJob job = open_photo(o.input, o.photo, console.watch("searching"));
    const MirrorBall ball = seen_ball(job, o.photo.threshold, console);
    const BallLight in_ball =
        ball_light(job, ball, lens_blur(job), o.photo.cropped, o.color, map, colors);
    tell(in_ball, job.photo, console);
    Light light;
    light.space = in_ball.space;
    light.layout = find_layout("latlong");
    light.to_world = photo_rotation(map, job.photo, o.photo.camera_axes, console);
    light.pixels = light_map(in_ball, light.to_world, console.watch("converting"));
    if (!o.photo.cropped)
        light.photo = PhotoView{job.photo.display, job.camera.camera, ball, lens_blur(job)};
    return light;
}

}  // namespace

void check_from(const std::string& from) {
    if (from != "auto" && from != "photo" && !find_layout(from))
        throw Error(Error::Kind::usage, unknown_shape(from));
}

Light read_light(const LightOptions& o, const MapOptions& map, const ColorConfig& colors,
                 const Console& console) {
    const Layout* layout = layout_of(o);
    if (!layout) return photo_light(o, map, colors, console);
    MapInput input = read_map(o.input, *layout, o.photo.max_pixels, colors, o.color.input_space);
    tell(input, o.input, *layout, console);
    // Nothing to be believed is no light to look at, but black it would be one, too.
    if (!input.confidence.empty()) fill_unbelieved(input.pixels, input.confidence, *layout);
    Light light;
    light.pixels = std::move(input.pixels);
    light.confidence = std::move(input.confidence);
    light.layout = layout;
    light.space = input.space;
    light.to_world = told_rotation(map).value_or(Rotation());
    return light;
}

Image light_map(const BallLight& light, const Rotation& to_world, const Watch& watch) {
    const Layout& latlong = *find_layout("latlong");
    // Twice as fine as the ball, so that nothing of it is lost by being looked up again.
    const int size = std::min(4096, 2 * natural_size(light.source, latlong));
    return resample(light.source, latlong, size, {Filter::adaptive, to_world}, watch);
}

std::optional<PhotoView> told_view(const PhotoOptions& options, Size size, const Console& console) {
    if (!options.ball && !options.ellipse) return std::nullopt;
    PhotoJob job;
    job.photo.name = "the picture";
    job.photo.display = size;
    job.photo.window = {0, 0, size};
    job.camera = choose_camera(options, job.photo);
    job.ball.found = true;
    job.ball.outline = told_outline(job.photo, options);
    job.ball.how = options.ball ? "--ball" : "--ellipse";
    job.ball.circle_given = options.ball.has_value();
    const MirrorBall ball = projection_of(job);
    for (const std::string& warning : job.warnings) console.warn(warning);
    return PhotoView{size, job.camera.camera, ball};
}

}  // namespace chromeball
