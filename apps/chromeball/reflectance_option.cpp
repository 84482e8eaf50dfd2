#include "reflectance_option.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <fstream>
#include <sstream>

#include "core/names.h"
#include "io/facts.h"
#include "numbers.h"
#include "refuse.h"
#include "report.h"

namespace chromeball {
namespace {

std::vector<std::string> material_names() {
    std::vector<std::string> names;
    for (const BallMaterial& material : ball_materials()) names.emplace_back(material.name);
    return names;
}

std::string content_of(const std::string& file) {
    std::ifstream in(file);
    if (!in) refuse(fmt::format("--reflectance {}: no such file can be read", file));
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

bool is_file(const std::string& text) { return text.ends_with(".json"); }

bool is_word(const std::string& text) {
    return !text.empty() &&
           ((text[0] >= 'a' && text[0] <= 'z') || (text[0] >= 'A' && text[0] <= 'Z'));
}

}  // namespace

void add_reflectance_option(CLI::App& command, std::optional<std::string>& text) {
    command
        .add_option(
            "--reflectance", text,
            "What the mirror gives back, 0 to 1; divided out. A number, one a channel, what "
            "\"calibrate\" wrote, or by angle: chromium, nickel, steel, aluminium, silver")
        ->type_name("R|R,G,B|FILE.json|NAME")
        ->group("Colour");
}

std::array<double, 3> parse_albedo(const std::string& option, const std::string& text) {
    auto r = parse_numbers(option, text, {1, 3}, "R or R,G,B, each above 0 and at most 1");
    if (r.size() == 1) r = {r[0], r[0], r[0]};
    for (const double part : r)
        if (!(part > 0 && part <= 1))
            refuse(fmt::format("{} {}: a surface gives back a part above 0 and at most 1", option,
                               text));
    return {r[0], r[1], r[2]};
}

Reflectance parse_reflectance(const std::string& text) {
    if (is_file(text)) {
        const auto reflectance = reflectance_from_json(content_of(text));
        if (!reflectance)
            refuse(
                fmt::format("--reflectance {}: is no reflectance; \"chromeball calibrate\" "
                            "writes one",
                            text));
        return *reflectance;
    }
    if (const BallMaterial* material = find_ball_material(text))
        return {{1, 1, 1}, material->constants};
    // "nan" and "inf" are numbers, if useless ones.
    if (is_word(text) && text != "nan" && text != "inf")
        refuse(fmt::format("--reflectance {}: expected numbers, a .json file, or one of {}", text,
                           quoted_list(material_names())));
    return {parse_albedo("--reflectance", text)};
}

void check_not_undone(const Photo& photo) {
    const auto past = provenance_from(photo.metadata);
    if (past && !past->reflectance.empty())
        refuse(
            fmt::format("{}: its mirror's reflectance ({}) is undone already, by the merge that "
                        "wrote it; leave --reflectance out",
                        photo.name, past->reflectance));
}

std::string reflectance_words(const std::string& text) {
    return is_file(text) ? content_of(text) : text;
}

}  // namespace chromeball
