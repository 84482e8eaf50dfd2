#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <thread>

#include "camera_choice.h"
#include "core/error.h"
#include "io/lines.h"
#include "io/write.h"
#include "numbers.h"
#include "reflectance_option.h"
#include "refuse.h"
#include "shot.h"
#include "shot/stage_files.h"
#include "version.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

/// Of optional texts and numbers, for hashes.
template <class T>
std::string told(const std::optional<T>& value) {
    return value ? fmt::format("{}", *value) : "-";
}

Frames asked_frames(const ShotOptions& o, const Plates& plates, const Console& console) {
    if (o.frames) return parse_frames(*o.frames);
    const Frames frames = plates.there();
    if (frames.empty())
        throw Error(Error::Kind::failed,
                    fmt::format("{}: no such files; check the path, or name the frames with "
                                "--frames",
                                plates.typed()));
    const Frames gaps = gaps_in(frames);
    console.say(fmt::format("{}: {} frames, {}", plates.typed(), frames.size(), text_of(frames)));
    if (!gaps.empty())
        console.warn(fmt::format("{}: {} frames between the first and the last are not there: {}",
                                 plates.typed(), gaps.size(), text_of(gaps)));
    return frames;
}

/// 1010:CX,CY,R or 1010:CX,CY,A,B,DEG
void add_key(std::map<int, Outline>& keys, const std::string& text) {
    const auto colon = text.find(':');
    const std::string form = "FRAME:CX,CY,R";
    if (colon == std::string::npos) refuse(fmt::format("--key {}: expected {}", text, form));
    const std::string number = text.substr(0, colon);
    const double frame = parse_numbers("--key", number, {1}, form).front();
    if (frame < 0 || frame > std::numeric_limits<int>::max() || frame != std::floor(frame))
        refuse(fmt::format("--key {}: {} is no frame number", text, number));
    keys[static_cast<int>(frame)] =
        parse_outline(fmt::format("--key {}:", number), text.substr(colon + 1), {3, 5}, form);
}

SolveOptions solve_options(const ShotOptions& o) {
    SolveOptions solving;
    solving.told = o.photo.ball || o.photo.ellipse || o.photo.cropped;
    solving.lock = o.lock;
    solving.missing = o.missing == "skip"          ? MissingFrames::skip
                      : o.missing == "interpolate" ? MissingFrames::interpolate
                                                   : MissingFrames::hold;
    for (const std::string& key : o.keys) add_key(solving.keys, key);
    if (solving.told && (o.lock || !o.keys.empty()))
        refuse(
            "--ball, --ellipse and --cropped tell the outline of every frame; --lock and --key "
            "correct outlines that are searched: leave one of them out");
    return solving;
}

/// Contradictions of the camera's flags, before any frame is read.
void check_camera_flags(const ShotOptions& o) {
    Photo photo;
    photo.display = {1920, 1080};
    const CameraChoice camera = choose_camera(o.photo, photo);
    search_options(o.photo, camera);
}

FramePattern output_pattern(const ShotOptions& o) {
    const auto pattern = FramePattern::parse(o.map.output.output);
    if (!pattern)
        refuse(
            fmt::format("-o {}: the output needs a place for the frame's number, as "
                        "probes/sh010.####.exr, or probes/sh010.#### for folders of faces",
                        o.map.output.output));
    return *pattern;
}

void check_folder(const Shot& shot) {
    // Of folders with a number in their names the one above all.
    const std::string folder = shot.output->folder();
    make_folder(folder);
    const std::string name = fs::path(shot.output->text()).filename().string();
    check_target((fs::path(folder) / name).string());
}

void check_inputs_are_safe(const Shot& shot) {
    const int first = shot.frames.front();
    for (const int frame : {first, shot.frames.back()}) {
        const OutputPlan plan = shot.plan_of(frame);
        check_not_input(plan.path, shot.plates->file(frame));
        if (plan.layout->separate_faces)
            for (const std::string& face : plan.face_files())
                check_not_input(face, shot.plates->file(frame));
    }
    if (fs::path(shot.output->path(first)).lexically_normal() ==
        fs::path(shot.plates->file(first)).lexically_normal())
        refuse(fmt::format("-o {}: would replace the plates; name another output",
                           shot.output->text()));
}

void check_reports(const Shot& shot) {
    for (const std::string& report : shot.options.reports) {
        const std::string extension = fs::path(report).extension().string();
        if (extension != ".json" && extension != ".html")
            refuse(fmt::format("--report {}: name a .json or .html file", report));
        check_target(report);
        for (const int frame : {shot.frames.front(), shot.frames.back()})
            check_not_input(report, shot.plates->file(frame));
    }
}

/// The folder of the stages' files, made with what is above it as far as it is ours.
std::string work_folder(const Shot& shot) {
    if (shot.options.work) {
        make_folder(*shot.options.work);
        return *shot.options.work;
    }
    const fs::path hidden = fs::path(shot.output->folder()) / ".chromeball";
    make_folder(hidden.string());
    const std::string folder = (hidden / shot.output->name()).string();
    make_folder(folder);
    return folder;
}

std::string text_of_file(const std::optional<std::string>& path) {
    return path ? read_text(*path) : std::string();
}

std::string ocio_text(const ShotOptions& o) {
    if (o.color.ocio) return *o.color.ocio + text_of_file(o.color.ocio);
    const char* environment = std::getenv("OCIO");
    return environment && *environment && fs::is_regular_file(environment)
               ? read_text(environment)
               : std::string(environment ? environment : "");
}

/// One line for each thing that the outlines in the plates depend on.
std::string track_words(const ShotOptions& o) {
    const PhotoOptions& p = o.photo;
    return fmt::format(
        "track {} {}\ninput {}\nball {} {} {}\nsearch {} {} {}\nlens {} {} {} {} {} {} {}\n"
        "bend {} {} {}\nsensors {}\ncameras {}\n",
        kRecordVersion, kVersion, o.input, told(p.ball), told(p.ellipse), p.cropped, p.threshold,
        told(p.near), told(p.radius_range), told(p.focal_mm), told(p.sensor_mm), told(p.hfov),
        told(p.focal_px), told(p.distance_radii), p.orthographic, told(p.principal), p.k1, p.k2,
        p.k3, text_of_file(p.sensors), text_of_file(o.cameras));
}

std::string solve_words(const ShotOptions& o) {
    std::string keys;
    for (const std::string& key : o.keys) keys += key + " ";
    return fmt::format("solve {} {} {}\n", o.missing, o.lock, keys);
}

std::string map_words(const ShotOptions& o, const OutputPlan& plan) {
    const MapOptions& m = o.map;
    return fmt::format(
        "map {} {}\nfile {} {} {}\nspaces {} {} {} {} {}\naxes {} {} {} {} {}\nmirror {}\n"
        "filter {} {}\nframes {}\nsize {}\n",
        plan.layout->name, plan.preset ? plan.preset->name : "-", extension_of(plan.format),
        m.output.full_float, m.output.bits.value_or(16), told(o.color.input_space), ocio_text(o),
        told(m.output_space), told(m.display), told(m.view), told(m.camera_to_world), m.yaw,
        m.pitch, m.roll, o.photo.camera_axes,
        m.reflectance ? reflectance_words(*m.reflectance) : "", m.filter, told(m.simd),
        o.smooth_frames, told(m.size));
}

}  // namespace

void SharedWarnings::add(const std::string& name, const std::string& text) {
    const std::string rest =
        text.starts_with(name + ": ") ? text.substr(name.size() + 2) : std::string(text);
    const std::lock_guard hold(lock_);
    auto& [first, count] = all_[rest];
    if (count == 0 || name < first) first = name;
    ++count;
}

void SharedWarnings::tell(const Console& console) const {
    const std::lock_guard hold(lock_);
    for (const auto& [text, where] : all_) {
        const auto& [name, count] = where;
        console.warn(count == 1 ? fmt::format("{}: {}", name, text)
                                : fmt::format("{} and {} more: {}", name, count - 1, text));
    }
}

OutputPlan Shot::plan_of(int frame) const {
    OutputPlan one = plan;
    one.path = output->path(frame);
    return one;
}

PhotoOptions Shot::photo_options(int frame) const {
    PhotoOptions photo = options.photo;
    const auto camera = cameras.find(frame);
    if (camera == cameras.end()) return photo;
    const bool lens_told = photo.focal_mm || photo.hfov || photo.focal_px || photo.distance_radii ||
                           photo.orthographic;
    if (!lens_told) photo.focal_px = camera->second.focal;
    if (!photo.principal && camera->second.principal)
        photo.principal = fmt::format("{:.17g},{:.17g}", camera->second.principal->x,
                                      camera->second.principal->y);
    return photo;
}

std::string Shot::stage_file(const std::string& stage) const {
    return (fs::path(work) / stage / stage_file_name(frames)).string();
}

std::string Shot::stage_text(const std::string& stage) const {
    std::string text;
    for (const std::string& file : stage_files((fs::path(work) / stage).string(), frames)) {
        text += read_text(file);
        if (!text.empty() && text.back() != '\n') text += '\n';  // torn: no record by itself
    }
    return text;
}

std::string Shot::solve_file() const { return (fs::path(work) / "solved.jsonl").string(); }

std::unique_ptr<Shot> plan_shot(const ShotOptions& o) {
    auto shot = std::make_unique<Shot>();
    shot->options = o;
    shot->console = Console(o.common.quiet);
    shot->solving = solve_options(o);
    check_camera_flags(o);
    shot->output = output_pattern(o);
    if (o.cameras) {
        if (!fs::exists(*o.cameras))
            throw Error(Error::Kind::failed,
                        fmt::format("{}: no such file; check the path", *o.cameras));
        shot->cameras = cameras_from(read_text(*o.cameras), *o.cameras);
    }
    OutputOptions first = o.map.output;
    first.output = shot->output->path(1);
    shot->plan = plan_output(first);
    shot->colors = ColorConfig::load(o.color.ocio);
    if (o.color.input_space) shot->colors->space(*o.color.input_space);
    check_map_options(o.map, shot->plan, *shot->colors);

    shot->plates = std::make_unique<Plates>(o.input);
    if (o.photo.cropped && shot->plates->is_clip())
        refuse("--cropped goes with pictures, not with a film clip");
    shot->frames = asked_frames(o, *shot->plates, shot->console);
    check_inputs_are_safe(*shot);
    check_folder(*shot);
    check_reports(*shot);
    check_insert_options(*shot);
    shot->jobs =
        o.jobs > 0 ? o.jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    shot->track_settings = hash_of(track_words(o));
    shot->solve_settings = hash_of(track_words(o) + solve_words(o));
    shot->map_settings = hash_of(track_words(o) + map_words(o, shot->plan));
    const std::string inserted = insert_words(o.insert);
    shot->convert_settings =
        inserted.empty() ? shot->map_settings : hash_of(shot->map_settings + inserted);
    shot->work = work_folder(*shot);
    for (const char* stage : {"track", "convert"})
        make_folder((fs::path(shot->work) / stage).string());
    return shot;
}

}  // namespace chromeball
