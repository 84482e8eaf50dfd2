#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "bracket.h"
#include "camera_choice.h"
#include "color/color.h"
#include "commands.h"
#include "console.h"
#include "core/parallel.h"
#include "core/statistics.h"
#include "detect/detect.h"
#include "io/facts.h"
#include "io/read.h"
#include "io/threads.h"
#include "io/write.h"
#include "light/align.h"
#include "light/merge.h"
#include "light/response.h"
#include "map_files.h"
#include "map_job.h"
#include "numbers.h"
#include "options.h"
#include "reflectance_option.h"
#include "report.h"
#include "resample/source.h"
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

[[noreturn]] void refuse(const std::string& why) { throw Error(Error::Kind::usage, why); }

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

/// The photos' numbers from dark to bright: by what they were told, else by how bright they look.
std::vector<int> order_of(const Bracket& bracket) {
    std::vector<double> key;
    const bool told = std::ranges::all_of(bracket.told, [](const auto& t) { return !!t; });
    for (std::size_t k = 0; k < bracket.exposed.size(); ++k) {
        if (told) {
            key.push_back(*bracket.told[k]);
            continue;
        }
        const ExposedPhoto& photo = bracket.exposed[k];
        Image row({photo.size.width, 1}, 3);
        double sum = 0;
        for (int y = 0; y < photo.size.height; y += 1 + photo.size.height / 256) {
            photo.read(y, y + 1, row.view());
            for (int x = 0; x < photo.size.width; ++x)
                if (const float z = row.pixel(x, 0)[1]; std::isfinite(z))
                    sum += static_cast<double>(z);
        }
        key.push_back(sum);
    }
    std::vector<int> order(key.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](int k) { return key[static_cast<std::size_t>(k)]; });
    return order;
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Stops on Ctrl-C, tells nothing.
Watch quietly(const Console& console) { return {console.watch("").stop, nullptr}; }

/// The ball in each photo, where it was found or told.
std::vector<std::optional<Outline>> balls_of(const MergeOptions& o, const Bracket& bracket,
                                             int reference, const Console& console) {
    std::vector<std::optional<Outline>> balls(bracket.photos.size());
    if (o.ball) {
        const auto n = parse_numbers("--ball", *o.ball, {3}, "CX,CY,R");
        if (!(n[2] > 0)) refuse(fmt::format("--ball {}: the radius must be above 0", *o.ball));
        balls[at(reference)] = Outline{n[0], n[1], n[2], n[2], 0};
        return balls;
    }
    for (std::size_t k = 0; k < balls.size(); ++k) {
        const auto found = find_balls(*bracket.photos[k], {}, quietly(console));
        if (!found.empty() && found.front().confidence >= DetectOptions().threshold)
            balls[k] = found.front().outline;
    }
    return balls;
}

double radius(const Outline& e) { return std::sqrt(e.a * e.b); }

/// The ball that most photos agree on, near the one of the reference, decides; others are none.
void keep_alike(std::vector<std::optional<Outline>>& balls) {
    std::vector<double> radii;
    for (const auto& ball : balls)
        if (ball) radii.push_back(radius(*ball));
    if (radii.empty()) return;
    const double usual = median(std::move(radii));
    for (auto& ball : balls)
        if (ball && std::abs(radius(*ball) / usual - 1) > 0.05) ball.reset();
}

std::vector<std::optional<Outline>> alike_balls(const MergeOptions& o, const Bracket& bracket,
                                                int reference, const Console& console) {
    auto balls = balls_of(o, bracket, reference, console);
    keep_alike(balls);
    return balls;
}

AlignOptions align_options(const std::vector<std::optional<Outline>>& balls, int reference,
                           Size size) {
    AlignOptions options;
    const auto& here = balls[at(reference)];
    if (!here) return options;
    const Outline wide{here->cx, here->cy, 1.1 * here->a, 1.1 * here->b, here->angle};
    options.region = needed_window(wide, {0, 0, size});
    // Told for one it is about there in all; not found in one, the ball is not well shown there.
    const bool searched = std::ranges::count_if(balls, [](const auto& b) { return !!b; }) > 1;
    for (const auto& ball : balls) options.whole.push_back(searched && !ball);
    for (const auto& ball : balls)
        options.hints.push_back(ball ? std::optional(V2d(ball->cx - here->cx, ball->cy - here->cy))
                                     : std::nullopt);
    return options;
}

/// Where the photos lie on the reference.
struct Placed {
    std::vector<std::optional<Outline>> balls;
    AlignOptions options;
    std::vector<Alignment> shifts;
    std::vector<V2d> moves;  ///< the shifts alone
};

void take_moves(Placed& placed) {
    placed.moves.clear();
    for (const Alignment& a : placed.shifts) placed.moves.push_back(a.shift);
}

/// By the ball's outlines, then by the pictures.
Placed placed_photos(const MergeOptions& o, const Bracket& bracket, const std::vector<int>& order,
                     int reference, const Console& console) {
    Placed placed;
    placed.balls = alike_balls(o, bracket, reference, console);
    for (std::size_t k = 0; k < placed.balls.size() && placed.balls[at(reference)]; ++k)
        if (!placed.balls[k] && !o.ball)
            console.say(
                fmt::format("{}: its ball is lost; it is laid on the others by the whole picture",
                            bracket.exposed[k].name));
    placed.options = align_options(placed.balls, reference, bracket.size());
    placed.shifts = align(bracket.exposed, order, reference, bracket.response, placed.options,
                          console.watch("aligning"));
    take_moves(placed);
    return placed;
}

/// With the response that was found meanwhile.
void place_again(Placed& placed, const Bracket& bracket, const std::vector<int>& order,
                 int reference, const Response& response, const Console& console) {
    AlignOptions options = placed.options;
    options.hints.clear();
    for (const Alignment& a : placed.shifts) options.hints.emplace_back(a.shift);
    placed.shifts = align(bracket.exposed, order, reference, response, options,
                          console.watch("aligning again"));
    take_moves(placed);
}

/// What the pictures say of exposures and response, and which response is used.
struct Solved {
    BracketFit fit;
    std::string response;  ///< "linear", "assumed", "solved"
    std::string words;     ///< for the user
};

bool told_differ(const Bracket& bracket) {
    double least = 1e9, most = -1e9;
    for (const auto& t : bracket.told)
        if (t) least = std::min(least, *t), most = std::max(most, *t);
    return most - least > 0.3;
}

/// Nominal shutter speeds, apertures and ISOs are off by up to a tenth of a stop each; beyond this
/// they are wrong.
constexpr double kWrongStops = 0.25;

int wrong_tags(const Bracket& bracket, const BracketFit& fit) {
    int wrong = 0;
    for (std::size_t k = 0; k < fit.stops.size(); ++k)
        wrong += bracket.told[k] && std::abs(*fit.stops[k] - *bracket.told[k]) > kWrongStops;
    return wrong;
}

/// Another curve than the assumed one has to earn its place: by being another one, and by fitting
/// clearly better or by making several tags right.
bool deserves(const Solved& solved, const Solved& assumed, const Bracket& bracket) {
    constexpr double kOther = 0.1, kClear = 0.015;  // stops
    constexpr std::size_t kEnough = 200;            // patches
    if (solved.fit.patches < kEnough || solved.fit.curve_stops < kOther) return false;
    const double mine = solved.fit.rms_stops, its = assumed.fit.rms_stops;
    if (its > mine && std::sqrt(its * its - mine * mine) > kClear && mine < 0.85 * its) return true;
    return wrong_tags(bracket, assumed.fit) >= 2 && wrong_tags(bracket, solved.fit) == 0;
}

Solved solve(const MergeOptions& o, const Bracket& bracket, std::span<const Patch> patches) {
    BracketFitOptions how{bracket.response, false};
    Solved assumed{fit_bracket(patches, bracket.exposed, bracket.told, how), "assumed", {}};
    if (bracket.response.is_linear()) {
        assumed.response = "linear";
        assumed.words = "linear";
        return assumed;
    }
    assumed.words = fmt::format("{} (fits to {:.3f} stops)", bracket.space, assumed.fit.rms_stops);
    if (o.response == "srgb") return assumed;
    if (!told_differ(bracket)) {
        if (o.response == "solve")
            refuse(
                "--response solve: needs two exposures or more that are known and differ, since "
                "pictures alone tell a curve up to a power only; give --times");
        assumed.words += ", assumed, since no exposures are told that differ";
        return assumed;
    }
    how.solve_curve = true;
    Solved solved{fit_bracket(patches, bracket.exposed, bracket.told, how), "solved", {}};
    solved.words = fmt::format(
        "solved from {} patches (fits to {:.3f} stops, {} to {:.3f}; they "
        "differ by up to {:.2f} stops)",
        solved.fit.patches, solved.fit.rms_stops, bracket.space, assumed.fit.rms_stops,
        solved.fit.curve_stops);
    if (o.response == "solve") return solved;
    return deserves(solved, assumed, bracket) ? solved : assumed;
}

/// log2 of exposures, told ones where the pictures do not contradict them.
std::vector<double> final_stops(const Bracket& bracket, const BracketFit& fit,
                                const Console& console) {
    std::vector<double> stops;
    for (std::size_t k = 0; k < fit.stops.size(); ++k) {
        const std::string& name = bracket.exposed[k].name;
        const auto& told = bracket.told[k];
        const auto& seen = fit.stops[k];
        if (!told && !seen)
            throw Error(Error::Kind::failed,
                        fmt::format("{}: its {} is not known, and it shares no well exposed part "
                                    "with the other photos from which it could be solved; give "
                                    "--times",
                                    name, missing_tags(bracket, k)));
        if (!told) {
            console.say(fmt::format("{}: no {}; its exposure was solved from the pictures", name,
                                    missing_tags(bracket, k)));
        } else if (std::abs(*seen - *told) > kWrongStops) {
            console.warn(fmt::format(
                "{}: its exposure as told is {:+.2f} stops off what the pictures show; that of the "
                "pictures is used",
                name, *told - *seen));
        }
        stops.push_back(told && std::abs(*seen - *told) <= kWrongStops ? *told : *seen);
    }
    return stops;
}

/// The output's unit: 1 is what fills the scale at this exposure, log2.
struct Anchor {
    double stops = 0;
    Metadata metadata;  ///< exposure facts that go with it
};

Metadata exposure_facts(const Metadata& from) {
    Metadata facts;
    for (const char* name : {"expTime", "aperture", "isoSpeed"})
        if (const Attribute* a = from.find(name)) facts.set(*a);
    return facts;
}

Anchor ev_anchor(double ev100, const Bracket& bracket, int reference) {
    Anchor anchor;
    anchor.stops = std::log2(exposure_of_ev100(ev100));
    const ExposureTags& t = bracket.tags[at(reference)];
    ExposureTags unit = t;
    unit.time = 1;
    anchor.metadata.set("expTime", std::exp2(anchor.stops) / *exposure_of(unit));
    if (t.aperture) anchor.metadata.set("aperture", *t.aperture);
    if (t.iso) anchor.metadata.set("isoSpeed", *t.iso);
    return anchor;
}

Anchor anchor_of(const MergeOptions& o, const Bracket& bracket, const std::vector<double>& stops,
                 int reference) {
    Anchor anchor{stops[at(reference)],
                  exposure_facts(pass_through(bracket.photos[at(reference)]->metadata))};
    if (!o.anchor) return anchor;
    const auto named = std::ranges::find(o.photos, *o.anchor);
    if (named != o.photos.end()) {
        const auto k = static_cast<std::size_t>(named - o.photos.begin());
        return {stops[k], exposure_facts(pass_through(bracket.photos[k]->metadata))};
    }
    if (std::ranges::none_of(bracket.told, [](const auto& t) { return !!t; }))
        refuse(
            fmt::format("--anchor {}: no exposure of these photos is known, so that they cannot "
                        "be put on an absolute scale; give --times, or name one of the photos",
                        *o.anchor));
    double ev100 = 0;
    if (CLI::detail::lexical_cast(*o.anchor, ev100) && std::isfinite(ev100))
        return ev_anchor(ev100, bracket, reference);
    const Metadata facts = exposure_facts(pass_through(read_header(*o.anchor).metadata));
    const auto exposure = exposure_of(exposure_tags(facts));
    if (!exposure)
        refuse(
            fmt::format("--anchor {}: does not tell its exposure; name another photo, or an "
                        "EV100 such as 12",
                        *o.anchor));
    return {std::log2(*exposure), facts};
}

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

/// The ball in the merged picture, by the reference, or by any photo that shows it.
std::optional<Outline> merged_ball(const Placed& placed, int reference) {
    const auto& balls = placed.balls;
    if (balls.empty()) return std::nullopt;
    if (balls[at(reference)]) return balls[at(reference)];
    for (std::size_t k = 0; k < balls.size(); ++k) {
        if (!balls[k]) continue;
        Outline moved = *balls[k];
        moved.cx -= placed.moves[k].x;
        moved.cy -= placed.moves[k].y;
        return moved;
    }
    return std::nullopt;
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

void tell_shifts(const Bracket& bracket, const std::vector<Alignment>& shifts, int reference,
                 const Console& console) {
    for (std::size_t k = 0; k < shifts.size(); ++k) {
        const Alignment& a = shifts[k];
        if (!a.measured)
            console.warn(
                fmt::format("{}: could not be laid on the others (too little that both "
                            "show well); taken as it lies",
                            bracket.exposed[k].name));
        else if (static_cast<int>(k) != reference && a.shift.length() > 0.05)
            console.say(fmt::format("{}: shifted by {:.2f},{:.2f} pixels", bracket.exposed[k].name,
                                    a.shift.x, a.shift.y));
    }
}

void tell_result(const MergeOptions& o, const Merged& merged, const Console& console) {
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
                            o.photos[k], 100 * merged.moved[k]));
}

void run_merge(const MergeOptions& o) {
    const Console console(o.common.quiet);
    const ThreadLimit limit(o.common.threads);
    set_coding_threads(o.common.threads);
    const FileFormat format = check_words(o);
    const std::vector<double> times = times_of(o);
    const ColorConfig colors = ColorConfig::load(o.color.ocio);
    if (o.color.input_space) colors.space(*o.color.input_space);
    if (o.output_space) colors.space(*o.output_space);
    const Bracket bracket =
        read_bracket(o.photos, times, o.color.input_space, o.max_pixels, colors, console);
    if (o.output_space && !colors.is_linear(*o.output_space))
        refuse(fmt::format("--output-space {}: merged light is linear; name a linear space",
                           *o.output_space));

    std::vector<int> order = order_of(bracket);
    const int reference = order[(order.size() - 1) / 2];
    Placed placed;
    placed.moves.assign(bracket.photos.size(), V2d(0, 0));
    if (!o.no_align)
        placed = placed_photos(o, bracket, order, reference, console);
    else if (o.reflectance)
        placed.balls = alike_balls(o, bracket, reference, console);
    const auto patches = even_patches(bracket.exposed, placed.moves, console.watch("measuring"));
    const Solved solved = solve(o, bracket, patches);
    console.say(fmt::format("response: {}", solved.words));
    const std::vector<double> stops = final_stops(bracket, solved.fit, console);
    if (std::ranges::max(stops) - std::ranges::min(stops) < 0.1)
        console.warn(
            fmt::format("{}: the photos are exposed alike; noise is averaged, but there is "
                        "no more range than in one of them",
                        o.output));
    if (!o.no_align) {
        // Once more with what is known now; the order, too.
        std::ranges::stable_sort(order, {}, [&](int k) { return stops[at(k)]; });
        place_again(placed, bracket, order, reference, solved.fit.response, console);
        tell_shifts(bracket, placed.shifts, reference, console);
    }
    const std::vector<V2d>& moves = placed.moves;
    const Anchor anchor = anchor_of(o, bracket, stops, reference);

    std::vector<MergePhoto> photos;
    for (std::size_t k = 0; k < stops.size(); ++k)
        photos.push_back({bracket.exposed[k], std::exp2(stops[k] - anchor.stops), moves[k]});
    Merged merged = merge(photos, solved.fit.response, console.watch("merging"));
    tell_result(o, merged, console);
    const WriteReport written = write(o, format, std::move(merged.pixels), bracket, reference,
                                      merged_ball(placed, reference), anchor, colors, console);
    if (written.clamped > 0) console.warn(clamp_warning(o.output, written.clamped, format));
    MergeReport report;
    report.clipped_everywhere = merged.clipped_everywhere;
    report.black_everywhere = merged.black_everywhere;
    report.response = solved.response;
    for (std::size_t k = 0; k < photos.size(); ++k) {
        std::optional<double> told;
        if (bracket.told[k]) told = *bracket.told[k] - anchor.stops;
        report.photos.push_back(
            {o.photos[k], stops[k] - anchor.stops, told, moves[k].x, moves[k].y, merged.moved[k]});
        console.say(fmt::format("{}: {:+.2f} stops", o.photos[k], stops[k] - anchor.stops));
    }
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
