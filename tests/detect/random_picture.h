#pragma once

#include <optional>
#include <string>

#include "detect/painted.h"

namespace chromeball::painted {

/// Numbers that are the same on every machine, unlike the standard library's distributions.
class Dice {
public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
    }
    double log_uniform(double low, double high) {
        return std::exp(uniform(std::log(low), std::log(high)));
    }
    bool chance(double part) { return uniform(0, 1) < part; }
    int whole(int low, int high) { return static_cast<int>(std::floor(uniform(low, high + 1.0))); }
    /// Nearly normal; fast, for there are many.
    double normal() {
        const auto bits = engine_();
        const auto part = [&](int shift) { return static_cast<double>(bits >> shift & 255) / 255; };
        return 1.73 * (part(0) + part(8) + part(16) + part(24) - 2);
    }
    V3d color(double spread) {
        const double level = log_uniform(0.02, 1);
        return V3d(uniform(1 - spread, 1), uniform(1 - spread, 1), uniform(1 - spread, 1)) * level;
    }

private:
    std::mt19937 engine_;
};

/// A random world as a table of directions: sky and ground, clouds, houses or furniture, lamps.
class World {
public:
    explicit World(Dice& dice) {
        const V3d above = dice.color(0.5), below = dice.color(0.4);
        const double frequency = dice.log_uniform(1.5, 12), rough = dice.uniform(0.1, 0.9);
        const V3d shift(dice.uniform(0, 99), dice.uniform(0, 99), dice.uniform(0, 99));
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const V3d d = direction(x + 0.5, y + 0.5);
                const double noise = 0.5 * value_noise(d * frequency + shift) +
                                     0.3 * value_noise(d * (4.3 * frequency) + shift) +
                                     0.2 * hash(x, y, 3);
                at(x, y) = (d.y > 0 ? above : below) * (1 - rough + 2 * rough * noise);
            }
        const int boxes = dice.whole(25, 220);
        for (int i = 0; i < boxes; ++i) paint_box(dice);
        const int lamps = dice.whole(0, 6);
        for (int i = 0; i < lamps; ++i) {
            const int x = dice.whole(0, kWidth - 1), y = dice.whole(20, kHeight / 2);
            const int size = dice.whole(1, 9);
            const double bright = dice.log_uniform(1.5, 40);
            for (int v = -size; v <= size; ++v)
                for (int u = -size; u <= size; ++u)
                    if (u * u + v * v <= size * size) at(x + u, y + v) = V3d(bright);
        }
        average();
    }

    V3d seen(V3d d) const { return at(column(d), row(d)); }
    /// As a rough surface shows it: averaged over tens of degrees.
    V3d blurred(V3d d) const {
        const double v = 0.5 - std::asin(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi;
        const double turn = std::atan2(d.x, d.z) / (2 * std::numbers::pi);
        constexpr int across = kWidth / kCell, down = kHeight / kCell;
        const double fx = (turn - std::floor(turn)) * across - 0.5, fy = v * down - 0.5;
        const double x = std::floor(fx), y = std::floor(fy);
        const auto cell = [&](double i, double j) {
            const int column = (static_cast<int>(i) + across) % across;
            const int line = std::clamp(static_cast<int>(j), 0, down - 1);
            return coarse_[static_cast<std::size_t>(line * across + column)];
        };
        const auto mix = [](V3d one, V3d other, double part) {
            const double t = part * part * (3 - 2 * part);
            return one * (1 - t) + other * t;
        };
        return mix(mix(cell(x, y), cell(x + 1, y), fx - x),
                   mix(cell(x, y + 1), cell(x + 1, y + 1), fx - x), fy - y);
    }

private:
    static constexpr int kWidth = 576, kHeight = 288, kCell = 32;

    static V3d direction(double x, double y) {
        const double lon = 2 * std::numbers::pi * x / kWidth;
        const double lat = std::numbers::pi * (0.5 - y / kHeight);
        return {std::cos(lat) * std::sin(lon), std::sin(lat), std::cos(lat) * std::cos(lon)};
    }
    static int column(V3d d) {
        const double turn = std::atan2(d.x, d.z) / (2 * std::numbers::pi);
        return static_cast<int>((turn - std::floor(turn)) * kWidth) % kWidth;
    }
    static int row(V3d d) {
        const double v = 0.5 - std::asin(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi;
        return std::clamp(static_cast<int>(v * kHeight), 0, kHeight - 1);
    }
    V3d& at(int x, int y) {
        return texels_[static_cast<std::size_t>(std::clamp(y, 0, kHeight - 1) * kWidth +
                                                (x % kWidth + kWidth) % kWidth)];
    }
    const V3d& at(int x, int y) const { return const_cast<World*>(this)->at(x, y); }

    void paint_box(Dice& dice) {
        const int x = dice.whole(0, kWidth - 1), y = dice.whole(kHeight / 5, 4 * kHeight / 5);
        const int w = dice.whole(3, 60), h = dice.whole(3, 60);
        const V3d wall = dice.color(0.5), window = dice.color(0.5);
        const int pitch = dice.whole(3, 20);
        const bool windows = dice.chance(0.6);
        for (int v = 0; v < h; ++v)
            for (int u = 0; u < w; ++u)
                at(x + u, y + v) =
                    windows && u % pitch > pitch / 3 && v % pitch > pitch / 2 ? window : wall;
    }

    void average() {
        constexpr int across = kWidth / kCell, down = kHeight / kCell;
        std::vector<V3d> cells;
        for (int y = 0; y < down; ++y)
            for (int x = 0; x < across; ++x) {
                V3d sum(0);
                for (int v = 0; v < kCell; ++v)
                    for (int u = 0; u < kCell; ++u) sum += at(x * kCell + u, y * kCell + v);
                cells.push_back(sum / (kCell * kCell));
            }
        coarse_ = cells;
    }

    std::vector<V3d> texels_ = std::vector<V3d>(static_cast<std::size_t>(kWidth) * kHeight);
    std::vector<V3d> coarse_;
};

/// A picture and what is in it.
struct RandomPicture {
    Photo photo;
    std::optional<Outline> ball;  ///< none: what is there is no mirror ball
    std::string kind;
};

/// Things drawn in the picture, behind the ball or before it.
struct Shape2d {
    double x, y, rx, ry, turn;
    bool round;
    V3d color, other;
    double stripes;  ///< pixels; 0: none

    bool holds(double px, double py) const {
        const double c = std::cos(turn), s = std::sin(turn);
        const double u = (c * (px - x) + s * (py - y)) / rx, v = (c * (py - y) - s * (px - x)) / ry;
        return round ? u * u + v * v < 1 : std::abs(u) < 1 && std::abs(v) < 1;
    }
    V3d shade(double px, double py) const {
        if (stripes == 0) return color * (1 + 0.3 * (px - x + py - y) / (rx + ry));
        const double u = std::floor(px / stripes) + std::floor(py / stripes);
        return std::fmod(std::abs(u), 2.0) < 1 ? color : other;
    }
};

/// A picture like those that people take, from a number. Two of three hold a mirror ball; the
/// others other round things, or none.
inline RandomPicture random_picture(unsigned seed) {
    Dice dice(seed);
    const World world(dice);
    RandomPicture made;
    Scene scene;
    const bool portrait = dice.chance(0.2);
    const int longest = dice.whole(280, 520), shortest = longest * dice.whole(55, 100) / 100;
    scene.size = portrait ? Size{shortest, longest} : Size{longest, shortest};
    const auto [w, h] = scene.size;
    scene.camera = {dice.log_uniform(0.8, 3.5) * longest, {0.5 * w, 0.5 * h}};
    const double f = *scene.camera.focal, radius = dice.log_uniform(18, 0.46 * shortest);
    const double distance = f / radius;
    const double cut = dice.chance(0.15) ? 0.4 : -0.9;  // of the radius, beyond the frame
    const double x = dice.uniform(-cut * radius, w + cut * radius);
    const double y = dice.uniform(-cut * radius, h + cut * radius);
    scene.centre = V3d((x - 0.5 * w) / f, (0.5 * h - y) / f, -1) * distance;
    const Outline rim = scene.outline();

    const char* kinds[] = {"mirror", "mirror", "mirror", "mirror", "mirror",  "mirror", "mirror",
                           "mirror", "matte",  "rough",  "glossy", "painted", "disc",   "ring"};
    made.kind = kinds[dice.whole(0, 13)];
    const V3d paint = dice.color(0.7), paint2 = dice.color(0.7);
    const V3d sun = V3d(dice.uniform(-1, 1), dice.uniform(0, 1), dice.uniform(0, 1)).normalized();
    const double mirrors = dice.uniform(0.5, 1), pitch = dice.uniform(2, 7);
    const int cells = dice.whole(2, 7);

    std::vector<Shape2d> behind, before;
    const auto shape = [&](double px, double py, double size) {
        return Shape2d{px,
                       py,
                       size * dice.uniform(0.2, 1),
                       size * dice.uniform(0.2, 1),
                       dice.uniform(0, 3),
                       dice.chance(0.4),
                       dice.color(0.6),
                       dice.color(0.6),
                       dice.chance(0.3) ? dice.uniform(3, 20) : 0};
    };
    for (int i = dice.chance(0.35) ? dice.whole(1, 8) : 0; i > 0; --i)
        behind.push_back(shape(dice.uniform(0, w), dice.uniform(0, h), dice.uniform(10, 150)));
    if (dice.chance(0.5)) {  // a stand
        const double half = rim.b * dice.uniform(0.05, 0.6), low = dice.uniform(0.75, 0.98) * rim.b;
        const double height = dice.uniform(0.2, 2) * rim.b;
        before.push_back(
            {rim.cx, rim.cy + low + height, half, height, 0, false, dice.color(0.2), V3d(0), 0});
    }
    if (dice.chance(0.12)) {  // a pole, or a hand
        const double turn = dice.uniform(0, 6.28), off = dice.uniform(0.3, 1) * rim.b;
        Shape2d thing = shape(rim.cx + off * std::cos(turn), rim.cy + off * std::sin(turn), rim.b);
        thing.rx = rim.b * dice.uniform(0.1, 0.3);
        thing.ry = rim.b * dice.uniform(0.3, 4);
        before.push_back(thing);
    }
    const double motion = dice.chance(0.12) ? dice.uniform(0.03, 0.25) * rim.b : 0;
    const double heading = dice.uniform(0, 6.28);
    scene.samples = motion > 0 ? 5 : 2;

    const auto surface = [&](V3d n, V3d r) -> V3d {
        if (made.kind == "mirror") return world.seen(r) * mirrors;
        const double lit = 0.15 + 0.85 * std::max(0.0, n.dot(sun));
        if (made.kind == "matte") return paint * lit;
        if (made.kind == "rough") return world.blurred(r) * mirrors;
        if (made.kind == "glossy") {
            const double fresnel = 0.04 + 0.96 * std::pow(1 - std::clamp(n.z, 0.0, 1.0), 5);
            return paint * lit + world.seen(r) * fresnel;
        }
        const double u = std::floor(std::atan2(n.x, n.z) * cells / std::numbers::pi);
        const double v = std::floor(std::asin(std::clamp(n.y, -1.0, 1.0)) * pitch);
        return (std::fmod(std::abs(u + v), 2.0) < 1 ? paint : paint2) * lit;
    };
    const auto seen = [&](double px, double py, double time) -> V3d {
        for (const Shape2d& s : before)
            if (s.holds(px, py)) return s.shade(px, py);
        const V3d q((px - 0.5 * w) / f, (0.5 * h - py) / f, -1);
        const double bx = px - time * motion * std::cos(heading);
        const double by = py - time * motion * std::sin(heading);
        const double rho = std::hypot(bx - rim.cx, by - rim.cy) / rim.b;
        if (made.kind == "disc" && rho < 1)
            return std::fmod(std::floor(rho * pitch) +
                                 std::floor(std::atan2(by - rim.cy, bx - rim.cx) * cells / 3.14) +
                                 40,
                             2.0) < 1
                       ? paint
                       : paint2;
        if (made.kind == "ring" && rho < 1 && rho > 0.6)
            return paint * (0.2 + 0.8 * std::sin(3.1416 * (rho - 0.6) / 0.4));
        if (made.kind != "disc" && made.kind != "ring") {
            const V3d p = V3d((bx - 0.5 * w) / f, (0.5 * h - by) / f, -1).normalized();
            const double along = p.dot(scene.centre);
            const double inside = along * along - scene.centre.length2() + 1;
            if (inside > 0) {
                const V3d n = p * (along - std::sqrt(inside)) - scene.centre;
                return surface(n, p - n * (2 * p.dot(n)));
            }
        }
        for (const Shape2d& s : behind)
            if (s.holds(px, py)) return s.shade(px, py);
        return world.seen(q.normalized());
    };

    std::vector<float> light;
    double mean = 0;
    const int n = scene.samples * scene.samples;
    for (int j = 0; j < h; ++j)
        for (int i = 0; i < w; ++i) {
            V3d sum(0);
            for (int k = 0; k < n; ++k)
                sum += seen(i + (k % scene.samples + 0.5) / scene.samples,
                            j + (k / scene.samples + 0.5) / scene.samples,
                            (k * 7 % n + 0.5) / n - 0.5);
            for (int c = 0; c < 3; ++c) light.push_back(static_cast<float>(sum[c] / n));
            mean += std::min(sum.y / n, 2.0) / (double(w) * h);
        }
    // Defocus: a few passes of a short box, each of which moves the picture by a pixel.
    const int passes = dice.chance(0.4) ? dice.whole(1, 5) : 0;
    for (int pass = 0; pass < passes; ++pass)
        for (const int step : {3, 3 * w})
            for (int i = 0; i < 3 * w * h - 2 * step; ++i) {
                float* v = light.data() + i;
                *v = (v[0] + v[step] + v[2 * step]) / 3;
            }
    const double exposure = dice.log_uniform(0.08, 0.5) / std::max(mean, 1e-3);
    const double noise = dice.chance(0.5) ? dice.log_uniform(0.5, 9) : 0.5;
    const bool flat = dice.chance(0.15), grey = dice.chance(0.1);
    made.photo = empty_photo(scene.size, PixelType::u8, 3);
    for (std::size_t i = 0; i < light.size(); ++i) {
        const double v = std::clamp(exposure * static_cast<double>(light[grey ? i / 3 * 3 : i]),
                                    0.0, flat ? 16.0 : 1.0);
        const double code = flat             ? 0.25 + 0.1 * std::log2(0.1 + 4 * v)
                            : v <= 0.0031308 ? 12.92 * v
                                             : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
        made.photo.pixels[i] = static_cast<std::byte>(
            std::lround(std::clamp(255 * code + noise * dice.normal(), 0.0, 255.0)));
    }
    if (made.kind == "mirror")
        made.ball = Outline{rim.cx - passes, rim.cy - passes, rim.a, rim.b, rim.angle};
    if (motion > 0) made.kind += " moving";
    return made;
}

}  // namespace chromeball::painted
