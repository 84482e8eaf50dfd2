#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "core/image.h"
#include "core/metadata.h"

namespace chromeball {

/// How much light a photo was given, as its file tells it; what it is silent about is absent.
struct ExposureTags {
    std::optional<double> time;      ///< seconds
    std::optional<double> aperture;  ///< the f-number N
    std::optional<double> iso;

    bool operator==(const ExposureTags&) const = default;
};

/// From metadata under OpenEXR's standard names (see pass_through): expTime, aperture, isoSpeed.
/// Numbers that are not above 0 count as silent.
ExposureTags exposure_tags(const Metadata& metadata);

/// How large a number the camera writes for one unit of light, up to a factor of the camera's own:
/// time x (ISO / 100) / N^2 (ISO 2720). An absent ISO counts as 100, an absent N as 1; nothing
/// without a time.
std::optional<double> exposure_of(const ExposureTags& tags);

/// The exposure value at ISO 100, log2(N^2 / time x 100 / ISO), that an exposure amounts to; and
/// back.
double ev100_of(double exposure);
double exposure_of_ev100(double ev100);

/// One photo of a bracket, as stored: three channels, integers over 0 to 1.
struct ExposedPhoto {
    std::string name;  ///< for messages
    Size size;
    /// Fills `rows` with the rows first to last; may be called from many threads at once.
    std::function<void(int first, int last, ImageView<float> rows)> read = nullptr;
    double step = 0;  ///< between neighbouring stored numbers; 0: floats
    /// The stored number at which channels clip.
    double white = std::numeric_limits<double>::infinity();
    double iso = 100;    ///< how noisy it is
    bool mixed = false;  ///< its channels are sums of the sensor's: where one clips none is right
};

/// The stored number at which photos of one camera clip, all at the same one: where numbers pile up
/// at their greatest. Integers clip at 1 at the latest; floats perhaps nowhere (infinity).
double clip_level(std::span<const ExposedPhoto> photos, bool integers);

/// Standard deviation of a photo's light (1 at white), squared, by the usual model: shot noise that
/// grows with the light, and noise of reading. The numbers are those of a sensor that holds
/// 60000 electrons at ISO 100 and reads them with an error of a dark patch of an eighth of white's
/// shot noise; what matters here is how light compares with dark and ISO with ISO.
///
/// slope   light per stored number there; a stored number is wrong by a step
double noise_variance(const ExposedPhoto& photo, double light, double slope);

}  // namespace chromeball
