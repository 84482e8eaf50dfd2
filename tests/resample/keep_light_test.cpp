// Single pixels that outshine the rest keep their light to the last digits, wherever they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "core/parallel.h"
#include "resample/resample.h"
#include "support/world.h"

namespace chromeball {
namespace {

/// Five hundred directions all over the sphere, seams, poles and corners included, in groups whose
/// members are so far apart that what is shown near one of them is its light.
std::vector<std::vector<V3d>> groups_of_directions() {
    std::vector<V3d> all = directions_on_sphere(474);
    for (const V3d& d : cube_directions()) all.push_back(d.normalized());
    std::vector<std::vector<V3d>> groups;
    for (const V3d& d : all) {
        const auto far_off = [&](const std::vector<V3d>& group) {
            return std::all_of(group.begin(), group.end(), [&](const V3d& other) {
                return angle_between(d, other) > radians(45);
            });
        };
        const auto group = std::find_if(groups.begin(), groups.end(), far_off);
        if (group == groups.end())
            groups.push_back({d});
        else
            group->push_back(d);
    }
    return groups;
}

/// Steradians of a pixel, from the directions of its parts' corners alone: two triangles each.
template <class P>
double solid_angle_by_corners(const P& projection, const Affine& from_pixels, int x, int y,
                              int parts = 8) {
    double sum = 0;
    for (int k = 0; k < parts * parts; ++k) {
        const auto at = [&](double dx, double dy) {
            return projection.to_direction(
                from_pixels(V2d(x + (k % parts + dx) / parts, y + (k / parts + dy) / parts)));
        };
        const double in = 1e-7;  // a cell's right side belongs to the next one
        const auto a = at(in, in), b = at(1 - in, in), c = at(in, 1 - in), d = at(1 - in, 1 - in);
        if (!a || !b || !c || !d) continue;
        sum += 0.5 * ((*b - *a).cross(*c - *a).length() + (*b - *d).cross(*c - *d).length());
    }
    return sum;
}

/// A picture that light is taken from.
struct Scene {
    std::string name;
    Size size;
    std::function<std::optional<V2d>(V3d)> position;  ///< nothing where pixels are not told apart
    std::function<double(int x, int y)> solid_angle;
    std::function<Source(const Image&)> source;
};

Scene scene_of(const NamedBall& named, Size size) {
    const MirrorBall ball = named.ball;
    // What the rim shows is drawn from several pixels, up to 5.5 deep.
    const auto position = [ball](V3d d) -> std::optional<V2d> {
        const auto p = ball.to_position(d);
        const Outline& o = ball.outline();
        constexpr double kRim = 6.5;  // and half a diagonal
        if (!p || std::hypot(p->x - o.cx, p->y - o.cy) > o.b - kRim) return std::nullopt;
        return p;
    };
    return {named.name, size, position,
            [ball](int x, int y) { return solid_angle_by_corners(ball, Affine{}, x, y); },
            [ball](const Image& image) { return ball_source(image, ball, Affine{}); }};
}

Scene scene_of(const Layout& layout, int size) {
    const Size picture = layout.picture(size);
    const auto position = [picture, &layout](V3d d) -> std::optional<V2d> {
        const auto p =
            std::visit([&](const auto& m) { return m.to_position(d); }, layout.projection);
        const V2d at(p->x * picture.width, p->y * picture.height);
        // What an angular map's edge shows is drawn from pixels up to four deep.
        const double half = 0.5 * picture.width;
        if (std::holds_alternative<Angular>(layout.projection) &&
            std::hypot(at.x - half, at.y - half) > half - 5)
            return std::nullopt;
        return at;
    };
    const auto solid_angle = [picture, &layout](int x, int y) {
        const Affine from_pixels = scale(1.0 / picture.width, 1.0 / picture.height);
        return std::visit(
            [&](const auto& m) { return solid_angle_by_corners(m, from_pixels, x, y); },
            layout.projection);
    };
    return {std::string(layout.name), picture, position, solid_angle,
            [&layout](const Image& image) { return map_source(image, layout); }};
}

/// Of so many times 60 pixels or so around.
std::vector<Scene> scenes(int scale) {
    const double r = 60 * scale;
    const Size photo{125 * scale, 125 * scale};
    return {
        scene_of({"distant ball", MirrorBall({r + 2.3, r + 1.7, r, r, 0})}, photo),
        scene_of({"near ball", MirrorBall(camera_for(6, r, {r + 2, r + 2}), cone_at(6))}, photo),
        scene_of(*find_layout("latlong"), 64 * scale),
        scene_of(*find_layout("cross-h"), 32 * scale),
        scene_of(*find_layout("angular"), 90 * scale)};
}

Image evenly(Size size, float value) {
    Image image(size, 3);
    std::fill_n(image.row(0), 3 * size.pixels(), value);
    return image;
}

/// The size of a map whose pixels are `times` as wide as a source's in the mean.
int size_for(const Layout& to, const Source& source, double times) {
    return static_cast<int>(std::lround(
        std::sqrt(4 * std::numbers::pi / (to.directed_area() * source.mean_solid_angle)) / times));
}

/// Pixels' directions and steradians.
struct Pixels {
    std::vector<V3d> directions;
    std::vector<double> steradians;
};
Pixels pixels_of(const Layout& layout, Size size) {
    const Affine from_pixels = scale(1.0 / size.width, 1.0 / size.height);
    // Flat parts of 1.5 degrees are 2e-4 smaller than what they stand for.
    const double across = std::sqrt(4 * std::numbers::pi / static_cast<double>(size.pixels()));
    const int parts = static_cast<int>(std::ceil(across / radians(1.5)));
    Pixels pixels;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const V2d middle = from_pixels(V2d(x + 0.5, y + 0.5));
            std::visit(
                [&](const auto& m) {
                    pixels.directions.push_back(m.to_direction(middle).value());
                    pixels.steradians.push_back(
                        solid_angle_by_corners(m, from_pixels, x, y, parts));
                },
                layout.projection);
        }
    return pixels;
}

/// Lamps of as much light each, a group in every channel.
struct Lamps {
    static constexpr double kLight = 1e-3;
    Image picture;
    std::vector<V3d> at[3];

    Lamps(const Scene& scene, const std::vector<std::vector<V3d>>& groups, std::size_t first,
          float ground)
        : picture(evenly(scene.size, ground)) {
        for (std::size_t c = 0; c < 3 && first + c < groups.size(); ++c)
            for (const V3d& d : groups[first + c]) {
                const auto p = scene.position(d);
                if (!p) continue;
                const int x = std::min(static_cast<int>(p->x), scene.size.width - 1),
                          y = std::min(static_cast<int>(p->y), scene.size.height - 1);
                picture.pixel(x, y)[c] += static_cast<float>(kLight / scene.solid_angle(x, y));
                at[c].push_back(d);
            }
    }
};

/// How far off the light around each lamp is, at most. ground: of the picture, as a part of a lamp
/// of mean size.
void expect_light_kept(const Scene& scene, const Layout& to, double times, double ground) {
    const auto groups = groups_of_directions();
    const double mean = Lamps::kLight / scene.source(evenly(scene.size, 0)).mean_solid_angle;
    const auto level = static_cast<float>(ground * mean);
    const Source dark = scene.source(evenly(scene.size, level));
    const int size = size_for(to, dark, times);
    const Image before = resample(dark, to, size);
    const Pixels pixels = pixels_of(to, before.size());
    double worst = 0;
    std::size_t count = 0;
    for (std::size_t first = 0; first < groups.size(); first += 3) {
        const Lamps lamps(scene, groups, first, level);
        const Image after = resample(scene.source(lamps.picture), to, size);
        for (std::size_t c = 0; c < 3; ++c) {
            std::vector<double> light(lamps.at[c].size());
            for (std::size_t i = 0; i < pixels.steradians.size(); ++i) {
                const double more = static_cast<double>(after.row(0)[4 * i + c]) -
                                    static_cast<double>(before.row(0)[4 * i + c]);
                if (std::abs(more) < 1e-6 * mean || light.empty()) continue;
                const auto nearer = [&](V3d a, V3d b) {
                    return a.dot(pixels.directions[i]) < b.dot(pixels.directions[i]);
                };
                const auto nearest =
                    std::max_element(lamps.at[c].begin(), lamps.at[c].end(), nearer);
                light[static_cast<std::size_t>(nearest - lamps.at[c].begin())] +=
                    more * pixels.steradians[i];
            }
            for (const double l : light) worst = std::max(worst, std::abs(l / Lamps::kLight - 1));
            count += light.size();
        }
    }
    EXPECT_GT(count, 350U) << scene.name;
    EXPECT_LT(worst, 1e-3) << scene.name << " to " << to.name << ", pixels " << times
                           << " times as wide";
}

TEST(KeptLight, IsThatOfEveryBrightPixelToATenthOfAPercent) {
    for (const double times : {0.8, 1.5, 2.0, 4.0, 8.0})
        // So that lamps stay several pixels of the map apart.
        for (const Scene& scene : scenes(times < 4 ? 1 : 2))
            for (const char* to : {"latlong", "openexr"})
                expect_light_kept(scene, *find_layout(to), times, times == 1.5 ? 0 : 0.01);
}

double red_light(const Image& map, const Layout& layout) {
    const Pixels pixels = pixels_of(layout, map.size());
    double sum = 0;
    for (std::size_t i = 0; i < pixels.steradians.size(); ++i)
        sum += static_cast<double>(map.row(0)[4 * i]) * pixels.steradians[i];
    return sum;
}

TEST(KeptLight, IsThatOfASunOfSeveralPixels) {
    // Of uneven ones, too, and so large that they are taken in parts.
    for (const Scene& scene : scenes(1))
        for (const int across : {2, 3, 5, 20}) {
            Image picture = evenly(scene.size, 0);
            double light = 0;
            // Of a cross the middle of a cell.
            const int x0 = scene.size.width * 3 / 8 - across / 2,
                      y0 = scene.size.height / 2 - across / 2;
            for (int y = y0; y < y0 + across; ++y)
                for (int x = x0; x < x0 + across; ++x) {
                    const float value = 1 + 0.5F * static_cast<float>((x * 7 + y * 5) % 3);
                    picture.pixel(x, y)[0] = value;
                    light += static_cast<double>(value) * scene.solid_angle(x, y);
                }
            const Layout& to = *find_layout("openexr");
            const Source source = scene.source(picture);
            const Image map = resample(source, to, size_for(to, source, 2));
            EXPECT_NEAR(red_light(map, to) / light, 1, 1e-3) << scene.name << " " << across;
        }
}

/// A map of suns on a ground, in all channels.
Image suns(const Layout& layout, int size, float ground) {
    Image map = evenly(layout.picture(size), ground);
    for (int k = 0; k < 40; ++k)
        std::fill_n(map.pixel((k * 37) % map.width(), (k * 23) % map.height()), 3, 50.0F);
    return map;
}

bool same_bytes(const Image& one, const Image& other) {
    return one.size() == other.size() &&
           std::memcmp(one.row(0), other.row(0), 16 * one.size().pixels()) == 0;
}

ResampleOptions as_filtered() {
    ResampleOptions how;
    how.keeps_light = false;
    return how;
}

TEST(KeptLight, LeavesPicturesAloneInWhichNothingOutshinesTheRest) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> factor(0.1F, 3);
    for (const Scene& scene : scenes(1)) {
        Image picture(scene.size, 3);
        for (std::size_t i = 0; i < 3 * picture.size().pixels(); ++i)
            picture.row(0)[i] = factor(random);
        const Source source = scene.source(picture);
        for (const char* to : {"latlong", "openexr"}) {
            const Layout& layout = *find_layout(to);
            EXPECT_TRUE(same_bytes(resample(source, layout, 30),
                                   resample(source, layout, 30, as_filtered())))
                << scene.name;
        }
    }
}

TEST(KeptLight, ConcernsTheAdaptiveFilterOnly) {
    const Layout& layout = *find_layout("latlong");
    const Source source = map_source(suns(layout, 64, 0.01F), layout);
    EXPECT_FALSE(
        same_bytes(resample(source, layout, 30), resample(source, layout, 30, as_filtered())));
    ResampleOptions fast;
    fast.filter = Filter::fast;
    const Image with = resample(source, layout, 30, fast);
    fast.keeps_light = false;
    EXPECT_TRUE(same_bytes(with, resample(source, layout, 30, fast)));
}

TEST(KeptLight, IsTheSameForAnyNumberOfThreads) {
    const Layout& layout = *find_layout("cross-h");
    const Image map = suns(layout, 32, 0.01F);
    const auto drawn = [&](int threads) {
        const ThreadLimit limit(threads);
        return resample(map_source(map, layout), *find_layout("latlong"), 40);
    };
    const Image one = drawn(1);
    for (int k = 0; k < 5; ++k) EXPECT_TRUE(same_bytes(drawn(4), one));
}

TEST(KeptLight, LeavesAlphaAsItIs) {
    // Near, so that some is hidden, and cut by the photo's edge.
    const MirrorBall ball(camera_for(3, 60, {50, 62}), cone_at(3));
    Image photo = evenly({125, 125}, 0.01F);
    for (int k = 0; k < 60; ++k) std::fill_n(photo.pixel((k * 37) % 125, (k * 23) % 125), 3, 80.0F);
    const Source source = ball_source(photo, ball, Affine{});
    const Layout& layout = *find_layout("latlong");
    const Image with = resample(source, layout, 30),
                without = resample(source, layout, 30, as_filtered());
    EXPECT_FALSE(same_bytes(with, without));
    for (int y = 0; y < with.height(); ++y)
        for (int x = 0; x < with.width(); ++x) {
            EXPECT_EQ(with.pixel(x, y)[3], without.pixel(x, y)[3]);
            EXPECT_GE(with.pixel(x, y)[0], 0);
            if (with.pixel(x, y)[3] == 0) {
                EXPECT_EQ(with.pixel(x, y)[0], 0);
            }
        }
}

TEST(KeptLight, DoesNotMindPixelsThatAreNoNumbers) {
    const Layout& layout = *find_layout("latlong");
    Image map = evenly(layout.picture(64), 0.01F);
    map.pixel(30, 30)[0] = 50;
    const Image expected = resample(map_source(map, layout), layout, 32);
    for (const float odd : {std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN(), -1e30F}) {
        std::fill_n(map.pixel(100, 20), 3, odd);
        const Image found = resample(map_source(map, layout), layout, 32);
        for (int y = 10; y < 20; ++y)
            for (int x = 10; x < 20; ++x)
                EXPECT_FLOAT_EQ(found.pixel(x, y)[0], expected.pixel(x, y)[0]) << odd;
    }
}

}  // namespace
}  // namespace chromeball
