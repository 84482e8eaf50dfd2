#include "shot_frame.h"

#include <fmt/format.h>

#include <filesystem>

#include "io/facts.h"
#include "resample/resample.h"
#include "stop.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

bool newer_than_plate(const Shot& shot, const std::string& file, int frame) {
    std::error_code error;
    const auto made = fs::last_write_time(file, error);
    if (error) return false;
    const auto plate = fs::last_write_time(shot.plates->file(frame), error);
    return error || made >= plate;
}

bool is_whole(const std::string& file, const std::string& fingerprint, FileFormat format) {
    try {
        const Photo header = read_header(file);
        const auto past = provenance_from(header.metadata);
        if (!past || past->fingerprint != fingerprint) return false;
        // The reader holds an EXR against its table of contents; others show it by being read.
        return format == FileFormat::exr || read_photo(file).damage.empty();
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

PhotoJob solved_job(const Shot& shot, const SolveHead& head, const SolvedFrame& frame) {
    const PhotoOptions options = shot.photo_options(frame.frame);
    if (options.cropped)
        return open_photo(shot.plates->file(frame.frame), options, {&stop_requested(), nullptr});
    // It is cut to what there is.
    constexpr Window kAnywhere{-(1 << 28), -(1 << 28), {1 << 29, 1 << 29}};
    PhotoJob job;
    job.photo = shot.plates->part(frame.frame, needed_window(*frame.outline, kAnywhere),
                                  options.max_pixels);
    job.camera = choose_camera(options, job.photo);
    if (!job.camera.told && head.focal) {
        job.camera.camera.focal = head.focal;
        job.camera.source = "estimated from the outlines";
        job.camera.told = true;
    }
    job.ball.found = true;
    job.ball.outline = *frame.outline;
    job.ball.how = "solved";
    if (!job.camera.note.empty()) job.warnings.push_back(job.camera.note);
    if (!job.camera.told)
        job.warnings.push_back(unknown_lens_warning(job.photo.name, ", --cameras"));
    return job;
}

Rotation frame_to_world(const Shot& shot, const Photo& photo, int frame) {
    if (const auto told = told_rotation(shot.options.map)) return *told;
    const auto camera = shot.cameras.find(frame);
    if (camera != shot.cameras.end() && camera->second.to_world) return *camera->second.to_world;
    if (!photo.metadata.find("worldToCamera")) return {};
    const auto rotation = rotation_from_metadata(photo, shot.options.photo.camera_axes);
    if (!rotation)
        shot.warnings.add(photo.name,
                          "its worldToCamera is no rotation and is not used; give "
                          "--camera-to-world or --cameras");
    return rotation.value_or(Rotation());
}

std::string words_of(const Shot& shot, const SolvedFrame& frame) {
    const Outline& o = *frame.outline;
    return fmt::format("{} {} {} {} {} {} {} {}\n", frame.frame, shot.plates->digest(frame.frame),
                       o.cx, o.cy, o.a, o.b, o.angle, frame.lens_blur);
}

bool is_current(const Shot& shot, int frame, const std::string& file,
                const std::string& fingerprint, FileFormat format) {
    remove_leftover(file);
    return newer_than_plate(shot, file, frame) && is_whole(file, fingerprint, format);
}

}  // namespace chromeball
