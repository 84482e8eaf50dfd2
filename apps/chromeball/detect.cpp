#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>

#include "commands.h"
#include "console.h"
#include "core/parallel.h"
#include "detect/contact_sheet.h"
#include "io/facts.h"
#include "io/write.h"
#include "map_files.h"
#include "options.h"
#include "photo_job.h"
#include "report.h"
#include "resample/resample.h"
#include "stop.h"
#include "version.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

struct DetectCommand {
    std::vector<std::string> photos;
    CommonOptions common;
    PhotoOptions photo;
    ColorOptions color;
    std::optional<std::string> overlay;
    std::optional<std::string> crop;
    std::optional<int> crop_size;
    std::optional<std::string> contact_sheet;
    bool all = false;
    bool json_lines = false;
    bool json = false;
};

/// Where a photo's picture goes: the file named, or, of several photos, a file in the folder named.
std::string picture_path(const std::string& target, const std::string& photo, bool several,
                         std::string_view extension) {
    if (!several && !fs::is_directory(target)) return target;
    return (fs::path(target) / fs::path(photo).stem()).string() + std::string(extension);
}

FileFormat picture_format(const std::string& path) {
    const auto format = format_from_extension(fs::path(path).extension().string());
    if (!format)
        throw Error(Error::Kind::usage,
                    fmt::format("{}: name a .png, .jpg, .tif, .exr or .hdr file", path));
    return *format;
}

/// Whether a picture of each photo can be written: before the search, and without harm to any
/// photo.
void check_pictures(const std::string& target, const std::vector<std::string>& photos,
                    std::string_view extension) {
    const bool several = photos.size() > 1;
    if (several) make_folder(target);
    std::map<std::string, std::string> of;  // picture -> photo
    for (const std::string& photo : photos) {
        const std::string path = picture_path(target, photo, several, extension);
        picture_format(path);
        check_target(path);
        for (const std::string& other : photos) check_not_input(path, other);
        if (const auto [known, is_new] = of.emplace(path, photo); !is_new)
            throw Error(Error::Kind::usage,
                        fmt::format("{}: would be written for {} and for {}; take them apart", path,
                                    known->second, photo));
    }
}

/// The photo with the ball drawn on it, with --all every candidate.
Photo drawn_overlay(const DetectCommand& o, const PhotoJob& job) {
    std::vector<Candidate> shown;
    if (job.ball.candidate)
        shown.push_back(*job.ball.candidate);
    else if (job.ball.found)
        shown.push_back({job.ball.outline, {}, 1, 1, 0});
    if (o.all) shown.insert(shown.end(), job.ball.others.begin(), job.ball.others.end());
    return overlay(job.photo, shown, o.photo.threshold);
}

void write_picture(const std::string& path, const Photo& picture) {
    WriteOptions write;
    write.format = picture_format(path);
    write.bits = 8;
    write_image(path, drawn_image(picture).view(), write);
}

void write_crop(const DetectCommand& o, const PhotoJob& job, const MirrorBall& ball,
                const ColorConfig& colors, bool several) {
    const Outline& outline = ball.outline();
    const int size =
        o.crop_size.value_or(static_cast<int>(std::clamp(std::ceil(2 * outline.a), 16.0, 16384.0)));
    const Window region = needed_window(outline, job.photo.window);
    const std::string space = colors.input_space(job.photo, o.color.input_space);
    const Image pixels = colors.to_working(job.photo, space, region);
    Affine to_pixels = shift(-region.x, -region.y);
    Image crop = crop_ball(pixels, outline, to_pixels, size, {&stop_requested(), nullptr});

    const std::string path = picture_path(*o.crop, job.photo.name, several, ".exr");
    WriteOptions write;
    write.format = picture_format(path);
    const bool linear = write.format == FileFormat::exr || write.format == FileFormat::hdr;
    const std::string out_space = colors.output_space(std::nullopt, linear);
    colors.from_working(crop, out_space);
    write.color = colors.tag(out_space);
    write.metadata = pass_through(job.photo.metadata);
    Provenance provenance;
    provenance.version = kVersion;
    provenance.source = job.photo.name;
    provenance.outline = outline;
    provenance.camera = job.camera.camera;
    provenance.layout = "crop";
    if (const auto past = provenance_from(job.photo.metadata))
        provenance.reflectance = past->reflectance;
    write.metadata.set(to_attribute(provenance));
    write_image(path, crop.view(), write);
}

/// A picture that cannot be written takes nothing from what was found.
void write_safely(DetectReport& report, const std::function<void()>& write) {
    try {
        write();
    } catch (const Error& e) {
        if (e.kind() != Error::Kind::failed) throw;
        report.unwritten = e.what();
    }
}

/// What became of a photo, and its place on the contact sheet.
struct Looked {
    DetectReport report;
    SheetEntry entry;
};

Looked look_at(const std::string& path, const DetectCommand& o, const ColorConfig* colors) {
    const bool several = o.photos.size() > 1;
    Looked looked;
    DetectReport& report = looked.report;
    report.photo = path;
    PhotoJob job = open_photo(path, o.photo, {&stop_requested(), nullptr});
    report.size = job.photo.display;
    report.found = job.ball.found;
    report.confidence = job.ball.candidate ? job.ball.candidate->confidence
                        : job.ball.found   ? 1
                                           : 0;
    if (job.ball.found) {
        const MirrorBall ball = projection_of(job);
        report.outline =
            job.ball.candidate && !job.ball.circle_given ? job.ball.outline : ball.outline();
        report.visible_rim = job.ball.candidate ? job.ball.candidate->visible_rim : 1;
        report.center_direction = ball.axis();
        if (!ball.orthographic()) report.distance = ball.distance();
        report.hidden_half_angle_degrees = ball.hidden_half_angle() * 180 / std::numbers::pi;
        if (o.crop) write_safely(report, [&] { write_crop(o, job, ball, *colors, several); });
    } else {
        report.reason = no_ball(job, o.photo.threshold).what();
    }
    report.camera = job.camera;
    report.warnings = job.warnings;
    if (job.ball.candidate) {
        if (job.ball.found) {
            report.deviation = job.ball.candidate->deviation;
            report.motion = job.ball.candidate->motion;
        }
        if (o.all) {
            report.candidates = job.ball.others;
            report.candidates.insert(report.candidates.begin(), *job.ball.candidate);
        }
    }
    if (!o.overlay && !o.contact_sheet) return looked;
    const Photo drawn = drawn_overlay(o, job);
    if (o.overlay)
        write_safely(
            report, [&] { write_picture(picture_path(*o.overlay, path, several, ".png"), drawn); });
    if (o.contact_sheet)
        looked.entry = {
            thumbnail(drawn),
            fmt::format("{} {:.2f}", fs::path(path).filename().string(), report.confidence),
            report.found};
    return looked;
}

/// A photo that cannot be read is an answer; what the user typed wrong is not.
Looked look_safely(const std::string& path, const DetectCommand& o, const ColorConfig* colors) {
    try {
        return look_at(path, o, colors);
    } catch (const Error& e) {
        if (e.kind() != Error::Kind::failed) throw;
        Looked looked;
        looked.report.photo = path;
        looked.report.readable = false;
        looked.report.reason = e.what();
        looked.entry = {{}, fs::path(path).filename().string() + " unreadable", false};
        return looked;
    }
}

int status_of(const std::vector<DetectReport>& reports) {
    const auto count = [&](auto test) {
        return std::count_if(reports.begin(), reports.end(), test);
    };
    const auto failed =
        count([](const DetectReport& r) { return !r.readable || !r.unwritten.empty(); });
    if (failed == static_cast<std::ptrdiff_t>(reports.size())) return 1;
    if (failed > 0) return 3;
    return count([](const DetectReport& r) { return !r.found; }) > 0 ? 4 : 0;
}

void run_detect(const DetectCommand& o) {
    const Console console(o.common.quiet);
    const UsedThreads threads(o.common);
    const bool several = o.photos.size() > 1;
    if (o.overlay) check_pictures(*o.overlay, o.photos, ".png");
    if (o.crop) check_pictures(*o.crop, o.photos, ".exr");
    std::optional<ColorConfig> colors;  // only cropping needs colours
    if (o.crop) colors = ColorConfig::load(o.color.ocio);

    if (o.contact_sheet) {
        picture_format(*o.contact_sheet);
        check_target(*o.contact_sheet);
        for (const std::string& photo : o.photos) check_not_input(*o.contact_sheet, photo);
    }
    std::vector<DetectReport> reports(o.photos.size());
    std::vector<SheetEntry> entries(o.photos.size());
    for_each_band(
        static_cast<int>(o.photos.size()), 1,
        [&](int i, int) {
            const auto at = static_cast<std::size_t>(i);
            Looked looked = look_safely(o.photos[at], o, colors ? &*colors : nullptr);
            reports[at] = std::move(looked.report);
            entries[at] = std::move(looked.entry);
        },
        several ? console.watch("searching") : Watch{&stop_requested(), nullptr});

    for (const DetectReport& report : reports) {
        for (const std::string& warning : report.warnings) console.warn(warning);
        if (!report.readable) print_message(fmt::format("error: {}\n", report.reason));
        if (!report.unwritten.empty()) print_message(fmt::format("error: {}\n", report.unwritten));
    }
    print_result(to_json(reports, o.json_lines));
    if (o.contact_sheet) write_picture(*o.contact_sheet, contact_sheet(entries));
    for (const DetectReport& report : reports)
        if (report.readable && !report.found) console.say(report.reason);
    if (const int status = status_of(reports)) throw CLI::RuntimeError(status);
}

}  // namespace

void add_detect(CLI::App& app) {
    auto o = std::make_shared<DetectCommand>();
    auto* command = app.add_subcommand("detect", "Find the mirror ball in photos; prints JSON");
    command->add_option("photos", o->photos, "Photos")->required()->type_name("PHOTO");
    command
        ->add_option("--overlay", o->overlay,
                     "Write the photo with the outline drawn on it (of several photos: a folder)")
        ->type_name("FILE.png");
    command
        ->add_option("--crop", o->crop,
                     "Write the ball cut out, its outline made a circle that touches the four "
                     "edges; convert --cropped takes it (of several photos: a folder)")
        ->type_name("FILE");
    command
        ->add_option("--crop-size", o->crop_size,
                     "Side of the crop, pixels (default: the ball's diameter)")
        ->check(CLI::Range(16, 16384));
    command
        ->add_option("--contact-sheet", o->contact_sheet,
                     "All photos with their outlines and confidence on one picture")
        ->type_name("FILE.png");
    command->add_flag("--all", o->all, "List and draw every candidate, best first");
    command->add_flag("--json-lines", o->json_lines, "One object a line instead of an array");
    command->add_flag("--json", o->json, "JSON is what detect prints anyway");
    add_photo_options(*command, o->photo);
    add_color_options(*command, o->color);
    add_common_options(*command, o->common);
    command->footer(
        "Exit status: 0 all found, 4 no ball in at least one, 3 some could not be read, 1 none "
        "could.\n"
        "Examples:\n"
        "  chromeball detect plate.jpg --overlay look.png\n"
        "  chromeball detect *.jpg --json-lines --contact-sheet sheet.png");
    command->callback([o] { run_detect(*o); });
}

}  // namespace chromeball
