#include "picture_file.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "io/facts.h"
#include "io/write.h"
#include "version.h"

namespace chromeball {

void add_picture_options(CLI::App& command, MapOptions& o) {
    const std::string out = "Output";
    command.add_flag("--float", o.output.full_float, "32-bit EXR or TIFF (default: half EXR)")
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

void write_picture(const std::string& path, Image picture, const OutputPlan& plan,
                   const MapOptions& o, const std::string& source, const ColorConfig& colors,
                   const Console& console, Metadata metadata) {
    WrittenMap written;
    written.space = encode(picture, o, plan, colors);
    WriteOptions write;
    write.format = plan.format;
    write.full_float = o.output.full_float;
    write.bits = o.output.bits.value_or(16);
    if (!o.display && !o.view) write.color = colors.tag(written.space);
    write.metadata = std::move(metadata);
    write.metadata.set(to_attribute({.version = kVersion, .source = source}));
    written.report = write_image(path, picture.view(), write);
    OutputPlan of_this = plan;
    of_this.path = path;
    // A picture to look at ends at white; one of light does not.
    if (plan.scene_linear)
        for (const std::string& warning : warnings_of(written, of_this, o)) console.warn(warning);
    console.say(fmt::format("{}: {}x{} pixels, colour space {}", path, picture.width(),
                            picture.height(), written.space));
}

}  // namespace chromeball
