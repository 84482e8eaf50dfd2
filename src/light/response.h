#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/watch.h"
#include "light/exposure.h"
#include "map/camera.h"

namespace chromeball {

/// What light a stored number stands for, one curve for all channels, so that grey stays grey.
/// Light is 1 where the stored number is 1.
class Response {
public:
    /// Stored numbers are light already, also above 1.
    static Response linear() { return Response(); }
    /// IEC 61966-2-1.
    static Response srgb();
    /// Light at the stored numbers 0, 1/(n-1), ... 1; at least 2, not falling, the last above 0;
    /// it is made 1. Between them linear.
    explicit Response(std::vector<float> nodes);

    bool is_linear() const { return light_.empty(); }
    float light(float stored) const {
        if (is_linear()) return stored;
        const Place at = place(stored);
        return light_[at.node] + at.part * (light_[at.node + 1] - light_[at.node]);
    }
    /// Light per stored number.
    float slope(float stored) const {
        if (is_linear()) return 1;
        const Place at = place(stored);
        return (light_[at.node + 1] - light_[at.node]) * last_;
    }

private:
    struct Place {
        std::size_t node;
        float part;
    };
    Response() = default;
    Place place(float stored) const {
        const float at = stored > 0 ? (stored < 1 ? stored : 1) * last_ : 0;  // NaN counts as 0
        const float node = at < last_ ? static_cast<float>(static_cast<int>(at)) : last_ - 1;
        return {static_cast<std::size_t>(node), at - node};
    }

    std::vector<float> light_;
    float last_ = 0;  ///< the last node's number
};

/// A small even part of the scene: its mean stored numbers in each photo; NaN where a photo does
/// not show it well (clipped, black, uneven, outside).
struct Patch {
    std::vector<std::array<float, 3>> stored;
};

/// Even parts that the photos share, a few thousand of all brightnesses, for fit_bracket.
///
/// shifts   what the merged picture shows at p lies at p + shift in that photo
std::vector<Patch> even_patches(std::span<const ExposedPhoto> photos, std::span<const V2d> shifts,
                                const Watch& watch = {});

struct BracketFitOptions {
    /// The assumed curve; the solved one is a correction of it.
    Response assumed = Response::srgb();
    bool solve_curve = false;
};

/// Exposures, and a response, that explain the same patches in all photos.
struct BracketFit {
    Response response = Response::linear();
    /// log2 of each photo's exposure as the pictures show it, in the told ones' unit; where none
    /// was told, one photo's is 0. Nothing where a photo shares no well exposed part with the
    /// others.
    std::vector<std::optional<double>> stops;
    double rms_stops = 0;  ///< how far patches are from it
    /// The largest difference of the solved curve from the assumed one, where patches show it.
    double curve_stops = 0;
    std::size_t patches = 0;
};

/// Debevec and Malik: Recovering High Dynamic Range Radiance Maps from Photographs, 1997, eq. 3:
/// ln f(z) = ln E + ln t for all patches and photos by least squares, robustly, f smooth and
/// rising.
///
/// Exposures and curve together are known up to a power only (Grossberg and Nayar: What Can Be
/// Known about the Radiometric Response from Images?, 2002): a curve is solved with the told
/// exposures as they are (at least two that differ), those not told with it. Told ones that fit
/// much better when they are not believed are not. Then, with the curve, all exposures are solved.
///
/// told     log2 of each photo's exposure, where it is known
BracketFit fit_bracket(std::span<const Patch> patches, std::span<const ExposedPhoto> photos,
                       std::span<const std::optional<double>> told,
                       const BracketFitOptions& options);

}  // namespace chromeball
