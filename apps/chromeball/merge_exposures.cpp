#include "merge_exposures.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/facts.h"
#include "io/read.h"
#include "map_files.h"
#include "refuse.h"

namespace chromeball {
namespace {

bool told_differ(const Bracket& bracket) {
    double least = 1e9, most = -1e9;
    for (const auto& t : bracket.told)
        if (t) least = std::min(least, *t), most = std::max(most, *t);
    return most - least > 0.3;
}

/// Nominal shutter speeds, apertures and ISOs are off by up to a tenth of a stop each; beyond this
/// they are wrong.
constexpr double kWrongStops = 0.25;

int wrong_tags(const Bracket& bracket, const BracketFit& fit) {
    int wrong = 0;
    for (std::size_t k = 0; k < fit.stops.size(); ++k)
        wrong += bracket.told[k] && std::abs(*fit.stops[k] - *bracket.told[k]) > kWrongStops;
    return wrong;
}

/// Another curve than the assumed one has to earn its place: by being another one, and by fitting
/// clearly better or by making several tags right.
bool deserves(const Solved& solved, const Solved& assumed, const Bracket& bracket) {
    constexpr double kOther = 0.1, kClear = 0.015;  // stops
    constexpr std::size_t kEnough = 200;            // patches
    if (solved.fit.patches < kEnough || solved.fit.curve_stops < kOther) return false;
    const double mine = solved.fit.rms_stops, its = assumed.fit.rms_stops;
    if (its > mine && std::sqrt(its * its - mine * mine) > kClear && mine < 0.85 * its) return true;
    return wrong_tags(bracket, assumed.fit) >= 2 && wrong_tags(bracket, solved.fit) == 0;
}

Metadata exposure_facts(const Metadata& from) {
    Metadata facts;
    for (const char* name : {"expTime", "aperture", "isoSpeed"})
        if (const Attribute* a = from.find(name)) facts.set(*a);
    return facts;
}

Anchor ev_anchor(double ev100, const Bracket& bracket, int reference) {
    Anchor anchor;
    anchor.stops = std::log2(exposure_of_ev100(ev100));
    const ExposureTags& t = bracket.tags[static_cast<std::size_t>(reference)];
    ExposureTags unit = t;
    unit.time = 1;
    anchor.metadata.set("expTime", std::exp2(anchor.stops) / *exposure_of(unit));
    if (t.aperture) anchor.metadata.set("aperture", *t.aperture);
    if (t.iso) anchor.metadata.set("isoSpeed", *t.iso);
    return anchor;
}

}  // namespace

Solved solve(const std::string& choice, const Bracket& bracket, std::span<const Patch> patches) {
    BracketFitOptions how{bracket.response, false};
    Solved assumed{fit_bracket(patches, bracket.exposed, bracket.told, how), "assumed", {}};
    if (bracket.response.is_linear()) {
        assumed.response = "linear";
        assumed.words = "linear";
        return assumed;
    }
    assumed.words = fmt::format("{} (fits to {:.3f} stops)", bracket.space, assumed.fit.rms_stops);
    if (choice == "srgb") return assumed;
    if (!told_differ(bracket)) {
        if (choice == "solve")
            refuse(
                "--response solve: needs two exposures or more that are known and differ, since "
                "pictures alone tell a curve up to a power only; give --times");
        assumed.words += ", assumed, since no exposures are told that differ";
        return assumed;
    }
    how.solve_curve = true;
    Solved solved{fit_bracket(patches, bracket.exposed, bracket.told, how), "solved", {}};
    solved.words = fmt::format(
        "solved from {} patches (fits to {:.3f} stops, {} to {:.3f}; they "
        "differ by up to {:.2f} stops)",
        solved.fit.patches, solved.fit.rms_stops, bracket.space, assumed.fit.rms_stops,
        solved.fit.curve_stops);
    if (choice == "solve") return solved;
    return deserves(solved, assumed, bracket) ? solved : assumed;
}

std::vector<double> final_stops(const Bracket& bracket, const BracketFit& fit,
                                const Console& console) {
    std::vector<double> stops;
    for (std::size_t k = 0; k < fit.stops.size(); ++k) {
        const std::string& name = bracket.exposed[k].name;
        const auto& told = bracket.told[k];
        const auto& seen = fit.stops[k];
        if (!told && !seen)
            throw Error(Error::Kind::failed,
                        fmt::format("{}: its {} is not known, and it shares no well exposed part "
                                    "with the other photos from which it could be solved; give "
                                    "--times",
                                    name, missing_tags(bracket, k)));
        if (!told) {
            console.say(fmt::format("{}: no {}; its exposure was solved from the pictures", name,
                                    missing_tags(bracket, k)));
        } else if (std::abs(*seen - *told) > kWrongStops) {
            console.warn(fmt::format(
                "{}: its exposure as told is {:+.2f} stops off what the pictures show; that of the "
                "pictures is used",
                name, *told - *seen));
        }
        stops.push_back(told && std::abs(*seen - *told) <= kWrongStops ? *told : *seen);
    }
    return stops;
}

Anchor anchor_of(const std::optional<std::string>& told, const std::vector<std::string>& files,
                 const Bracket& bracket, const std::vector<double>& stops, int reference) {
    Anchor anchor{stops[static_cast<std::size_t>(reference)],
                  exposure_facts(
                      pass_through(bracket.photos[static_cast<std::size_t>(reference)]->metadata))};
    if (!told) return anchor;
    const auto named = std::ranges::find(files, *told);
    if (named != files.end()) {
        const auto k = static_cast<std::size_t>(named - files.begin());
        return {stops[k], exposure_facts(pass_through(bracket.photos[k]->metadata))};
    }
    if (std::ranges::none_of(bracket.told, [](const auto& t) { return !!t; }))
        refuse(
            fmt::format("--anchor {}: no exposure of these photos is known, so that they cannot "
                        "be put on an absolute scale; give --times, or name one of the photos",
                        *told));
    double ev100 = 0;
    if (CLI::detail::lexical_cast(*told, ev100) && std::isfinite(ev100))
        return ev_anchor(ev100, bracket, reference);
    const Metadata facts = exposure_facts(pass_through(read_header(*told).metadata));
    const auto exposure = exposure_of(exposure_tags(facts));
    if (!exposure)
        refuse(
            fmt::format("--anchor {}: does not tell its exposure; name another photo, or an "
                        "EV100 such as 12",
                        *told));
    return {std::log2(*exposure), facts};
}

}  // namespace chromeball
