#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bracket.h"
#include "console.h"
#include "core/metadata.h"
#include "light/response.h"

namespace chromeball {

/// What the pictures of a bracket say of exposures and response, and which response is used.
struct Solved {
    BracketFit fit;
    std::string response;  ///< "linear", "assumed", "solved"
    std::string words;     ///< for the user
};

/// `choice` is "srgb" (the input space's curve), "solve" or "auto" (solved where it fits clearly
/// better). Throws Error (usage) where a curve is to be solved that the photos cannot tell.
Solved solve(const std::string& choice, const Bracket& bracket, std::span<const Patch> patches);

/// log2 of exposures: told ones where the pictures do not contradict them. Says which are solved,
/// warns of wrong ones. Throws Error for a photo of which neither is known.
std::vector<double> final_stops(const Bracket& bracket, const BracketFit& fit,
                                const Console& console);

/// The output's unit: 1 is what fills the scale at this exposure, log2.
struct Anchor {
    double stops = 0;
    Metadata metadata;  ///< exposure facts that go with it
};

/// Of `--anchor`: a photo of the bracket's `files`, another photo, an EV100; absent: the
/// reference. Throws Error (usage) where it does not tell an exposure.
Anchor anchor_of(const std::optional<std::string>& told, const std::vector<std::string>& files,
                 const Bracket& bracket, const std::vector<double>& stops, int reference);

}  // namespace chromeball
