#pragma once

#include <vector>

namespace chromeball {

/// One quantity seen at some of the times 0 ... count - 1, each at most once, ascending.
struct Samples {
    int count = 0;
    std::vector<int> at;
    std::vector<double> value;
    std::vector<double> deviation;  ///< standard deviation of each value as its maker thinks; > 0
    std::vector<double> weight;     ///< 0 to 1: how far each is trusted at all
    /// Which are told, not seen: they count as much as a typical one, and say nothing of how stiff
    /// the curve is. Empty: none.
    std::vector<bool> told = {};
};

struct Smoothed {
    std::vector<double> value;  ///< at all times
    double noise = 1;           ///< how many times larger the deviations really are
};

/// How stiff the curve is.
struct Stiffness {
    /// Differences of this order are kept small: 1 towards constant, 2 straight, 3 of constant
    /// acceleration, 4 of acceleration that changes evenly. Less where there are fewer samples.
    int order = 4;
    /// Variance of the differences over that of a typical sample; 0: chosen from the data.
    double variance_ratio = 0;
};

/// The likeliest curve through noisy samples, where differences of the given order are Gaussian:
/// penalised least squares, solved as a banded system in time linear in `count`.
///
/// The stiffness is the one with the greatest marginal likelihood (the curve integrated out), so
/// that a shake that lasts is followed and what looks like noise of the samples' own size is not.
/// The noise's scale is found along with it, from half to four times what its maker thinks, for
/// white shake and white noise cannot be told apart but by their size.
///
/// Whittaker: On a new method of graduation, 1923; Wahba: A comparison of GCV and GML for choosing
/// the smoothing parameter, 1985.
Smoothed smooth(const Samples& samples, const Stiffness& stiffness);

}  // namespace chromeball
