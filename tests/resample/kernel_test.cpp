// The vector kernels against the scalar reference, with every kind of instructions that this
// machine has.
#include "resample/kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "resample/plan.h"
#include "resample/scalar.h"
#include "resample/simd.h"
#include "support/world.h"

namespace chromeball {
namespace {

const Layout& layout_named(std::string_view name) { return *find_layout(name); }

/// Calls work(name) with one kind of instructions after the other.
template <class Work>
void for_each_target(const Work& work) {
    for (const std::string& target : simd_targets()) {
        ASSERT_TRUE(use_simd_target(target));
        work(target);
    }
    use_simd_target("");
}

/// Balls as photos show them, one of them cut by the picture's edges, one through a bad lens.
std::vector<NamedBall> balls() {
    auto all = balls_in_photos();
    all.erase(all.begin());
    all.push_back({"cut by the frame", MirrorBall({60, 130, 120, 120, 0})});
    Camera camera = camera_for(8, 150, {320, 240});
    camera.distortion = {-0.2, 0.05, 0.01};
    all.push_back({"D = 8 behind a lens", MirrorBall(camera, cone_at(8, 12, 30))});
    return all;
}

/// Every pixel times a random number: what a wrong tap cannot guess.
Image grainy(Image image) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> factor(0.25F, 1.75F);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] *= factor(random);
    return image;
}

Source photographed(const NamedBall& named) {
    if (named.name == "cut by the frame")
        return ball_source(grainy(painted(named.ball, {200, 200}, Affine{}, smooth_world)),
                           named.ball, Affine{});
    BallPhoto photo(named.ball, smooth_world);
    photo.pixels = grainy(std::move(photo.pixels));
    return photo.source();
}

struct Difference {
    double mean = 0;
    double far_off = 0;  ///< part of the pixels that differ by more than 0.02
};

Difference difference(const Image& one, const Image& other) {
    Difference result;
    bool finite = true;
    for (int y = 0; y < one.height(); ++y)
        for (int x = 0; x < one.width(); ++x) {
            double most = 0;
            for (int c = 0; c < 4; ++c) {
                finite = finite && std::isfinite(one.pixel(x, y)[c]);
                most = std::max(most, std::abs(static_cast<double>(one.pixel(x, y)[c]) -
                                               static_cast<double>(other.pixel(x, y)[c])));
            }
            result.mean += most;
            result.far_off += most > 0.02;
        }
    EXPECT_TRUE(finite);
    result.mean /= static_cast<double>(one.size().pixels());
    result.far_off /= static_cast<double>(one.size().pixels());
    return result;
}

void expect_alike(const Source& source, const Layout& to, int size, const std::string& what) {
    ResampleOptions how;
    how.rotation = Rotation::yaw_pitch_roll(30, 20, 10);
    for (const Filter filter : {Filter::fast, Filter::adaptive}) {
        how.filter = filter;
        const Image expected = scalar::resample(source, to, size, how);
        for_each_target([&](const std::string& target) {
            const Difference d = difference(resample(source, to, size, how), expected);
            if (filter == Filter::fast) {
                // Positions of 150-pixel balls are off by 2e-5 pixels, whose steps are of size 1;
                // an edge may fall to the other side in a pixel or two.
                EXPECT_LT(d.mean, 5e-5) << what << to.name << " fast, " << target;
                EXPECT_LT(d.far_off, 2e-4) << what << to.name << " fast, " << target;
            } else {
                // Jacobians from neighbours give here and there a tap more or less; on a disk's
                // edge, where the exact Jacobian is infinite, always.
                const bool disk = to.directed_area() < 1;
                EXPECT_LT(d.mean, disk        ? 8e-3
                                  : size < 20 ? 4e-3
                                              : 1e-3)
                    << what << to.name << ", " << target;
                EXPECT_LT(d.far_off, disk ? 0.08 : 0.01) << what << to.name << ", " << target;
            }
        });
    }
}

TEST(Kernels, AreChosenByName) {
    const auto names = simd_targets();
    ASSERT_FALSE(names.empty());
    EXPECT_EQ(names.back(), "SCALAR");
    EXPECT_FALSE(use_simd_target("MMX"));
    EXPECT_TRUE(use_simd_target(names.back()));
    EXPECT_EQ(simd_targets(), names);
    EXPECT_TRUE(use_simd_target(""));
}

TEST(Kernels, DrawEveryBallAsTheReferenceDoes) {
    for (const NamedBall& named : balls()) {
        const Source source = photographed(named);
        for (const char* to : {"latlong", "cross-h", "angular", "mirror-ball"})
            expect_alike(source, layout_named(to), 48, named.name + " to ");
    }
}

TEST(Kernels, DrawMagnifiedAndReducedBallsAsTheReferenceDoes) {
    const Source source = photographed(balls()[5]);
    expect_alike(source, layout_named("faces"), 300, "magnified to ");
    expect_alike(source, layout_named("faces"), 9, "reduced to ");
    expect_alike(source, layout_named("latlong"), 301, "magnified to ");
}

TEST(Kernels, DrawEveryMapAsTheReferenceDoes) {
    for (const char* from : {"latlong", "cross-v", "faces-opengl", "angular", "mirror-ball"}) {
        const Layout& layout = layout_named(from);
        const Source source = map_source(grainy(painted_map(layout, 64, smooth_world)), layout);
        for (const char* to : {"latlong", "strip-h", "angular", "mirror-ball"})
            expect_alike(source, layout_named(to), 48, std::string(from) + " to ");
        expect_alike(source, layout_named("latlong"), 200, std::string(from) + " magnified to ");
    }
}

TEST(Kernels, LeaveOutPixelsThatMustNotBeUsed) {
    const MirrorBall ball(Outline{110, 110, 100, 100, 0});
    Image pixels = painted(ball, {220, 220}, Affine{}, smooth_world);
    for (int k = 0; k < 40; ++k)
        std::fill_n(pixels.pixel(40 + 31 * k % 140, 45 + 17 * k % 130), 4, 0.0F);
    const Source source = ball_source(pixels, ball, Affine{});
    for (const int size : {30, 300}) expect_alike(source, layout_named("latlong"), size, "holes ");
}

/// Where the pixels of six faces lie in the picture, tile by tile, but for those of directions
/// behind the ball.
std::vector<std::vector<std::optional<V2d>>> exact_positions(const Plan& plan,
                                                             const MirrorBall& ball,
                                                             const Affine& to_pixels,
                                                             const Rotation& rotation, int size) {
    std::vector<std::vector<std::optional<V2d>>> positions;
    for (const PlannedTile& planned : plan.tiles) {
        const kernel::Tile& tile = planned.tile;
        auto& of_tile = positions.emplace_back();
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x) {
                const V2d place((x + planned.cell_x + 0.5) / size,
                                (y + planned.cell_y + 0.5) / size / 6);
                const V3d d = rotation.inverse() * Cube().to_direction(place).value();
                // Along the rim, float directions are 1e-7 / sin(5 degrees) apart.
                const double least = std::max(radians(5), ball.hidden_half_angle() + radians(0.1));
                of_tile.emplace_back();
                if (angle_between(d, ball.axis()) >= least)
                    of_tile.back() = to_pixels(ball.to_position(d).value());
            }
    }
    return positions;
}

TEST(Kernels, PutEveryDirectionToAThousandthOfAPixel) {
    // Balls as large as photos are: float positions of a thousand pixels are 6e-5 apart.
    const V2d principal(3000, 2000);
    const auto near = [&](double distance, double off, double around) {
        return MirrorBall(camera_for(distance, 1000, principal), cone_at(distance, off, around));
    };
    Camera lens = camera_for(10, 1000, principal);
    lens.distortion = {-0.15, 0.02, 0};
    const NamedBall large[] = {{"distant", MirrorBall({1500.3, 1400.7, 1000, 1000, 0})},
                               {"distant ellipse", MirrorBall({1500.3, 1400.7, 1000, 800, 30})},
                               {"D = 1.2", near(1.2, 0, 0)},
                               {"D = 2 off the axis", near(2, 20, 130)},
                               {"D = 6 far off the axis", near(6, 40, -70)},
                               {"D = 20 off the axis", near(20, 10, 200)},
                               {"D = 300", near(300, 5, 45)},
                               {"behind a lens", MirrorBall(lens, cone_at(10, 12, 30))}};
    const Rotation rotation = Rotation::yaw_pitch_roll(30, 20, 10);
    const Layout& faces = layout_named("faces");
    constexpr int kSize = 256;
    for (const NamedBall& named : large) {
        const Outline& o = named.ball.outline();
        const Window window = needed_window(o, {-100000, -100000, {200000, 200000}});
        // Only positions count: the picture may be small.
        Source source = ball_source(Image({8, 8}, 3), named.ball, Affine{});
        source.to_pixels = shift(-window.x, -window.y);
        const Plan plan = plan_of(source, faces, kSize, {Filter::fast, rotation}).value();
        const auto exact = exact_positions(plan, named.ball, source.to_pixels, rotation, kSize);
        for_each_target([&](const std::string& target) {
            double worst = 0;
            std::size_t count = 0;
            for (std::size_t n = 0; n < plan.tiles.size(); ++n) {
                std::vector<float> x(exact[n].size()), y(x.size());
                kernel::locate(plan.job, plan.tiles[n].tile, x.data(), y.data());
                for (std::size_t i = 0; i < x.size(); ++i) {
                    if (!exact[n][i]) continue;
                    worst = std::max(worst, std::hypot(static_cast<double>(x[i]) - exact[n][i]->x,
                                                       static_cast<double>(y[i]) - exact[n][i]->y));
                    ++count;
                }
            }
            EXPECT_GT(count, 6U * kSize * kSize / 2);
            EXPECT_LT(worst, 1e-3) << named.name << ", " << target;
        });
    }
}

TEST(Kernels, NeverMakeLightThatIsNotThere) {
    // Suns on a dim ground, magnified: a cubic that overshoots would dip below the ground.
    const Layout& layout = layout_named("latlong");
    Image map(layout.picture(32), 3);
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x)
            std::fill_n(map.pixel(x, y), 3, (x * 7 + y * 5) % 11 == 0 ? 1e4F : 0.01F);
    const Source source = map_source(map, layout);
    for (const char* name : {"latlong", "openexr", "angular", "mirror-ball"})
        for_each_target([&](const std::string& target) {
            const Layout& to = layout_named(name);
            const Image out = resample(source, to, 100);
            float lowest = 1e9F, highest = 0;
            for (int y = 0; y < out.height(); ++y)
                for (int x = 0; x < out.width(); ++x) {
                    const float* p = out.pixel(x, y);
                    if (p[3] < 0.999F) continue;
                    lowest = std::min(lowest, p[0]);
                    highest = std::max(highest, p[0]);
                }
            // 1e-6: a rounding of the weights, of which four or sixteen make one
            EXPECT_GE(lowest, 0.01F * (1 - 1e-6F)) << to.name << target;
            EXPECT_LE(highest, 1e4F * (1 + 1e-6F)) << to.name << target;
        });
}

}  // namespace
}  // namespace chromeball
