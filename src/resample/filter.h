#pragma once

// The adaptive filter in numbers, for the scalar reference and the vector kernels alike. Lengths
// are in source pixels.

namespace chromeball::filter {

/// A footprint shorter than that is of a magnified source: one cubic tap. The source's pixels have
/// blurred it more than the output's own area does.
constexpr double kMagnified = 0.7;

/// How far from its position a cubic tap looks: two pixels, and a bit.
constexpr double kCubicReach = 2.01;

/// Sub-samples along one side of an output pixel: so many for each pixel of its footprint, and at
/// least and at most so many in all.
constexpr double kTapsPerPixel = 1.5;
constexpr int kLeastTaps = 2, kMostTaps = 64;
/// And where the source does not show the pixel's middle, but perhaps a part of it.
constexpr int kUnknownTaps = 4;

/// Where mappings are said to bend strongly, taps are still taken along straight lines if a step of
/// the output bends by less than that: by an eighth of it within the pixel.
constexpr double kNearlyStraight = 0.1;

/// A mean of a ball's pixels whose weight is no more than that has pixels among it that must not be
/// used; less than 1, since weights are sums of floats.
constexpr float kPure = 0.9999F;

}  // namespace chromeball::filter
