#pragma once

#include <array>
#include <optional>

#include "core/outline.h"
#include "detect/grey.h"
#include "detect/shape.h"

namespace chromeball::detecting {

/// Covariance of x, y, radius, e1, e2 of a Shape.
using ShapeCovariance = std::array<std::array<double, 5>, 5>;

/// How the rim is looked for around a first outline.
struct EdgeSearch {
    int rays = 256;
    double step = 0.5;  ///< pixels between samples; the outline may be wrong by four of them
    double blur = 0;    ///< sigma across the rim if it is known, pixels
};

/// A shape and how well it is known.
struct FreeShape {
    Shape shape;
    ShapeCovariance covariance;
};

/// The rim as found.
struct EdgeFit {
    Outline outline;
    ShapeCovariance covariance{};
    /// The same found without any hint of the lens, where there is but a hint: what the rim alone
    /// says of its shape.
    std::optional<FreeShape> free;
    double blur = 0;      ///< sigma across the rim, pixels
    double clear = 0;     ///< part of the rays that show a mirror's rim right there, 0 to 1
    double evidence = 0;  ///< log-likelihood of the rim over none, mean over the rays
    double known = 0;     ///< part of the rays whose surroundings lie in the picture
};

/// The rim near `start` to a fraction of a pixel.
EdgeFit fit_edge(const Raster<float>& picture, const Outline& start, const EdgeSearch& search,
                 const Lens& lens);
/// The same on the photo's own pixels.
EdgeFit fit_edge(const Grey& picture, const Outline& start, const EdgeSearch& search,
                 const Lens& lens);

}  // namespace chromeball::detecting
