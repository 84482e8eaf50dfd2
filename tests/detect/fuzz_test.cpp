#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "detect/detect.h"
#include "detect/random_picture.h"

namespace chromeball {
namespace {

/// A small picture of the given type with a ball in it, or only noise.
Photo small_picture(painted::Dice& dice) {
    const Size size{dice.whole(1, 120), dice.whole(1, 120)};
    const PixelType types[] = {PixelType::u8, PixelType::u16, PixelType::f16, PixelType::f32};
    Photo photo = painted::empty_photo(size, types[dice.whole(0, 3)], dice.whole(1, 4));
    const double x = dice.uniform(0, size.width), y = dice.uniform(0, size.height);
    const double r = dice.uniform(5, 60), wave = dice.uniform(0.1, 1);
    const std::size_t value = bytes_per_value(photo.type);
    const auto row = static_cast<std::size_t>(size.width * photo.channels) * value;
    for (std::size_t i = 0; i < photo.pixels.size(); ++i) {
        const double dx = static_cast<double>(i % row / value) / photo.channels - x;
        const double dy = static_cast<double>(i / row) - y;
        const double rho = std::hypot(dx, dy) / r;
        const double bend = rho < 1 ? std::tan(1.5 * rho) * std::sin(3 * std::atan2(dy, dx)) : rho;
        photo.pixels[i] = static_cast<std::byte>(std::lround(127 + 100 * std::sin(wave * bend)));
    }
    return photo;
}

/// Bytes set, copied, zeroed or filled as a broken file or a hostile one would.
void mutate(Photo& photo, painted::Dice& dice) {
    const auto size = static_cast<int>(photo.pixels.size());
    if (size == 0) return;
    for (int times = dice.whole(0, 12); times > 0; --times) {
        const int at = dice.whole(0, size - 1), length = dice.whole(1, size - at);
        const auto from = static_cast<std::size_t>(at), count = static_cast<std::size_t>(length);
        std::byte* p = photo.pixels.data() + from;
        switch (dice.whole(0, 4)) {
            case 0:
                *p = static_cast<std::byte>(dice.whole(0, 255));
                break;
            case 1:
                std::memset(p, dice.whole(0, 255), count);
                break;
            case 2:
                std::memmove(photo.pixels.data(), p, count);
                break;
            case 3:
                for (std::size_t i = 0; i < count; i += 37)
                    p[i] = static_cast<std::byte>(dice.whole(0, 255));
                break;
            default:
                std::memset(p, 0xff, count);  // floats: not a number
        }
    }
    if (dice.chance(0.2)) photo.window.x = dice.whole(-100000, 100000);
    if (dice.chance(0.2)) photo.display = {dice.whole(0, 5000), dice.whole(0, 5000)};
}

DetectOptions random_options(painted::Dice& dice) {
    DetectOptions options;
    if (dice.chance(0.2))
        options.camera =
            Camera{dice.log_uniform(0.01, 1e7), {dice.uniform(-1e4, 1e4), dice.uniform(-1e4, 1e4)}};
    if (dice.chance(0.1)) options.near = V2d(dice.uniform(-50, 200), dice.uniform(-50, 200));
    if (dice.chance(0.1)) options.radius_range = {{dice.uniform(-5, 50), dice.uniform(0, 100)}};
    return options;
}

int number_from(const char* variable, int usual) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : usual;
}

/// Seconds of processor time, which unlike those on the wall do not count what else runs.
double spent() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// CHROMEBALL_DETECT_FUZZ=20000 tries so many instead of a few hundred, CHROMEBALL_DETECT_FUZZ_FIRST
// is the number of the first: long runs can be split.
TEST(Fuzz, MutatedPicturesNeitherCrashNorHangNorGiveNonsense) {
    const int first = number_from("CHROMEBALL_DETECT_FUZZ_FIRST", 0);
    const int last = first + number_from("CHROMEBALL_DETECT_FUZZ", 300);
    double longest = 0;
    int slowest = first;
    for (int i = first; i < last; ++i) {
        painted::Dice dice(static_cast<unsigned>(i));
        Photo photo = small_picture(dice);
        mutate(photo, dice);
        const auto options = random_options(dice);
        const double start = spent();
        for (const Candidate& ball : find_balls(photo, options)) {
            EXPECT_TRUE(std::isfinite(ball.outline.cx + ball.outline.cy)) << "picture " << i;
            EXPECT_GE(ball.outline.a, ball.outline.b) << "picture " << i;
            EXPECT_GT(ball.outline.b, 0) << "picture " << i;
            EXPECT_TRUE(ball.confidence >= 0 && ball.confidence <= 1) << "picture " << i;
            EXPECT_TRUE(ball.deviation.cx >= 0 && ball.deviation.a >= 0) << "picture " << i;
        }
        const double took = spent() - start;
        EXPECT_LT(took, 5) << "picture " << i;
        if (took > longest) longest = took, slowest = i;
    }
    std::printf("pictures %d to %d: the slowest, %d, took %.2f s of processor time\n", first,
                last - 1, slowest, longest);
}

}  // namespace
}  // namespace chromeball
