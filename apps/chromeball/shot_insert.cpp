#include "shot_insert.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>

#include "io/facts.h"
#include "io/gltf.h"
#include "io/lines.h"
#include "io/write.h"
#include "light_input.h"
#include "picture_file.h"
#include "plate.h"
#include "refuse.h"
#include "render/patch.h"
#include "render/preview.h"
#include "shot.h"
#include "shot_frame.h"
#include "stop.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

/// A name without a number's place is one mesh for all frames, even if it holds an @.
std::optional<FramePattern> mesh_pattern(const InsertOptions& o) {
    if (fs::exists(*o.mesh)) return std::nullopt;
    return FramePattern::parse(*o.mesh);
}

FramePattern output_pattern(const InsertOptions& o) {
    const auto pattern = o.output ? FramePattern::parse(*o.output) : std::nullopt;
    if (!pattern)
        refuse(
            fmt::format("--insert-output {}: give the pictures with the object a name with a "
                        "place for the frame's number, as comp/sh010.####.exr",
                        o.output.value_or("(not given)")));
    return *pattern;
}

/// How the pictures are written: as the maps, but for their shape.
OutputPlan picture_plan(const Shot& shot, const std::string& path) {
    OutputOptions options;
    options.output = path;
    options.full_float = shot.options.map.output.full_float;
    options.bits = shot.options.map.output.bits;
    return plan_output(options);
}

SceneOptions scene_options(const InsertOptions& o) {
    SceneOptions scene = o.scene;
    scene.mesh = *o.mesh;
    return scene;
}

/// Of files by what they hold, of shapes by their names.
std::string digest_of(const std::string& mesh) {
    if (!fs::is_regular_file(mesh)) return mesh;
    const std::string text = read_text(mesh);
    std::string digest = hash_of(text);
    for (const std::string& file : gltf_buffers(mesh, text))
        if (fs::is_regular_file(file)) digest += hash_of(read_text(file));
    return digest;
}

}  // namespace

void add_insert_options(CLI::App& command, InsertOptions& o) {
    const std::string group = "Object in the plate";
    command
        .add_option("--insert", o.mesh,
                    "Put an object in the ball's place, lit by each frame's ball: a mesh's name or "
                    "file as of preview --mesh, scaled into the ball; or a file a frame, as "
                    "'creature.####.obj', in its own units: ball radii from the ball's middle")
        ->type_name("NAME|FILE|PATTERN")
        ->group(group);
    command.add_option("--insert-output", o.output, "Pictures with it, as 'comp/sh010.####.exr'")
        ->type_name("PATTERN")
        ->group(group);
    add_material_options(command, o.scene, group);
    add_scale_option(command, o.scale, group);
    add_samples_option(command, o.samples, group);
    command.add_flag("--patch", o.patch, "Paint the ball out where the object is not")
        ->group(group);
}

std::string insert_words(const InsertOptions& o) {
    if (!o.mesh) return {};
    return fmt::format("insert {} {} {} {} {} {}\n", o.scene.material,
                       o.scene.roughness ? fmt::format("{}", *o.scene.roughness) : "-", o.scale,
                       o.samples, o.patch, *o.mesh);
}

void check_insert_options(const Shot& shot) {
    const InsertOptions& o = shot.options.insert;
    if (!o.mesh) {
        if (o.output) refuse("--insert-output: give the object, too: --insert MESH");
        if (o.patch) refuse("--patch: goes with --insert MESH");
        return;
    }
    if (shot.options.photo.cropped)
        refuse("--insert: a cropped ball has no plate around it to put an object into");
    check_scene_options(scene_options(o));
    const FramePattern output = output_pattern(o);
    check_map_options(shot.options.map, picture_plan(shot, output.path(1)), *shot.colors);
    make_folder(output.folder());
    check_target((fs::path(output.folder()) / fs::path(output.text()).filename()).string());
    const auto meshes = mesh_pattern(o);
    // Not after hours of tracking.
    if (!meshes) scene_of(scene_options(o), Console(true));
    for (const int frame : {shot.frames.front(), shot.frames.back()}) {
        const std::string path = output.path(frame);
        check_not_input(path, shot.plates->file(frame));
        if (meshes) check_not_input(path, meshes->path(frame));
        if (fs::path(path).lexically_normal() ==
            fs::path(shot.output->path(frame)).lexically_normal())
            refuse(fmt::format("--insert-output {}: would replace the maps; name another output",
                               output.text()));
    }
}

/// The object, ready to be seen.
struct Insert::Model {
    explicit Model(Scene object) : scene(std::move(object)), tracer(scene) {}
    Scene scene;
    Tracer tracer;
};

Insert::Insert(const Shot& shot, const SolveHead& head)
    : shot_(shot),
      head_(head),
      output_(output_pattern(shot.options.insert)),
      meshes_(mesh_pattern(shot.options.insert)) {
    const InsertOptions& o = shot.options.insert;
    if (meshes_) return;
    Scene scene = scene_of(scene_options(o), shot.console);
    scale(scene, o.scale);
    shared_ = std::make_unique<Model>(std::move(scene));
    shared_digest_ = digest_of(*o.mesh);
}

Insert::~Insert() = default;

std::unique_ptr<Insert::Model> Insert::model_of(int frame, std::vector<std::string>& notes) const {
    const InsertOptions& o = shot_.options.insert;
    Scene scene = object_file(meshes_->path(frame), scene_options(o), notes);
    scale(scene, o.scale);
    return std::make_unique<Model>(std::move(scene));
}

std::string Insert::fingerprint(const SolvedFrame& frame) const {
    std::string words = shot_.map_settings + insert_words(shot_.options.insert);
    if (head_.focal) words += fmt::format("focal {}\n", *head_.focal);
    words += words_of(shot_, frame);
    words += meshes_ ? digest_of(meshes_->path(frame.frame)) : shared_digest_;
    return hash_of(words);
}

bool Insert::is_current(const SolvedFrame& frame, const std::string& fingerprint) const {
    const std::string path = output_.path(frame.frame);
    return chromeball::is_current(shot_, frame.frame, path, fingerprint,
                                  picture_plan(shot_, path).format);
}

Insert::Picture Insert::picture(const SolvedFrame& frame) const {
    const InsertOptions& o = shot_.options.insert;
    const Watch watch{&stop_requested(), nullptr};
    Picture result;
    PhotoJob job = solved_job(shot_, head_, frame);
    const MirrorBall ball = projection_of(job);
    const Rotation to_world = frame_to_world(shot_, job.photo, frame.frame);
    Image map;
    {
        const BallLight light = ball_light(job, ball, frame.lens_blur, false, shot_.options.color,
                                           shot_.options.map, *shot_.colors);
        map = light_map(light, to_world, watch);
    }
    const Environment environment(std::move(map), *find_layout("latlong"));
    std::unique_ptr<Model> own;
    if (meshes_) own = model_of(frame.frame, result.warnings);
    const Model& model = own ? *own : *shared_;

    const PhotoOptions photo = shot_.photo_options(frame.frame);
    {
        const Photo whole = shot_.plates->read(frame.frame, {photo.max_pixels, std::nullopt});
        result.metadata = pass_through(whole.metadata);
        result.origin.source = whole.name;
        std::vector<std::string> told;  // of its ball already, by the map
        result.pixels = plate_pixels(whole, shot_.options.color, *shot_.colors, told);
    }
    const View view = View::of_ball(result.pixels.size(), job.camera.camera, ball, to_world);
    const Image object = preview(model.scene, model.tracer, environment, view,
                                 {.samples = o.samples}, nullptr, watch);
    if (o.patch) paint_out(result.pixels, ball.outline(), frame.lens_blur);
    lay_over(result.pixels, object);
    return result;
}

std::vector<std::string> Insert::write(const SolvedFrame& frame, Picture picture,
                                       const std::string& fingerprint) const {
    const std::string path = output_.path(frame.frame);
    OutputPlan plan = picture_plan(shot_, path);
    const fs::path folder = fs::path(path).parent_path();
    if (!folder.empty() && !fs::exists(folder)) make_folder(folder.string());
    picture.origin.fingerprint = fingerprint;
    const WrittenMap written =
        write_picture_file(path, std::move(picture.pixels), plan, shot_.options.map,
                           std::move(picture.origin), *shot_.colors, std::move(picture.metadata));
    plan.path = path;
    if (plan.scene_linear)
        for (const std::string& one : warnings_of(written, plan, shot_.options.map))
            shot_.warnings.add(path, one);
    return picture.warnings;
}

}  // namespace chromeball
