#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bracket.h"
#include "console.h"
#include "light/align.h"

namespace chromeball {

/// The photos' numbers from dark to bright: by what they were told, else by how bright they look.
std::vector<int> order_of(const Bracket& bracket);

/// Where the photos of a bracket lie on the reference.
struct Placed {
    std::vector<std::optional<Outline>> balls;  ///< in each photo, where it is known
    AlignOptions options;
    std::vector<Alignment> shifts;
    std::vector<V2d> moves;  ///< the shifts alone
};

/// The ball in each photo of a bracket: as `told` ("CX,CY,R") for the reference, else as found;
/// those only that agree in size. Throws Error (usage) for a told one that is no ball.
std::vector<std::optional<Outline>> alike_balls(const std::optional<std::string>& told,
                                                const Bracket& bracket, int reference,
                                                const Console& console);

/// Lays the photos on the reference by the ball's outlines first, then by the pictures. Says whose
/// ball is lost.
Placed placed_photos(const std::optional<std::string>& told, const Bracket& bracket,
                     const std::vector<int>& order, int reference, const Console& console);

/// Takes photos out of a bracket that show something else than the others, and warns of them; their
/// names. Throws Error where no two show the same.
std::vector<std::string> leave_out_unlike(Bracket& bracket, const Placed& placed,
                                          const Console& console);

/// Once more, with the response that was found meanwhile.
void place_again(Placed& placed, const Bracket& bracket, const std::vector<int>& order,
                 int reference, const Response& response, const Console& console);

/// The ball in the merged picture, by the reference, or by any photo that shows it.
std::optional<Outline> merged_ball(const Placed& placed, int reference);

/// Says how far each photo was shifted, and warns of those that could not be placed.
void tell_shifts(const Bracket& bracket, const std::vector<Alignment>& shifts, int reference,
                 const Console& console);

}  // namespace chromeball
