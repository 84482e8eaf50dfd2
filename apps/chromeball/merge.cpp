#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "bracket.h"
#include "camera_choice.h"
#include "color/color.h"
#include "commands.h"
#include "console.h"
#include "core/parallel.h"
#include "io/facts.h"
#include "io/write.h"
#include "light/merge.h"
#include "light/response.h"
#include "map_files.h"
#include "map_job.h"
#include "merge_exposures.h"
#include "merge_place.h"
#include "options.h"
#include "reflectance_option.h"
#include "refuse.h"
#include "report.h"
#include "version.h"

namespace chromeball {
namespace {

struct MergeOptions {
    std::vector<std::string> photos;
    std::string output;
    std::optional<std::string> times;
    std::string response = "auto";
    std::optional<std::string> anchor;
    std::optional<std::string> ball;
    bool no_align = false;
    bool full_float = false;
    bool json = false;
    std::int64_t max_pixels = 400'000'000;
    std::optional<std::string> output_space;
    std::optional<std::string> reflectance;
    CommonOptions common;
    ColorOptions color;
};

/// "0.5", "1/125": seconds.
double seconds_of(const std::string& text, const std::string& all) {
    double parts[2] = {0, 1};
    const std::size_t slash = text.find('/');
    const auto number = [&](const std::string& word, double& value) {
        return CLI::detail::lexical_cast(word, value) && std::isfinite(value) && value > 0;
    };
    if (!number(text.substr(0, slash), parts[0]) ||
        (slash != std::string::npos && !number(text.substr(slash + 1), parts[1])))
        refuse(
            fmt::format("--times {}: \"{}\" is no time; give seconds, as 0.5 or 1/125, one a "
                        "photo with commas between",
                        all, text));
    return parts[0] / parts[1];
}

std::vector<double> times_of(const MergeOptions& o) {
    std::vector<double> times;
    if (!o.times) return times;
    std::string rest = *o.times;
    for (std::size_t comma = 0; comma != std::string::npos;) {
        comma = rest.find(',');
        times.push_back(seconds_of(rest.substr(0, comma), *o.times));
        if (comma != std::string::npos) rest = rest.substr(comma + 1);
    }
    if (times.size() != o.photos.size())
        refuse(fmt::format("--times {}: {} times for {} photos; give one a photo, in their order",
                           *o.times, times.size(), o.photos.size()));
    return times;
}

FileFormat check_words(const MergeOptions& o) {
    if (o.photos.size() < 2)
        refuse(
            fmt::format("{}: one photo is no bracket; name two or more exposures of the same "
                        "view (convert takes a single photo as it is)",
                        o.photos.front()));
    for (std::size_t a = 0; a < o.photos.size(); ++a)
        for (std::size_t b = a + 1; b < o.photos.size(); ++b)
            if (o.photos[a] == o.photos[b])
                refuse(fmt::format("{}: is named twice; each exposure counts once", o.photos[a]));
    const auto format = format_from_extension(std::filesystem::path(o.output).extension().string());
    const bool fits = format && (*format == FileFormat::exr || *format == FileFormat::hdr ||
                                 (*format == FileFormat::tif && o.full_float));
    if (!fits)
        refuse(
            fmt::format("-o {}: the merged photo is scene-linear light; name an .exr, a .hdr, or "
                        "a .tif with --float",
                        o.output));
    if (o.full_float && *format == FileFormat::hdr)
        refuse(fmt::format("-o {}: HDR files have no 32-bit floats; leave --float out", o.output));
    for (const std::string& photo : o.photos) check_not_input(o.output, photo);
    if (o.reflectance) parse_reflectance(*o.reflectance);
    check_target(o.output);
    return *format;
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void to_working(Image& pixels, const std::array<double, 9>& matrix) {
    std::array<float, 9> m{};
    std::ranges::transform(matrix, m.begin(), [](double v) { return static_cast<float>(v); });
    for_each_band(pixels.height(), 32, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < pixels.width(); ++x) {
                float* p = pixels.pixel(x, y);
                const float rgb[] = {p[0], p[1], p[2]};
                for (std::size_t r = 0; r < 3; ++r)
                    p[r] = m[3 * r] * rgb[0] + m[3 * r + 1] * rgb[1] + m[3 * r + 2] * rgb[2];
            }
    });
}

/// Paths as given; of absolute ones the names alone.
std::string sources_of(const std::vector<std::string>& photos) {
    std::string all;
    for (const std::string& photo : photos)
        all += (all.empty() ? "" : " ") +
               (photo.starts_with('/') ? photo.substr(photo.rfind('/') + 1) : photo);
    return all;
}

/// Takes the mirror's own tint out of the ball; what is around it stays as it is.
void undo_in_ball(const MergeOptions& o, Image& pixels, const Bracket& bracket, int reference,
                  const std::optional<Outline>& outline, const Console& console) {
    for (const auto& photo : bracket.photos) check_not_undone(*photo);
    if (!outline)
        throw Error(
            Error::Kind::no_ball,
            fmt::format("--reflectance {}: no mirror ball was found in these photos to undo "
                        "it in; tell it with --ball CX,CY,R, or give --reflectance to "
                        "convert, later",
                        *o.reflectance));
    const Camera camera = choose_camera({}, *bracket.photos[at(reference)]).camera;
    const MirrorBall ball = camera.orthographic() ? MirrorBall(*outline)
                                                  : MirrorBall(camera, cone_of(*outline, camera));
    undo_reflectance(pixels, ball, {}, parse_reflectance(*o.reflectance), true);
    console.say(
        fmt::format("{}: the mirror's reflectance is undone inside --ellipse "
                    "{:.2f},{:.2f},{:.2f},{:.2f},{:.2f}",
                    o.output, outline->cx, outline->cy, outline->a, outline->b, outline->angle));
}

WriteReport write(const MergeOptions& o, FileFormat format, Image pixels, const Bracket& bracket,
                  int reference, const std::optional<Outline>& ball, const Anchor& anchor,
                  const ColorConfig& colors, const Console& console) {
    to_working(pixels, bracket.to_working);
    if (o.reflectance) undo_in_ball(o, pixels, bracket, reference, ball, console);
    Image rgb = colors_of(pixels);
    const std::string space = colors.output_space(o.output_space, true);
    colors.from_working(rgb, space);
    pixels = joined(rgb, &pixels, nullptr);
    const Photo& photo = *bracket.photos[at(reference)];
    WriteOptions options;
    options.format = format;
    options.full_float = o.full_float;
    options.confidence = true;
    options.color = colors.tag(space);
    options.metadata = pass_through(photo.metadata);
    for (const Attribute& fact : anchor.metadata.all()) options.metadata.set(fact);
    Provenance origin;
    origin.version = kVersion;
    origin.source = sources_of(o.photos);
    origin.outline = ball;
    if (o.reflectance) origin.reflectance = *o.reflectance;
    const CameraChoice camera = choose_camera({}, photo);
    if (camera.told && camera.note.empty()) origin.camera = camera.camera;
    options.metadata.set(to_attribute(origin));
    return write_image(o.output, pixels.view(), options);
}

void tell_result(const MergeOptions& o, const Bracket& bracket, const Merged& merged,
                 const Console& console) {
    const auto all = merged.pixels.size().pixels();
    if (merged.clipped_everywhere == all || merged.black_everywhere == all)
        throw Error(Error::Kind::failed,
                    fmt::format("{}: every pixel is {} in all exposures, so that there is nothing "
                                "to merge; take {} exposures",
                                o.output, merged.clipped_everywhere == all ? "clipped" : "black",
                                merged.clipped_everywhere == all ? "shorter" : "longer"));
    if (merged.clipped_everywhere > 0)
        console.warn(fmt::format(
            "{}: {} pixels clipped in all exposures, {} of them at {:.0f},{:.0f}: the sun or a "
            "lamp; there the light is what fills the shortest exposure, or more (confidence 0)",
            o.output, merged.clipped_everywhere, merged.brightest_pixels, merged.brightest.x,
            merged.brightest.y));
    if (merged.black_everywhere > 0)
        console.say(fmt::format("{}: {} pixels black in all exposures (confidence 0)", o.output,
                                merged.black_everywhere));
    for (std::size_t k = 0; k < merged.moved.size(); ++k)
        if (merged.moved[k] > 0)
            console.say(
                fmt::format("{}: left out in {:.2f} % of the picture, where something moved",
                            bracket.exposed[k].name, 100 * merged.moved[k]));
}

/// Stops are told against the anchor.
MergeReport report_of(const Bracket& bracket, const Solved& solved,
                      std::span<const MergePhoto> photos, double anchor, const Merged& merged) {
    MergeReport report;
    report.clipped_everywhere = merged.clipped_everywhere;
    report.black_everywhere = merged.black_everywhere;
    report.response = solved.response;
    for (std::size_t k = 0; k < photos.size(); ++k) {
        std::optional<double> told;
        if (bracket.told[k]) told = *bracket.told[k] - anchor;
        report.photos.push_back({bracket.exposed[k].name, std::log2(photos[k].exposure), told,
                                 photos[k].shift.x, photos[k].shift.y, merged.moved[k]});
    }
    return report;
}

void tell_response(const MergeOptions& o, const Solved& solved, const std::vector<double>& stops,
                   const Console& console) {
    console.say(fmt::format("response: {}", solved.words));
    if (std::ranges::max(stops) - std::ranges::min(stops) < 0.1)
        console.warn(
            fmt::format("{}: the photos are exposed alike; noise is averaged, but there is "
                        "no more range than in one of them",
                        o.output));
}

/// Where the photos lie and how they were exposed.
struct Known {
    int reference = 0;
    Placed placed;
    Solved solved;
    std::vector<double> stops;
    std::vector<std::string> left_out;  ///< files, which are no longer in the bracket
};

Known solved_bracket(const MergeOptions& o, Bracket& bracket, const Console& console) {
    std::vector<int> order;
    Known known;
    Placed& placed = known.placed;
    const auto arrange = [&] {
        order = order_of(bracket);
        known.reference = order[(order.size() - 1) / 2];
    };
    const auto place = [&] {
        arrange();
        placed = placed_photos(o.ball, bracket, order, known.reference, console);
    };
    if (o.no_align) {
        arrange();
        placed.moves.assign(bracket.photos.size(), V2d(0, 0));
        if (o.reflectance) placed.balls = alike_balls(o.ball, bracket, known.reference, console);
    } else {
        place();
        known.left_out = leave_out_unlike(bracket, placed, console);
        if (!known.left_out.empty()) place();
    }
    const auto patches = even_patches(bracket.exposed, placed.moves, console.watch("measuring"));
    known.solved = solve(o.response, bracket, patches);
    known.stops = final_stops(bracket, known.solved.fit, console);
    tell_response(o, known.solved, known.stops, console);
    if (!o.no_align) {
        // Once more with what is known now; the order, too.
        std::ranges::stable_sort(order, {}, [&](int k) { return known.stops[at(k)]; });
        place_again(placed, bracket, order, known.reference, known.solved.fit.response, console);
        tell_shifts(bracket, placed.shifts, known.reference, console);
    }
    return known;
}

void run_merge(const MergeOptions& o) {
    const Console console(o.common.quiet);
    const UsedThreads threads(o.common);
    const FileFormat format = check_words(o);
    const std::vector<double> times = times_of(o);
    const ColorConfig colors = ColorConfig::load(o.color.ocio);
    if (o.color.input_space) colors.space(*o.color.input_space);
    if (o.output_space && !colors.is_linear(colors.space(*o.output_space)))
        refuse(fmt::format("--output-space {}: merged light is linear; name a linear space",
                           *o.output_space));
    Bracket bracket =
        read_bracket(o.photos, times, o.color.input_space, o.max_pixels, colors, console);

    const Known known = solved_bracket(o, bracket, console);
    const Anchor anchor = anchor_of(o.anchor, o.photos, bracket, known.stops, known.reference);
    std::vector<MergePhoto> photos;
    for (std::size_t k = 0; k < known.stops.size(); ++k)
        photos.push_back(
            {bracket.exposed[k], std::exp2(known.stops[k] - anchor.stops), known.placed.moves[k]});
    Merged merged = merge(photos, known.solved.fit.response, console.watch("merging"));
    tell_result(o, bracket, merged, console);
    const WriteReport written =
        write(o, format, std::move(merged.pixels), bracket, known.reference,
              merged_ball(known.placed, known.reference), anchor, colors, console);
    if (written.clamped > 0) console.warn(clamp_warning(o.output, written.clamped, format));

    MergeReport report = report_of(bracket, known.solved, photos, anchor.stops, merged);
    report.left_out = known.left_out;
    for (const auto& photo : report.photos)
        console.say(fmt::format("{}: {:+.2f} stops", photo.file, photo.exposure_stops));
    if (o.json) print_result(to_json(report));
}

}  // namespace

void add_merge(CLI::App& app) {
    auto o = std::make_shared<MergeOptions>();
    auto* command =
        app.add_subcommand("merge", "Merge bracketed exposures into one scene-linear photo");
    command->add_option("photos", o->photos, "Two or more exposures of the same view, any order")
        ->required();
    command->add_option("-o,--output", o->output, "File to write: .exr, .hdr, or .tif with --float")
        ->required();
    command->add_flag("--float", o->full_float, "32-bit EXR or TIFF (default: half EXR)");
    command->add_flag("--json", o->json,
                      "Tell exposures, shifts and what is clipped everywhere on stdout");
    command->add_option("--max-pixels", o->max_pixels, "Refuse larger pictures")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    const std::string exposure = "Exposure";
    command
        ->add_option("--times", o->times,
                     "Exposure times, seconds, one a photo, as 1/125,1/30,0.5 (default: EXIF; what "
                     "is missing or wrong there is solved from the pictures)")
        ->type_name("T,T,...")
        ->group(exposure);
    command
        ->add_option("--response", o->response,
                     "srgb: the curve of the input space (sRGB); solve: recovered from the "
                     "pictures; auto: recovered where that fits clearly better")
        ->check(CLI::IsMember({"auto", "srgb", "solve"}))
        ->capture_default_str()
        ->group(exposure);
    command
        ->add_option("--anchor", o->anchor,
                     "What is written as 1: what fills the scale of this photo, or at this EV100 "
                     "(log2(N^2 / seconds x 100 / ISO)); the same for several brackets keeps them "
                     "on one scale (default: the middle exposure)")
        ->type_name("PHOTO|EV100")
        ->group(exposure);
    const std::string alignment = "Alignment";
    command
        ->add_option("--ball", o->ball,
                     "The ball in the middle exposure, pixels; it is what the photos are laid on "
                     "each other by (default: found by itself, else the whole picture)")
        ->type_name("CX,CY,R")
        ->group(alignment);
    command->add_flag("--no-align", o->no_align, "The photos lie on each other already")
        ->group(alignment);
    command
        ->add_option("--output-space", o->output_space,
                     "Linear colour space (default: scene_linear)")
        ->type_name("SPACE")
        ->group("Colour");
    add_reflectance_option(*command, o->reflectance);
    add_color_options(*command, o->color);
    add_common_options(*command, o->common);
    command->footer(
        "Examples:\n"
        "  chromeball merge ball_*.jpg -o ball.exr\n"
        "  chromeball merge a.jpg b.jpg c.jpg --times 1/500,1/60,1/8 --anchor 12 -o ball.exr\n"
        "  chromeball convert ball.exr -o probe.exr");
    command->callback([o] { run_merge(*o); });
}

}  // namespace chromeball
