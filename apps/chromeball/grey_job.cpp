#include "grey_job.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>

#include "bracket.h"
#include "color/pixels.h"
#include "numbers.h"
#include "reflectance_option.h"
#include "refuse.h"
#include "resample/source.h"

namespace chromeball {
namespace {

Outline circle_of(const std::string& text) {
    const auto n = parse_numbers("--grey-ball", text, {3}, "X,Y,R");
    if (!(n[2] > 0)) refuse(fmt::format("--grey-ball {}: the radius must be above 0", text));
    return {n[0], n[1], n[2], n[2], 0};
}

GreyBallOptions grey_ball_options(const GreyOptions& o) {
    GreyBallOptions options;
    options.reflectance = parse_albedo("--grey-reflectance", o.reflectance);
    return options;
}

/// The ball that a circle is, seen by the camera of the photo.
MirrorBall ball_at(const Outline& circle, const Camera& camera) {
    if (camera.orthographic()) return MirrorBall(circle);
    return {camera, cone_of(circle, camera)};
}

void tell(const GreyBallFit& fit, const std::string& name, const GreyOptions& o,
          const Console& console) {
    if (fit.regions.empty()) {
        console.warn(
            fmt::format("{}: nothing on the mirror ball is clipped, so that the grey ball "
                        "has nothing to add; --clip says from which number on it is",
                        name));
    }
    for (const ClippedRegion& region : fit.regions)
        console.say(fmt::format(
            "{}: clipped at direction {:.3f},{:.3f},{:.3f}, {:.2g} sr: {:.4g} {:.4g} {:.4g} more "
            "radiance",
            name, region.direction.x, region.direction.y, region.direction.z, region.steradians,
            region.missing[0], region.missing[1], region.missing[2]));
    console.say(
        fmt::format("{}: grey ball explained to {:.1f} % ({:.1f} % before), reflectance "
                    "{:.3f} {:.3f} {:.3f}",
                    name, 100 * fit.residual, 100 * fit.residual_before, fit.reflectance[0],
                    fit.reflectance[1], fit.reflectance[2]));
    constexpr double kPoor = 0.1;
    if (fit.residual > kPoor)
        console.warn(
            fmt::format("{}: the light found explains the grey ball to {:.0f} % only; check "
                        "--grey-ball {} and --grey-reflectance {}",
                        name, 100 * fit.residual, *o.ball, o.reflectance));
}

}  // namespace

void add_grey_options(CLI::App& command, GreyOptions& o) {
    const std::string grey = "Clipped light";
    command
        .add_option("--grey-ball", o.ball,
                    "A diffuse ball beside the mirror ball, pixels: the light that clipped lamps "
                    "and suns lack is solved from it")
        ->type_name("X,Y,R")
        ->group(grey);
    command
        .add_option("--grey-reflectance", o.reflectance, "What the grey ball gives back, 0 to 1")
        ->type_name("R|R,G,B")
        ->capture_default_str()
        ->group(grey);
    command
        .add_option("--clip", o.clip,
                    "Stored number from which on the photo is clipped (default: where its "
                    "numbers pile up; 0.985 of integers)")
        ->check(CLI::PositiveNumber)
        ->group(grey);
}

void check_grey_options(const GreyOptions& o) {
    if (o.ball) circle_of(*o.ball);
    grey_ball_options(o);
}

void load_grey_ball(const Photo& photo, const Camera& camera, const std::string& circle,
                    const std::string& space, double level, const ColorConfig& colors,
                    GreyPicture& picture) {
    const Outline outline = circle_of(circle);
    const Window region = needed_window(outline, photo.window);
    if (region.size.width <= 0 || region.size.height <= 0)
        refuse(fmt::format("--grey-ball {}: lies outside {}, which is {}x{} pixels", circle,
                           photo.name, photo.display.width, photo.display.height));
    picture.pixels = colors.to_working(photo, space, region);
    picture.usable = clipped_pixels(photo, region, level);
    for (char& flag : picture.usable) flag = !flag;
    picture.picture = {&picture.pixels, ball_at(outline, camera), shift(-region.x, -region.y)};
}

double clipped_from(const std::shared_ptr<const Photo>& photo, const std::optional<double>& clip) {
    if (clip) return *clip;
    const ExposedPhoto one = exposed(photo, {}, false);
    const bool integers = is_integer(photo->type);
    const double level = clip_level({&one, 1}, integers);
    return integers ? 0.985 * level : 0.999 * level;
}

std::vector<char> clipped_pixels(const Photo& photo, const Window& region, double level) {
    const Window inside = intersection(region, photo.window);
    const int channels = photo.channels == 2 || photo.channels == 4 ? 4 : 3;
    Image stored(inside.size, channels);
    const StoredRows rows = stored_rows(photo, inside, 0, inside.size.height);
    load_floats(rows, stored.view());
    std::vector<char> clipped;
    clipped.reserve(inside.size.pixels());
    for (int y = 0; y < inside.size.height; ++y)
        for (int x = 0; x < inside.size.width; ++x) {
            const float* p = stored.pixel(x, y);
            clipped.push_back(static_cast<double>(std::max({p[0], p[1], p[2]})) >= level);
        }
    return clipped;
}

BallStep grey_ball_step(const GreyOptions& o, const PhotoJob& job, const MirrorBall& ball,
                        const ColorConfig& colors, const Console& console) {
    if (!o.ball) return nullptr;
    return [&](BallLight& light) {
        const std::shared_ptr<const Photo> photo(&job.photo, [](const Photo*) {});
        const double level = clipped_from(photo, o.clip);
        GreyPicture grey;
        load_grey_ball(job.photo, job.camera.camera, *o.ball, light.space, level, colors, grey);
        const BallPicture mirror{&light.pixels, ball, light.to_pixels};
        const GreyBallFit fit =
            solve_missing_light(mirror, clipped_pixels(job.photo, light.region, level),
                                grey.picture, grey.usable, grey_ball_options(o));
        if (fit.pixels == 0)
            refuse(fmt::format("--grey-ball {}: shows too little that is neither clipped nor rim",
                               *o.ball));
        tell(fit, job.photo.name, o, console);
        add_missing_light(light.pixels, fit);
    };
}

}  // namespace chromeball
