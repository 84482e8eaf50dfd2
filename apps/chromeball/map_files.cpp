#include "map_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/names.h"
#include "core/parallel.h"
#include "io/write.h"
#include "refuse.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

std::string unknown(std::string_view what, const std::string& name,
                    const std::vector<std::string>& names) {
    return fmt::format("{} \"{}\" is not known; {}", what, name, did_you_mean(name, names));
}

const Layout& chosen_layout(const OutputOptions& o, const Preset* preset) {
    if (o.layout && !find_layout(*o.layout)) refuse(unknown("layout", *o.layout, layout_names()));
    if (preset && o.layout && *o.layout != preset->layout)
        refuse(fmt::format(
            "--for {} means --layout {}, but --layout {} is asked for; leave one of them out",
            preset->name, preset->layout, *o.layout));
    return *find_layout(preset     ? preset->layout
                        : o.layout ? std::string_view(*o.layout)
                                   : "latlong");
}

FileFormat named_format(const std::string& name) {
    const auto format = format_from_extension(name);
    if (!format)
        refuse(fmt::format("format \"{}\" is not known; choose exr, hdr, tif, png or jpg", name));
    return *format;
}

/// Of a single file: its extension decides.
FileFormat file_format(const OutputOptions& o) {
    const std::string extension = fs::path(o.output).extension().string();
    if (extension.empty())
        refuse(fmt::format(
            "{}: a file name needs an extension that says its format: .exr, .hdr, .tif, .png or "
            ".jpg (or ask for --layout faces, whose output is a folder)",
            o.output));
    const auto format = format_from_extension(extension);
    if (!format)
        refuse(
            fmt::format("{}: \"{}\" files are not written; choose .exr, .hdr, .tif, .png or .jpg",
                        o.output, extension));
    if (o.format && named_format(*o.format) != *format)
        refuse(fmt::format("{}: the extension says {}, --format says {}; leave --format out",
                           o.output, extension_of(*format), *o.format));
    return *format;
}

FileFormat folder_format(const OutputOptions& o, const Preset* preset) {
    const auto extension = format_from_extension(fs::path(o.output).extension().string());
    if (extension && !fs::is_directory(o.output))
        refuse(fmt::format("{}: six faces are six files; name a folder, as -o {}", o.output,
                           fs::path(o.output).replace_extension().string()));
    if (o.format) return named_format(*o.format);
    return preset ? *format_from_extension(preset->extension) : FileFormat::exr;
}

/// One face of six below each other.
ImageView<const float> face_of(const Image& map, int face) {
    const int size = map.width();
    const ImageView<const float> all = map.view();
    return {all.row(face * size), {size, size}, all.channels, all.stride};
}

void add(WriteReport& total, const WriteReport& one) {
    total.clamped += one.clamped;
    total.repaired += one.repaired;
}

}  // namespace

std::array<std::string, 6> OutputPlan::face_files() const {
    const auto& names = preset ? preset->face_names : default_face_names();
    std::array<std::string, 6> files;
    for (std::size_t i = 0; i < 6; ++i)
        files[i] = (fs::path(path) / fmt::format("{}.{}", names[i], extension_of(format))).string();
    return files;
}

OutputPlan plan_output(const OutputOptions& o) {
    OutputPlan plan;
    if (o.output.empty()) refuse("-o \"\": name a file or a folder to write");
    if (o.preset) {
        plan.preset = find_preset(*o.preset);
        if (!plan.preset) refuse(unknown("preset", *o.preset, preset_names()));
    }
    plan.layout = &chosen_layout(o, plan.preset);
    plan.path = o.output;
    plan.format = plan.layout->separate_faces ? folder_format(o, plan.preset) : file_format(o);
    if (o.full_float && o.bits)
        refuse(
            fmt::format("--float means 32 bits, --bits says {}; leave one of them out", *o.bits));
    if (o.full_float && plan.format != FileFormat::exr && plan.format != FileFormat::tif)
        refuse(fmt::format("--float goes with EXR and TIFF; {} has no 32-bit floats",
                           extension_of(plan.format)));
    plan.scene_linear =
        plan.format == FileFormat::exr || plan.format == FileFormat::hdr || o.full_float;
    return plan;
}

void check_output(const OutputPlan& plan, const std::string& input) {
    std::vector<std::string> targets{plan.path};
    if (plan.layout->separate_faces) {
        const auto files = plan.face_files();
        targets.insert(targets.end(), files.begin(), files.end());
    }
    // A second run would take the first one's result as its input.
    for (const std::string& target : targets) check_not_input(target, input);

    if (!plan.layout->separate_faces) {
        check_target(plan.path);
    } else if (fs::is_directory(plan.path)) {
        for (std::size_t i = 1; i < targets.size(); ++i) check_target(targets[i]);
    } else {
        const std::string folder = (fs::path(plan.path) / "").parent_path().string();
        if (fs::exists(fs::symlink_status(folder))) make_folder(folder);  // says what it is
        check_target(folder);
    }
}

void check_not_input(const std::string& target, const std::string& input) {
    std::error_code no_such_file;
    if (fs::equivalent(target, input, no_such_file))
        refuse(fmt::format("{}: would replace the input {}; name another output", target, input));
}

std::vector<std::string> write_map(const OutputPlan& plan, const Image& map,
                                   const WriteOptions& options, WriteReport& report) {
    if (!plan.layout->separate_faces) {
        add(report, write_image(plan.path, map.view(), options));
        return {plan.path};
    }
    const auto files = plan.face_files();
    const bool new_folder = !fs::exists(plan.path);
    make_folder(plan.path);
    try {
        std::array<WriteReport, 6> reports;
        for_each_band(6, 1, [&](int face, int) {
            const auto at = static_cast<std::size_t>(face);
            reports[at] = write_image(files[at], face_of(map, face), options);
        });
        for (const WriteReport& one : reports) add(report, one);
    } catch (...) {
        // Of what was not there before nothing stays.
        std::error_code ignored;
        if (new_folder) {
            for (const std::string& file : files) fs::remove(file, ignored);
            fs::remove(plan.path, ignored);
        }
        throw;
    }
    return {files.begin(), files.end()};
}

std::optional<std::array<std::string, 6>> faces_in(const std::string& folder) {
    std::vector<std::array<std::string_view, 6>> name_sets{default_face_names()};
    for (const Preset& preset : presets()) name_sets.push_back(preset.face_names);
    name_sets.push_back({"posx", "negx", "posy", "negy", "posz", "negz"});
    for (const auto& names : name_sets)
        for (const char* extension : {"exr", "hdr", "tif", "tiff", "png", "jpg", "jpeg"}) {
            std::array<std::string, 6> files;
            bool all = true;
            for (std::size_t i = 0; i < 6; ++i) {
                files[i] = (fs::path(folder) / fmt::format("{}.{}", names[i], extension)).string();
                all = all && fs::exists(files[i]);
            }
            if (all) return files;
        }
    return std::nullopt;
}

}  // namespace chromeball
