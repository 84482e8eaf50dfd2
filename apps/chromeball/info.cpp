#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "commands.h"
#include "console.h"
#include "core/error.h"
#include "inspect.h"
#include "options.h"
#include "report.h"

namespace chromeball {
namespace {

struct InfoOptions {
    std::string file;
    std::optional<std::string> from;
    CommonOptions common;
    ColorOptions color;
    std::int64_t max_pixels = 400'000'000;
    bool json = false;
};

std::string text_of(const InfoReport& r) {
    std::string text = fmt::format("{}: {}x{} pixels, {} channel{}, {}\n", r.file, r.size.width,
                                   r.size.height, r.channels, r.channels == 1 ? "" : "s", r.type);
    const auto line = [&](std::string_view what, const std::string& value) {
        text += fmt::format("  {:<17} {}\n", what, value);
    };
    line("layout", r.layout.empty() ? r.layout_sureness
                                    : fmt::format("{} ({})", r.layout, r.layout_sureness));
    line("colour space", r.color_space);
    line("range", r.range_stops
                      ? fmt::format("{:.1f} stops, maximum {:.4g}", *r.range_stops, r.maximum)
                      : "nothing but black");
    line(r.over_sphere ? "mean radiance" : "mean pixel",
         fmt::format("{:.5g} {:.5g} {:.5g}", r.mean_radiance[0], r.mean_radiance[1],
                     r.mean_radiance[2]));
    if (r.covered_steradians)
        line("covered", fmt::format("{:.4f} of 12.5664 sr ({:.2f} %)", *r.covered_steradians,
                                    *r.covered_steradians / 0.125663706));
    if (r.bad_pixels > 0) line("bad pixels", fmt::format("{} NaN or infinite", r.bad_pixels));
    line("provenance", r.provenance.value_or("none"));
    for (const std::string& note : r.notes) line("note", note);
    return text;
}

void run_info(const InfoOptions& o) {
    const UsedThreads threads(o.common);
    const ColorConfig colors = ColorConfig::load(o.color.ocio);
    const InfoReport report = inspect(o.file, o.from, o.max_pixels, colors, o.color.input_space);
    print_result(o.json ? to_json(report) : text_of(report));
}

}  // namespace

void add_info(CLI::App& app) {
    auto o = std::make_shared<InfoOptions>();
    auto* command = app.add_subcommand("info", "Tell what a map is, covers and holds");
    command->add_option("file", o->file, "Map, photo, or folder of faces")->required();
    command->add_option("--from", o->from, "Its layout (default: guessed)")->type_name("NAME");
    command->add_flag("--json", o->json, "For machines");
    command->add_option("--max-pixels", o->max_pixels, "Refuse larger pictures")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    add_color_options(*command, o->color);
    add_common_options(*command, o->common);
    command->footer("Example:\n  chromeball info probe.exr");
    command->callback([o] { run_info(*o); });
}

}  // namespace chromeball
