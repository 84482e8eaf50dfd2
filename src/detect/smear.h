#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "detect/density.h"

namespace chromeball::detecting {

// What profiles show of the rim of a ball that moved evenly while the shutter was open; see
// motion.cpp for what that is taken to be. Lengths and places are in samples, places outwards from
// the profile's middle; costs are -2 log likelihoods less that of the best.

/// Of a profile along the motion, fine enough to show both ends of the smear. Half of the motion
/// is known but for a tenth.
class SmearVoice {
public:
    static constexpr double kReach = 8;  ///< samples: the rim must be so near to the middle
    static constexpr int kLengths = 3;
    static constexpr int kPlaces = 17;

    /// In between smoothly, or what is likeliest would always be one of the few that were tried.
    double cost(double half_motion, double place) const;
    /// The mean over places of the likelihood to a power, that of the best being 1: about 1 where
    /// the profile knows nothing, little where it knows the place.
    double openness(double half_motion, double power) const;
    double cost_still() const { return still_; }    ///< of nothing but a background
    double cost_moving() const { return moving_; }  ///< of a ball that fills the profile

private:
    friend std::vector<SmearVoice> smear_voices(const std::vector<ProfileOf<kManySamples>>&,
                                                double);
    int first_ = 0;
    std::array<float, static_cast<std::size_t>(kLengths) * kPlaces> costs_{};
    float still_ = 0, moving_ = 0;
};

/// Half of the motion that profiles should have, where the pixels are fine enough.
constexpr double kSmearSamples = 9;
std::vector<SmearVoice> smear_voices(const std::vector<ProfileOf<kManySamples>>& profiles,
                                     double half_motion);

/// Of a profile across the rim where that runs about along the motion: a rim but little smeared.
class BesideVoice {
public:
    static constexpr int kLengths = 8;
    static constexpr int kPlaces = 25;

    double cost(double half_motion, double place) const;
    double openness(double half_motion, double power) const;  ///< as SmearVoice's

private:
    friend std::vector<BesideVoice> beside_voices(const std::vector<Profile>&);
    std::array<float, static_cast<std::size_t>(kLengths) * kPlaces> costs_{};
};

std::vector<BesideVoice> beside_voices(const std::vector<Profile>& profiles);

}  // namespace chromeball::detecting
