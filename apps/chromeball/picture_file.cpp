#include "picture_file.h"

#include <fmt/format.h>

#include "io/facts.h"
#include "io/write.h"
#include "version.h"

namespace chromeball {

void write_picture(const std::string& path, Image picture, const OutputPlan& plan,
                   const MapOptions& o, const std::string& source, const ColorConfig& colors,
                   const Console& console, Metadata metadata) {
    WrittenMap written;
    written.space = encode(picture, o, plan, colors);
    WriteOptions write = write_options(o, plan, written.space, colors);
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
