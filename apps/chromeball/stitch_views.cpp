#include "stitch_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "camera_choice.h"
#include "color/pixels.h"
#include "core/error.h"
#include "core/luminance.h"
#include "io/read.h"
#include "light/confidence.h"
#include "map_files.h"
#include "map_input.h"
#include "photo_job.h"
#include "refuse.h"

namespace chromeball {
namespace {

/// What a list tells of a view; nothing where it is shorter, or says "-".
std::optional<std::string> told(const std::vector<std::string>& list, std::size_t index) {
    if (index >= list.size() || list[index] == "-") return std::nullopt;
    return list[index];
}

/// photo, or a layout's name.
std::string shape_of(const std::string& file, const std::optional<std::string>& from) {
    if (from) return *from;
    if (std::filesystem::is_directory(file)) return "faces";
    const auto past = provenance_from(read_header(file).metadata);
    return past && find_layout(past->layout) ? past->layout : "photo";
}

/// Of a merged bracket: how sure its exposures made each pixel. Empty where its file has no channel
/// `confidence`.
Image told_trust(const Photo& photo, const Window& region) {
    Image sure = read_confidence(photo.name, std::numeric_limits<std::int64_t>::max(), region);
    if (sure.size() != region.size) return {};
    for (int y = 0; y < sure.height(); ++y)
        for (int i = 0; i < 3 * sure.width(); ++i)
            sure.row(y)[i] = std::max(sure.row(y)[i], kClipped);
    return sure;
}

/// How far a photo's pixels are to be trusted: as its file says, and those of an integer photo that
/// have reached the end of the scale little. Empty where all can be.
Image doubts(const Photo& photo, const Window& region) {
    Image trust = told_trust(photo, region);
    if (is_integer(photo.type)) {
        Image stored(region.size, photo.channels == 2 || photo.channels == 4 ? 4 : 3);
        load_floats(stored_rows(photo, region, 0, region.size.height), stored.view());
        constexpr float kWhite = 0.995F;  // the last of 255 steps, and what a JPEG makes of it
        Image unclipped = trust_of(stored, kWhite);
        for (int y = 0; y < trust.height(); ++y)
            for (int i = 0; i < 3 * trust.width(); ++i)
                unclipped.row(y)[i] = std::min(unclipped.row(y)[i], trust.row(y)[i]);
        trust = std::move(unclipped);
    }
    return any_doubt(trust) ? std::move(trust) : Image();
}

/// Takes what a mask shows bright out of `trust`, of the given part of a picture.
void apply_mask(const std::string& file, Size picture, const Window& region, Image& trust) {
    const Photo mask = read_photo(file);
    if (mask.display != picture)
        throw Error(
            Error::Kind::failed,
            fmt::format("{}: the mask is {}x{} pixels, its view {}x{}; it must be as large", file,
                        mask.display.width, mask.display.height, picture.width, picture.height));
    const Window part = intersection(region, mask.window);
    Image values(part.size, mask.channels == 2 || mask.channels == 4 ? 4 : 3);
    load_floats(stored_rows(mask, part, 0, part.size.height), values.view());
    if (trust.empty()) {
        trust = Image(region.size, 3);
        for (int y = 0; y < region.size.height; ++y)
            std::fill_n(trust.row(y), 3 * static_cast<std::ptrdiff_t>(region.size.width), 1.0F);
    }
    for (int y = 0; y < part.size.height; ++y)
        for (int x = 0; x < part.size.width; ++x)
            if (luminance(values.pixel(x, y)) > 0.5)
                std::fill_n(trust.pixel(x + part.x - region.x, y + part.y - region.y), 3, 0.0F);
}

Image trust_image(const PhotoJob& job, const BallLight& light,
                  const std::optional<std::string>& mask) {
    Image trust = doubts(job.photo, light.region);
    if (mask) apply_mask(*mask, job.photo.display, light.region, trust);
    return trust;
}

std::optional<Rotation> rotation_of(const ViewOptions& o, std::size_t index, const Photo* photo,
                                    const PhotoOptions& options, const Console& console) {
    if (const auto text = told(o.cameras_to_world, index)) {
        MapOptions one;
        one.camera_to_world = text;
        return told_rotation(one);
    }
    return photo ? told_by_file(*photo, options.camera_axes, console) : std::nullopt;
}

/// Of a found outline, pixels.
double likely_deviation(const Candidate& candidate) {
    // Where the background draws the rim off, as its own edges may, the fit does not know of it.
    constexpr double kBias = 0.003;  // of the radius
    return std::hypot(candidate.deviation.a, kBias * candidate.outline.b);
}

void check_list(const std::vector<std::string>& list, const char* option, std::size_t views) {
    if (list.size() > views)
        refuse(fmt::format("{} is given {} times for {} view{}; once a view, in their order",
                           option, list.size(), views, views == 1 ? "" : "s"));
}

}  // namespace

std::optional<Source> trust_source(const PhotoJob& job, const BallLight& light,
                                   const MirrorBall& ball, double lens_blur,
                                   const std::optional<std::string>& mask) {
    const Image trust = trust_image(job, light, mask);
    if (trust.empty()) return std::nullopt;
    return ball_source(trust, ball, light.to_pixels, lens_blur);
}

void ViewInput::change(const BallChange& change) {
    const auto changed = ball_of(*ball, change);
    if (!changed) return;
    view.source = ball_source(pixels_, *changed, to_pixels_, blur_);
    if (!trust_.empty()) view.trust = ball_source(trust_, *changed, to_pixels_, blur_);
    camera = -changed->axis();
    provenance.outline = changed->outline();
    if (provenance.camera && !changed->orthographic()) provenance.camera->focal = changed->focal();
}

void check_view_options(const ViewOptions& o, const std::vector<std::string>& files) {
    check_list(o.from, "--from", files.size());
    check_list(o.balls, "--ball", files.size());
    check_list(o.ellipses, "--ellipse", files.size());
    check_list(o.cameras_to_world, "--camera-to-world", files.size());
    check_list(o.masks, "--mask", files.size());
    for (const std::string& from : o.from)
        if (from != "photo" && from != "-" && !find_layout(from)) refuse(unknown_shape(from));
    for (std::size_t i = 0; i < o.cameras_to_world.size(); ++i) {
        MapOptions one;
        one.camera_to_world = told(o.cameras_to_world, i);
        told_rotation(one);
    }
    for (std::size_t i = 0; i < files.size(); ++i)
        if (told(o.balls, i) && told(o.ellipses, i))
            refuse(
                fmt::format("{}: both --ball and --ellipse are given for it; give one", files[i]));
}

ViewInput read_view(const std::string& file, std::size_t index, const ViewOptions& o,
                    const PhotoOptions& photo_options, const ColorOptions& color,
                    const MapOptions& map, const ColorConfig& colors, const Console& console) {
    ViewInput input;
    input.file = file;
    const std::string shape =
        shape_of(file, o.from.size() == 1 ? o.from.front() : told(o.from, index));
    const auto mask = told(o.masks, index);
    if (shape != "photo") {
        const Layout& layout = *find_layout(shape);
        MapInput read = read_map(file, layout, photo_options.max_pixels, colors, color.input_space);
        tell(read, file, layout, console);
        input.view.source = map_source(read.pixels, layout);
        Image trust = std::move(read.confidence);
        if (mask) apply_mask(*mask, read.pixels.size(), {0, 0, read.pixels.size()}, trust);
        if (!trust.empty()) input.view.trust = map_source(trust, layout);
        input.to_world = rotation_of(o, index, nullptr, photo_options, console);
        // In a map made from a photo its photographer stands where its camera's +Z went.
        if (!std::filesystem::is_directory(file))
            if (const auto past = provenance_from(read_header(file).metadata))
                if (past->rotation && past->outline)
                    if (const auto turned = Rotation::nearest(*past->rotation))
                        input.camera = *turned * V3d(0, 0, 1);
        input.metadata = std::move(read.metadata);
        return input;
    }
    PhotoOptions options = photo_options;
    options.ball = told(o.balls, index);
    options.ellipse = told(o.ellipses, index);
    PhotoJob job = open_photo(file, options, console.watch("searching"));
    // The other views may tell the lens: see the caller.
    std::erase(job.warnings, unknown_lens_warning(file));
    const MirrorBall ball = seen_ball(job, options.threshold, console);
    const double blur = lens_blur(job);
    BallLight light = ball_light(job, ball, blur, options.cropped, color, map, colors, true);
    tell(light, job.photo, console);
    input.to_world = rotation_of(o, index, &job.photo, options, console);
    input.view.source = std::move(light.source);
    input.camera = -ball.axis();
    Image trust = trust_image(job, light, mask);
    if (!trust.empty()) input.view.trust = ball_source(trust, ball, light.to_pixels, blur);
    // Told outlines are taken as they are; found ones are as good as the ball's surroundings let
    // them be, which is more than the rim itself tells.
    const double deviation = job.ball.candidate ? likely_deviation(*job.ball.candidate) : 0;
    if (deviation > 0 || !job.camera.told) {
        input.ball = BallModel{job.ball.outline, job.camera.camera, job.camera.told, deviation};
        input.pixels_ = std::move(light.pixels);
        input.to_pixels_ = light.to_pixels;
        input.blur_ = blur;
        input.trust_ = std::move(trust);
    }
    input.provenance.outline = ball.outline();
    input.provenance.camera = job.camera.camera;
    input.metadata = pass_through(job.photo.metadata);
    return input;
}

}  // namespace chromeball
