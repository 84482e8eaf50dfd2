#include "map_job.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <atomic>

#include "core/error.h"
#include "core/parallel.h"
#include "io/read.h"
#include "numbers.h"
#include "options.h"
#include "reflectance_option.h"
#include "resample/simd.h"
#include "version.h"

namespace chromeball {
namespace {

void check_display(const MapOptions& o, const OutputPlan& plan, const ColorConfig& colors) {
    if (o.output_space) colors.space(*o.output_space);
    if (!o.display && !o.view) return;
    if (o.output_space)
        throw Error(Error::Kind::usage,
                    "--output-space and --display or --view contradict each other; give one");
    if (plan.scene_linear)
        throw Error(
            Error::Kind::usage,
            fmt::format(
                "{}: --display and --view make pictures to look at; write a .png, .jpg or .tif",
                plan.path));
    Image probe({1, 1}, 3);
    const std::string display = o.display.value_or(colors.displays().front());
    const auto views = colors.views(display);
    colors.to_display(probe, display, o.view.value_or(views.empty() ? "" : views.front()));
}

EnvmapKind envmap_kind(const Layout& layout, bool turned_away) {
    // The attribute says that +Z is in the middle; a preset with other axes must not claim it.
    if (turned_away) return EnvmapKind::none;
    if (layout.name == "latlong") return EnvmapKind::latlong;
    return layout.name == "openexr" ? EnvmapKind::cube : EnvmapKind::none;
}

}  // namespace

Image joined(const Image& map, const Image* fourth, const Image* confidence) {
    const int own = map.channels();
    Image out(map.size(), own + (fourth ? 1 : 0) + (confidence ? 1 : 0));
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            float* to = std::copy_n(map.pixel(x, y), own, out.pixel(x, y));
            if (fourth) *to++ = fourth->pixel(x, y)[3];
            if (confidence) *to = confidence->pixel(x, y)[0];
        }
    return out;
}

Image colors_of(const Image& map) {
    Image rgb(map.size(), 3);
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) std::copy_n(map.pixel(x, y), 3, rgb.pixel(x, y));
    return rgb;
}

void add_encoding_options(CLI::App& command, MapOptions& o) {
    const std::string out = "Output";
    command
        .add_flag("--float", o.output.full_float,
                  "32-bit EXR or TIFF, scene-linear (default: half EXR)")
        ->group(out);
    command.add_option("--bits", o.output.bits, "Of PNG and TIFF (default: 16)")
        ->check(CLI::IsMember({8, 16}))
        ->group(out);
    command
        .add_option("--output-space", o.output_space,
                    "Colour space (default: scene_linear for EXR, HDR and float TIFF; "
                    "srgb_texture for pictures)")
        ->type_name("SPACE")
        ->group("Colour");
    command.add_option("--display", o.display, "Write a picture for this display")
        ->type_name("NAME")
        ->group("Colour");
    command.add_option("--view", o.view, "... through this view, such as \"ACES SDR\"")
        ->type_name("NAME")
        ->group("Colour");
}

void add_confidence_flag(CLI::App& command, bool& wanted) {
    command
        .add_flag("--confidence", wanted,
                  "A channel more, 0 to 1: how far the light is to be believed (EXR, TIFF)")
        ->group("Output");
}

void add_map_options(CLI::App& command, MapOptions& o) {
    const std::string out = "Output";
    command
        .add_option("--layout", o.output.layout,
                    "Shape: " + comma_list(layout_names()) + " (default: latlong)")
        ->type_name("NAME")
        ->group(out);
    command
        .add_option("--for", o.output.preset,
                    "Program that reads it: " + comma_list(preset_names()) +
                        "; sets layout, names, axes and file type")
        ->type_name("PRESET")
        ->group(out);
    command
        .add_option("--size", o.size,
                    "Width of a face, height of a lat-long, side of a ball, pixels (default: the "
                    "power of two from 64 to "
                    "4096 nearest to the source's resolution)")
        ->check(CLI::Range(1, 32768))
        ->group(out);
    command
        .add_option("--format", o.output.format,
                    "exr, hdr, tif, png or jpg, for folders (default: exr)")
        ->type_name("FORMAT")
        ->group(out);
    command
        .add_option("--filter", o.filter,
                    "adaptive: as many taps as needed; fast: one bilinear tap")
        ->check(CLI::IsMember({"adaptive", "fast"}))
        ->capture_default_str()
        ->group(out);
    command
        .add_option("--simd", o.simd,
                    "Instructions of the resampler, AVX3, AVX2, SSE4 or SCALAR: the same ones give "
                    "the same bytes everywhere (default: the best of the processor)")
        ->type_name("TARGET")
        ->group(out);
    add_encoding_options(command, o);
    add_reflectance_option(command, o.reflectance);
    const std::string axes =
        "Orientation (default: the camera's frame, +Z towards the camera, +Y up)";
    command
        .add_option("--camera-to-world", o.camera_to_world,
                    "Rotation, row by row: 9 or 16 numbers (default: the file's worldToCamera)")
        ->type_name("M")
        ->group(axes);
    command
        .add_option(
            "--yaw", o.yaw,
            "Then turned about +Y, degrees; 180 puts what the camera looks at into the middle")
        ->check(finite())
        ->capture_default_str()
        ->group(axes);
    command.add_option("--pitch", o.pitch, "... about +X, degrees")
        ->check(finite())
        ->capture_default_str()
        ->group(axes);
    command.add_option("--roll", o.roll, "... about +Z, degrees")
        ->check(finite())
        ->capture_default_str()
        ->group(axes);
}

void check_map_options(const MapOptions& o, const OutputPlan& plan, const ColorConfig& colors) {
    check_display(o, plan, colors);
    told_rotation(o);
    if (o.reflectance) parse_reflectance(*o.reflectance);
}

void check_confidence(bool wanted, const OutputPlan& plan) {
    if (!wanted || plan.format == FileFormat::exr || plan.format == FileFormat::tif) return;
    throw Error(Error::Kind::usage,
                fmt::format("{}: --confidence is a channel that only EXR and TIFF have; {} has "
                            "none",
                            plan.path, extension_of(plan.format)));
}

void use_instructions(const MapOptions& o) {
    if (use_simd_target(o.simd.value_or(""))) return;
    throw Error(Error::Kind::usage, fmt::format("--simd {}: this processor runs {}", *o.simd,
                                                comma_list(simd_targets())));
}

std::optional<Rotation> told_rotation(const MapOptions& o) {
    if (!o.camera_to_world) return std::nullopt;
    const auto numbers = parse_numbers("--camera-to-world", *o.camera_to_world, {9, 16},
                                       "9 or 16 numbers, row by row");
    const auto rotation = Rotation::nearest(numbers);
    if (!rotation)
        throw Error(Error::Kind::usage,
                    fmt::format("--camera-to-world {}: this is no rotation (columns must be "
                                "perpendicular, of length 1, right-handed, to 1e-3); a scale or a "
                                "mirror must be taken out first",
                                *o.camera_to_world));
    return rotation;
}

Rotation photo_rotation(const MapOptions& o, const Photo& photo, const std::string& camera_axes,
                        const Console& console) {
    if (const auto told = told_rotation(o)) return *told;
    return told_by_file(photo, camera_axes, console).value_or(Rotation());
}

BallLight ball_light(const PhotoJob& job, const MirrorBall& ball, double lens_blur, bool whole,
                     const ColorOptions& color, const MapOptions& options,
                     const ColorConfig& colors, bool keep_pixels, const BallStep& step) {
    BallLight light;
    std::string tag_warning;
    light.space = colors.input_space(job.photo, color.input_space, &tag_warning);
    if (!tag_warning.empty()) light.warnings.push_back(tag_warning);
    const Window& region = light.region =
        whole ? job.photo.window : needed_window(ball.outline(), job.photo.window);
    std::optional<Reflectance> reflectance;
    if (options.reflectance) {
        check_not_undone(job.photo);
        reflectance = parse_reflectance(*options.reflectance);
    }
    Affine& to_pixels = light.to_pixels = job.ball.to_pixels;
    to_pixels.x0 -= region.x;
    to_pixels.y0 -= region.y;
    std::atomic<std::size_t> all_bad = 0;
    const auto working = [&](const Photo& photo, const Window& part) {
        std::size_t bad = 0;
        Image pixels = colors.to_working(photo, light.space, part, &bad);
        if (reflectance) {
            Affine to_part = to_pixels;
            to_part.x0 -= part.x - region.x;
            to_part.y0 -= part.y - region.y;
            undo_reflectance(pixels, ball, to_part, *reflectance);
        }
        all_bad += bad;
        return pixels;
    };
    if (keep_pixels || step) {
        light.pixels = working(job.photo, region);
        if (step) step(light);
        light.source = ball_source(light.pixels, ball, to_pixels, lens_blur);
    } else {
        BallSourceMaker maker(region.size, ball, to_pixels, lens_blur);
        const auto take = [&](const Photo& band) {
            const int top = std::max(region.y, band.window.y);
            const int bottom =
                std::min(region.y + region.size.height, band.window.y + band.window.size.height);
            constexpr int kRows = 32;  // whose pixels, stored and working, stay in a core's cache
            for_each_band(bottom - top, kRows, [&](int first, int last) {
                const Window part{region.x, top + first, {region.size.width, last - first}};
                maker.add(part.y - region.y, working(band, part).view());
            });
        };
        if (job.unread) {
            ReadOptions read = *job.unread;
            read.bands = take;
            const Photo photo = read_photo(job.photo.name, read);
            if (!photo.damage.empty()) light.warnings.push_back(damage_warning(photo));
        } else {
            take(job.photo);
        }
        light.source = maker.finish();
    }
    if (all_bad > 0) light.warnings.push_back(bad_pixel_warning(job.photo.name, all_bad));
    return light;
}

void tell(const BallLight& light, const Photo& photo, const Console& console) {
    for (const std::string& warning : light.warnings) console.warn(warning);
    console.say(fmt::format("{}: {}x{} pixels, colour space {}", photo.name, photo.display.width,
                            photo.display.height, light.space));
}

ResampleOptions resampling(const MapOptions& o, const OutputPlan& plan, const Rotation& to_world) {
    ResampleOptions how;
    how.filter = o.filter == "fast" ? Filter::fast : Filter::adaptive;
    const Rotation axes = plan.preset ? plan.preset->axes : Rotation();
    how.rotation = axes * (Rotation::yaw_pitch_roll(o.yaw, o.pitch, o.roll) * to_world);
    return how;
}

std::string encode(Image& map, const MapOptions& o, const OutputPlan& plan,
                   const ColorConfig& colors) {
    if (o.display || o.view) {
        const std::string display = o.display.value_or(colors.displays().front());
        const std::string view = o.view.value_or(colors.views(display).front());
        colors.to_display(map, display, view);
        return fmt::format("{}, {}", display, view);
    }
    const std::string space = colors.output_space(o.output_space, plan.scene_linear);
    colors.from_working(map, space);
    return space;
}

WriteOptions write_options(const MapOptions& o, const OutputPlan& plan, const std::string& space,
                           const ColorConfig& colors) {
    WriteOptions write;
    write.format = plan.format;
    write.full_float = o.output.full_float;
    write.bits = o.output.bits.value_or(16);
    if (!o.display && !o.view) write.color = colors.tag(space);
    return write;
}

WrittenMap write_finished(Image map, const OutputPlan& plan, const MapOptions& o,
                          const Rotation& rotation, Provenance origin, Metadata metadata,
                          const ColorConfig& colors, const MapExtras& extras) {
    WrittenMap written;
    if (extras.filled) {
        // Encoding would take colours with alpha 0 for none.
        Image rgb = colors_of(map);
        written.space = encode(rgb, o, plan, colors);
        map = joined(rgb, &map, nullptr);
    } else {
        written.space = encode(map, o, plan, colors);
    }
    if (!extras.confidence.empty()) map = joined(map, nullptr, &extras.confidence);
    const bool turned_away = plan.preset && !plan.preset->axes.is_identity();
    WriteOptions write = write_options(o, plan, written.space, colors);
    write.envmap = envmap_kind(*plan.layout, turned_away);
    write.confidence = !extras.confidence.empty();
    origin.version = kVersion;
    origin.layout = turned_away ? fmt::format("{} for {}", plan.layout->name, plan.preset->name)
                                : std::string(plan.layout->name);
    origin.rotation = rotation.rows();
    write.metadata = std::move(metadata);
    write.metadata.set(to_attribute(origin));
    write_map(plan, map, write, written.report);
    written.size = map.width() / plan.layout->width_units;
    return written;
}

std::vector<std::string> warnings_of(const WrittenMap& written, const OutputPlan& plan,
                                     const MapOptions& o) {
    std::vector<std::string> warnings;
    const WriteReport& report = written.report;
    // A display ends at white; that a picture for it does too is no news.
    if (report.clamped > 0 && !o.display && !o.view)
        warnings.push_back(clamp_warning(plan.path, report.clamped, plan.format));
    if (report.repaired > 0)
        warnings.push_back(fmt::format("{}: {} values were NaN or infinite and were replaced",
                                       plan.path, report.repaired));
    return warnings;
}

void tell(const WrittenMap& written, const OutputPlan& plan, const MapOptions& o,
          const Console& console, const std::string& more) {
    for (const std::string& warning : warnings_of(written, plan, o)) console.warn(warning);
    const Size pixels = plan.layout->picture(written.size);
    console.say(fmt::format("{}: {} --size {} ({}x{} pixels){}, colour space {}", plan.path,
                            plan.layout->name, written.size, pixels.width, pixels.height, more,
                            written.space));
}

std::string clamp_warning(const std::string& path, std::size_t values, FileFormat format) {
    return fmt::format("{}: {} values above what the format holds were clamped{}", path, values,
                       format == FileFormat::exr ? " to 65504; --float keeps them" : "");
}

std::string bad_pixel_warning(const std::string& name, std::size_t count) {
    return fmt::format("{}: {} pixels are NaN or infinite; they are left out", name, count);
}

}  // namespace chromeball
