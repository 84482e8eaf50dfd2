#include "picture_file.h"

#include <fmt/format.h>

#include "io/facts.h"
#include "io/write.h"
#include "version.h"

namespace chromeball {

WrittenMap write_picture_file(const std::string& path, Image picture, const OutputPlan& plan,
                              const MapOptions& o, Provenance origin, const ColorConfig& colors,
                              Metadata metadata) {
    WrittenMap written;
    written.space = encode(picture, o, plan, colors);
    WriteOptions write = write_options(o, plan, written.space, colors);
    write.metadata = std::move(metadata);
    origin.version = kVersion;
    write.metadata.set(to_attribute(origin));
    written.report = write_image(path, picture.view(), write);
    return written;
}

void write_picture(const std::string& path, Image picture, const OutputPlan& plan,
                   const MapOptions& o, const std::string& source, const ColorConfig& colors,
                   const Console& console, Metadata metadata) {
    const Size size = picture.size();
    const WrittenMap written = write_picture_file(path, std::move(picture), plan, o,
                                                  {.source = source}, colors, std::move(metadata));
    OutputPlan of_this = plan;
    of_this.path = path;
    // A picture to look at ends at white; one of light does not.
    if (plan.scene_linear)
        for (const std::string& warning : warnings_of(written, of_this, o)) console.warn(warning);
    console.say(fmt::format("{}: {}x{} pixels, colour space {}", path, size.width, size.height,
                            written.space));
}

}  // namespace chromeball
