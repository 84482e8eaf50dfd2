#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <memory>
#include <numbers>

#include "bracket.h"
#include "color/color.h"
#include "commands.h"
#include "console.h"
#include "grey_job.h"
#include "io/read.h"
#include "io/write.h"
#include "map_files.h"
#include "numbers.h"
#include "options.h"
#include "photo_job.h"
#include "reflectance_option.h"
#include "refuse.h"
#include "report.h"
#include "resample/source.h"

namespace chromeball {
namespace {

struct CalibrateOptions {
    std::string ball, grey, output;
    std::optional<std::string> card;
    std::string normal = "0,0,1";
    std::optional<std::string> material;
    GreyOptions grey_options;
    PhotoOptions photo;
    CommonOptions common;
    ColorOptions color;
};

void check_words(const CalibrateOptions& o) {
    if (o.card.has_value() == o.grey_options.ball.has_value())
        refuse(
            "calibrate: give --card X,Y,W,H or --grey-ball X,Y,R, whichever is in the grey photo");
    check_grey_options(o.grey_options);
    if (o.material && !find_ball_material(*o.material)) parse_reflectance(*o.material);
    check_not_input(o.output, o.ball);
    check_not_input(o.output, o.grey);
    check_target(o.output);
}

/// How many times more light the grey photo was given than the ball's.
double exposure_ratio(const CalibrateOptions& o, const Photo& ball, const Photo& grey,
                      const Console& console) {
    if (o.ball == o.grey) return 1;
    const auto one = exposure_of(tags_of(ball.metadata)),
               other = exposure_of(tags_of(grey.metadata));
    if (one && other) return *other / *one;
    console.warn(
        fmt::format("{}: the photos do not both tell their exposures; taken as exposed "
                    "alike",
                    one ? o.grey : o.ball));
    return 1;
}

/// What the probe's irradiance has to be multiplied with to light the grey as it is, a channel.
struct Share {
    std::array<double, 3> value{};
    double residual = 0;
    std::size_t pixels = 0;
};

Share share_of_ball(const CalibrateOptions& o, const BallPicture& mirror, const Photo& grey,
                    const Camera& camera, const std::string& space, double level,
                    const ColorConfig& colors) {
    GreyPicture picture;
    load_grey_ball(grey, camera, *o.grey_options.ball, space, level, colors, picture);
    GreyBallOptions options;
    options.reflectance = parse_albedo("--grey-reflectance", o.grey_options.reflectance);
    options.solve_reflectance = true;
    const std::vector<char> none(mirror.pixels->size().pixels());
    const GreyBallFit fit =
        solve_missing_light(mirror, none, picture.picture, picture.usable, options);
    if (fit.pixels == 0)
        refuse(fmt::format("--grey-ball {}: shows too little that is neither clipped nor rim",
                           *o.grey_options.ball));
    Share share{{}, fit.residual, fit.pixels};
    for (std::size_t c = 0; c < 3; ++c)
        share.value[c] = fit.reflectance[c] / options.reflectance[c];
    return share;
}

Share share_of_card(const CalibrateOptions& o, const BallPicture& mirror, const Photo& grey,
                    const std::string& space, double level, const ColorConfig& colors) {
    const auto n = parse_numbers("--card", *o.card, {4}, "X,Y,W,H");
    const Window card{static_cast<int>(n[0]),
                      static_cast<int>(n[1]),
                      {static_cast<int>(n[2]), static_cast<int>(n[3])}};
    const Window& all = grey.window;
    if (card.size.width < 1 || card.size.height < 1 || card.x < all.x || card.y < all.y ||
        card.x + card.size.width > all.x + all.size.width ||
        card.y + card.size.height > all.y + all.size.height)
        refuse(fmt::format("--card {}: is not inside {}, which is {}x{} pixels", *o.card, grey.name,
                           grey.display.width, grey.display.height));
    const auto normal = parse_numbers("--normal", o.normal, {3}, "X,Y,Z");
    const V3d facing(normal[0], normal[1], normal[2]);
    if (!(facing.length() > 0)) refuse(fmt::format("--normal {}: has no direction", o.normal));
    const auto clipped = clipped_pixels(grey, card, level);
    if (std::ranges::count(clipped, char{1}) * 20 > static_cast<std::ptrdiff_t>(clipped.size()))
        refuse(fmt::format("--card {}: the card is clipped in {}; take a shorter exposure", *o.card,
                           grey.name));
    const Image pixels = colors.to_working(grey, space, card);
    std::array<double, 3> mean{}, square{};
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x)
            for (std::size_t c = 0; c < 3; ++c) {
                const auto v = static_cast<double>(pixels.pixel(x, y)[c]);
                mean[c] += v, square[c] += v * v;
            }
    const auto albedo = parse_albedo("--grey-reflectance", o.grey_options.reflectance);
    const auto light = irradiance_from(mirror, facing);
    Share share;
    share.pixels = pixels.size().pixels();
    const auto count = static_cast<double>(share.pixels);
    for (std::size_t c = 0; c < 3; ++c) {
        mean[c] /= count;
        share.value[c] = mean[c] / (albedo[c] / std::numbers::pi * light[c]);
        const double spread = std::sqrt(std::max(0.0, square[c] / count - mean[c] * mean[c]));
        share.residual = std::max(share.residual, spread / mean[c]);
    }
    return share;
}

/// How many pixels of the mirror ball are clipped.
std::size_t clipped_on_ball(const Photo& photo, const MirrorBall& ball, const BallLight& light,
                            double level) {
    const auto flags = clipped_pixels(photo, light.region, level);
    const Affine to_ball = light.to_pixels.inverse();
    std::size_t count = 0, i = 0;
    for (int y = 0; y < light.region.size.height; ++y)
        for (int x = 0; x < light.region.size.width; ++x, ++i)
            count += flags[i] && ball.to_direction(to_ball(V2d(x + 0.5, y + 0.5)));
    return count;
}

void run_calibrate(const CalibrateOptions& o) {
    const Console console(o.common.quiet);
    const UsedThreads threads(o.common);
    check_words(o);
    const ColorConfig colors = ColorConfig::load(o.color.ocio);
    if (o.color.input_space) colors.space(*o.color.input_space);

    PhotoJob job = open_photo(o.ball, o.photo, console.watch("searching"));
    const MirrorBall ball = seen_ball(job, o.photo.threshold, console);
    check_not_undone(job.photo);
    const Reflectance reflectance = o.material ? parse_reflectance(*o.material) : Reflectance();
    MapOptions map;
    map.reflectance = o.material;
    const BallLight light = ball_light(job, ball, 0, false, o.color, map, colors, true);
    const auto photo = std::make_shared<const Photo>(job.photo);
    const double level = clipped_from(photo, o.grey_options.clip);
    const std::size_t clipped = clipped_on_ball(job.photo, ball, light, level);
    if (clipped > 0)
        console.warn(
            fmt::format("{}: {} pixels of the ball are clipped; the light that they lack "
                        "makes the ball seem darker than it is: merge several exposures",
                        o.ball, clipped));

    const Photo grey =
        o.grey == o.ball ? job.photo : read_photo(o.grey, {.max_pixels = o.photo.max_pixels});
    const std::string space = colors.input_space(grey, o.color.input_space);
    const double grey_level =
        clipped_from(std::make_shared<const Photo>(grey), o.grey_options.clip);
    const BallPicture mirror{&light.pixels, ball, light.to_pixels};
    const Share share =
        o.card ? share_of_card(o, mirror, grey, space, grey_level, colors)
               : share_of_ball(o, mirror, grey, job.camera.camera, space, grey_level, colors);

    const double ratio = exposure_ratio(o, job.photo, grey, console);
    CalibrateReport report{reflectance, o.material.value_or(""), o.ball,
                           o.grey,      share.residual,          share.pixels};
    for (std::size_t c = 0; c < 3; ++c) report.reflectance.factor[c] *= ratio / share.value[c];
    const auto& found = report.reflectance.factor;
    if (!reflectance_from_json(to_json(report)))
        throw Error(
            Error::Kind::failed,
            fmt::format("{}: would give back {:.3f} {:.3f} {:.3f} of the light, which no "
                        "mirror does; check the grey's place and --grey-reflectance {}, and "
                        "that both photos show the same light",
                        o.ball, found[0], found[1], found[2], o.grey_options.reflectance));
    write_file(o.output, to_json(report));
    console.say(fmt::format(
        "{}: reflectance {:.3f} {:.3f} {:.3f}{} ({} pixels of grey, spread "
        "{:.1f} %)",
        o.output, found[0], found[1], found[2], o.material ? " of " + *o.material : std::string(),
        share.pixels, 100 * share.residual));
}

}  // namespace

void add_calibrate(CLI::App& app) {
    auto o = std::make_shared<CalibrateOptions>();
    o->photo.all_rows = true;
    auto* command = app.add_subcommand(
        "calibrate", "Measure what a mirror ball gives back, by a grey card or ball beside it");
    command->add_option("--ball", o->ball, "Photo of the mirror ball; better a merged bracket")
        ->type_name("PHOTO")
        ->required();
    command
        ->add_option("--grey", o->grey,
                     "Photo of the grey card or ball in the same place; may be the same photo")
        ->type_name("PHOTO")
        ->required();
    command->add_option("-o,--output", o->output, "File for --reflectance to read")
        ->type_name("FILE.json")
        ->required();
    const std::string grey = "Grey";
    command->add_option("--card", o->card, "Where the card is in the grey photo, pixels")
        ->type_name("X,Y,W,H")
        ->group(grey);
    command
        ->add_option("--normal", o->normal,
                     "Which way the card faces, in the camera's frame; 0,0,1 is towards the camera")
        ->type_name("X,Y,Z")
        ->capture_default_str()
        ->group(grey);
    command->add_option("--grey-ball", o->grey_options.ball, "Or where the grey ball is, pixels")
        ->type_name("X,Y,R")
        ->group(grey);
    command
        ->add_option("--grey-reflectance", o->grey_options.reflectance,
                     "What the grey gives back, 0 to 1")
        ->type_name("R|R,G,B")
        ->capture_default_str()
        ->group(grey);
    const std::string mirror = "Mirror ball";
    command
        ->add_option(
            "--material", o->material,
            "More at grazing angles, as chromium, nickel, steel, aluminium or silver; what is "
            "measured is then a factor of it (default: the same at all angles)")
        ->type_name("NAME")
        ->group(mirror);
    command
        ->add_option("--ball-at", o->photo.ball, "Its outline, pixels (default: found by itself)")
        ->type_name("CX,CY,R")
        ->group(mirror);
    const std::string camera = "Camera (default: from the file's EXIF or EXR metadata)";
    command->add_option("--focal-mm", o->photo.focal_mm, "Focal length, mm; goes with --sensor-mm")
        ->check(CLI::PositiveNumber)
        ->group(camera);
    command->add_option("--sensor-mm", o->photo.sensor_mm, "Width of the sensor, mm")
        ->check(CLI::PositiveNumber)
        ->group(camera);
    command->add_option("--focal-px", o->photo.focal_px, "Focal length, pixels")
        ->check(CLI::PositiveNumber)
        ->group(camera);
    command->add_flag("--orthographic", o->photo.orthographic, "The camera is infinitely far away")
        ->group(camera);
    command
        ->add_option("--clip", o->grey_options.clip,
                     "Stored number from which on photos are clipped (default: where numbers "
                     "pile up)")
        ->check(CLI::PositiveNumber);
    add_color_options(*command, o->color);
    add_common_options(*command, o->common);
    command->footer(
        "Examples:\n"
        "  chromeball calibrate --ball merged.exr --grey merged.exr --card 410,220,60,60 -o "
        "ball.json\n"
        "  chromeball convert plate.exr --reflectance ball.json -o probe.exr");
    command->callback([o] { run_calibrate(*o); });
}

}  // namespace chromeball
