#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "color/color.h"
#include "console.h"
#include "core/photo.h"
#include "light/exposure.h"
#include "light/response.h"

namespace chromeball {

/// Photos of one size and one colour space, as merge needs them.
struct Bracket {
    std::vector<std::shared_ptr<const Photo>> photos;
    std::vector<ExposedPhoto> exposed;
    std::vector<ExposureTags> tags;
    /// log2 of the exposure as tags tell it; nothing where one that others have is missing.
    std::vector<std::optional<double>> told;
    std::string space;
    Response response = Response::linear();  ///< of that space
    /// From light in the photos' own primaries, 1 at white, to the working space.
    std::array<double, 9> to_working{};
    Size size() const { return exposed.front().size; }
};

/// Reads all. `times` are seconds, one a photo, or none: those of the tags. Throws Error naming the
/// photo: not readable, of another size, another kind or colour space than the first.
Bracket read_bracket(const std::vector<std::string>& files, const std::vector<double>& times,
                     const std::optional<std::string>& input_space, std::int64_t max_pixels,
                     const ColorConfig& colors, const Console& console);

/// A photo as the layer of light looks at it. `linear`: its stored numbers are light already.
ExposedPhoto exposed(std::shared_ptr<const Photo> photo, const ExposureTags& tags, bool linear);

/// Whether a photo's tags say how it was exposed, and what is missing: "time", ...
std::string missing_tags(const Bracket& bracket, std::size_t photo);

/// Exposure tags under the standard names, from any format's metadata.
ExposureTags tags_of(const Metadata& metadata);

}  // namespace chromeball
