#include "detect/smear.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "detect/dice.h"

namespace chromeball::detecting {
namespace {

using Fine = ProfileOf<kManySamples>;
constexpr int kMiddle = static_cast<int>(kManySamples) / 2;

/// What lines along the motion show across the rim, samples outwards of the middle, of a ball of
/// patches that moved by twice `half_motion` before an even background. With `instants` each sample
/// saw but so many, random ones, as in rendered pictures.
std::vector<Fine> painted_rims(double rim, double half_motion, int count, int instants = 0) {
    painted::Dice dice(7), grain(8);
    std::vector<Fine> profiles;
    for (int i = 0; i < count; ++i) {
        const int times = instants > 0 ? instants : 64;
        std::vector<double> patches;
        for (int k = 0; k < 200; ++k)
            patches.push_back(k > 0 && dice.chance(0.6) ? patches.back() : dice.uniform(0, 1));
        const double background = dice.uniform(0.2, 0.8);
        Fine profile{};
        for (int k = 0; k < static_cast<int>(kManySamples); ++k) {
            double sum = 0;
            for (int t = 0; t < times; ++t) {
                const double part = instants > 0 ? grain.uniform(0, 1) : (t + 0.5) / times;
                const double time = (2 * part - 1) * half_motion;
                const double depth = rim + time - (k - kMiddle);
                sum += depth < 0 ? background : patches[static_cast<std::size_t>(depth)];
            }
            profile[static_cast<std::size_t>(k)] =
                static_cast<float>(sum / times + 0.003 * dice.normal());
        }
        EXPECT_TRUE(normalise(profile));
        profiles.push_back(profile);
    }
    return profiles;
}

double cost_at(const std::vector<SmearVoice>& voices, double half_motion, double place) {
    double sum = 0;
    for (const SmearVoice& v : voices) sum += v.cost(half_motion, place);
    return sum;
}

TEST(Smear, TheRimIsLikeliestWhereItWasInTheMiddleOfTheExposure) {
    for (const double rim : {-4.0, -0.6, 2.3}) {
        const auto voices = smear_voices(painted_rims(rim, 9, 32), 9);
        double best = -8;
        for (double place = -8; place <= 8; place += 0.1)
            if (cost_at(voices, 9, place) < cost_at(voices, 9, best)) best = place;
        EXPECT_NEAR(best, rim, 0.5) << rim;  // a twentieth of the smear
    }
}

TEST(Smear, AGrainyBallHasItsRimWhereGrainBegins) {
    for (const double rim : {-3.0, 0.4, 2.3}) {
        const auto voices = smear_voices(painted_rims(rim, 9, 32, 8), 9);
        double best = -8;
        for (double place = -8; place <= 8; place += 0.1)
            if (cost_at(voices, 9, place) < cost_at(voices, 9, best)) best = place;
        EXPECT_NEAR(best, rim, 1) << rim;
    }
}

TEST(Smear, AProfileThatShowsNoRimIsOpen) {
    double rims = 0, flat = 0;
    constexpr double kPower = 0.3;
    for (const SmearVoice& v : smear_voices(painted_rims(0, 9, 32), 9))
        rims += v.openness(9, kPower) / 32;
    for (const SmearVoice& v : smear_voices(painted_rims(-80, 9, 32), 9))  // background alone
        flat += v.openness(9, kPower) / 32;
    EXPECT_LT(rims, 0.35);
    EXPECT_GT(flat, 2 * rims);
    EXPECT_LE(flat, 1.001);
}

TEST(Smear, TheLengthOfTheMotionIsLikeliest) {
    const auto voices = smear_voices(painted_rims(0.4, 9.2, 32), 9);
    EXPECT_LT(cost_at(voices, 9.2, 0.4), cost_at(voices, 8.5, 0.4));
    EXPECT_LT(cost_at(voices, 9.2, 0.4), cost_at(voices, 9.8, 0.4));
}

TEST(Smear, ARimIsLikelierThanNoneAndTwoOfAKindAreToldApart) {
    double still = 0, moving = 0;
    const auto rims = smear_voices(painted_rims(0, 9, 32), 9);
    for (const SmearVoice& v : rims) still += v.cost_still() - v.cost(9, 0);
    EXPECT_GT(still, 1.5 * 32);
    // Rims far outside: the ball fills the profiles.
    for (const SmearVoice& v : smear_voices(painted_rims(60, 9, 32), 9))
        moving += v.cost(9, 0) - v.cost_moving();
    EXPECT_GT(moving, 0);
}

TEST(Smear, AFewStrongEdgesDoNotDecideWhereTheRimIs) {
    auto profiles = painted_rims(1.5, 9, 32);
    for (std::size_t i = 0; i < profiles.size(); i += 3) {  // lamps, far brighter than all else
        Fine& profile = profiles[i];
        for (int k = 0; k < static_cast<int>(kManySamples); ++k) {
            const double depth = 1.5 - (k - kMiddle) - 6 - 0.6 * static_cast<double>(i);
            const double part =
                std::clamp((depth + 9) / 18, 0.0, 1.0) - std::clamp((depth - 4 + 9) / 18, 0.0, 1.0);
            profile[static_cast<std::size_t>(k)] += static_cast<float>(5 * part);
        }
        ASSERT_TRUE(normalise(profile));
    }
    const auto voices = smear_voices(profiles, 9);
    double best = -8;
    for (double place = -8; place <= 8; place += 0.1)
        if (cost_at(voices, 9, place) < cost_at(voices, 9, best)) best = place;
    EXPECT_NEAR(best, 1.5, 1);
}

}  // namespace
}  // namespace chromeball::detecting
