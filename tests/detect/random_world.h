#pragma once

#include <Imath/half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "detect/dice.h"
#include "detect/painted.h"
#include "io/read.h"
#include "map/mirror_ball.h"

namespace chromeball::painted {

using Imath::V3f;

/// Light from all around, linear, as a table of directions (+Y up), with what rough and matte
/// surfaces make of it.
class Environment {
public:
    static constexpr int kWidth = 768, kHeight = 384;

    template <class Light>
    explicit Environment(Light light) : sharp_(kWidth, kHeight) {
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) sharp_.at(x, y) = V3f(light(sharp_.direction(x, y)));
        coarse_.push_back(sharp_.halved());
        while (coarse_.back().width > 48) coarse_.push_back(coarse_.back().halved());
        const Table& small = coarse_[3];
        for (const double degrees : kLobes) lobes_.push_back(blurred(small, degrees));
    }

    /// As seen by a pixel of about so many radians a side.
    V3d sharp(V3d d, double width = 0) const {
        const double texels = width * kWidth / (2 * std::numbers::pi);
        if (texels < 1.5) return V3d(sharp_.sample(d));
        const auto last = static_cast<int>(coarse_.size()) - 1;
        return V3d(coarse_[std::size_t(std::clamp(std::ilogb(texels / 1.5), 0, last))].sample(d));
    }

    /// Averaged with a lobe of that standard deviation, 6 to 50 degrees (50 is about what a matte
    /// surface receives).
    V3d rough(V3d d, double degrees) const {
        std::size_t i = 0;
        while (i + 2 < kLobes.size() && degrees > kLobes[i + 1]) ++i;
        const double t = std::clamp(
            std::log(degrees / kLobes[i]) / std::log(kLobes[i + 1] / kLobes[i]), 0.0, 1.0);
        return V3d(lobes_[i].sample(d)) * (1 - t) + V3d(lobes_[i + 1].sample(d)) * t;
    }

private:
    static constexpr std::array<double, 4> kLobes{6, 12, 25, 50};

    struct Table {
        int width, height;
        std::vector<V3f> texels;
        Table(int w, int h)
            : width(w), height(h), texels(static_cast<std::size_t>(w) * std::size_t(h)) {}
        Table halved() const {
            Table half(width / 2, height / 2);
            for (int y = 0; y < half.height; ++y)
                for (int x = 0; x < half.width; ++x)
                    half.at(x, y) = (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) +
                                     at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1)) /
                                    4.f;
            return half;
        }
        V3f& at(int x, int y) { return texels[static_cast<std::size_t>(y * width + x)]; }
        const V3f& at(int x, int y) const {
            return texels[static_cast<std::size_t>(y * width + x)];
        }
        V3d direction(int x, int y) const {
            const double lon = 2 * std::numbers::pi * (x + 0.5) / width;
            const double lat = std::numbers::pi * (0.5 - (y + 0.5) / height);
            return {std::cos(lat) * std::sin(lon), std::sin(lat), std::cos(lat) * std::cos(lon)};
        }
        V3f sample(V3d d) const {
            const double turn = std::atan2(d.x, d.z) / (2 * std::numbers::pi);
            const double v = 0.5 - std::asin(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi;
            const double fx = (turn - std::floor(turn)) * width - 0.5;
            const double fy = std::clamp(v * height - 0.5, 0.0, height - 1.001);
            const int x = static_cast<int>(std::floor(fx)), y = static_cast<int>(fy);
            const auto a = static_cast<float>(fx - x), b = static_cast<float>(fy - y);
            const int x0 = (x + width) % width, x1 = (x + 1) % width;
            return (at(x0, y) * (1 - a) + at(x1, y) * a) * (1 - b) +
                   (at(x0, y + 1) * (1 - a) + at(x1, y + 1) * a) * b;
        }
    };

    static Table blurred(const Table& from, double degrees) {
        Table to(from.width, from.height);
        const double k = std::pow(180 / (degrees * std::numbers::pi), 2);
        for (int y = 0; y < to.height; ++y)
            for (int x = 0; x < to.width; ++x) {
                const V3d d = to.direction(x, y);
                V3d sum(0);
                double weights = 0;
                for (int v = 0; v < from.height; ++v) {
                    const double area =
                        std::cos(std::numbers::pi * (0.5 - (v + 0.5) / from.height));
                    for (int u = 0; u < from.width; ++u) {
                        const double off = k * (1 - d.dot(from.direction(u, v)));
                        if (off > 9) continue;
                        const double weight = area * std::exp(-off);
                        sum += V3d(from.at(u, v)) * weight;
                        weights += weight;
                    }
                }
                to.at(x, y) = V3f(sum / weights);
            }
        return to;
    }

    Table sharp_;
    std::vector<Table> coarse_;  ///< each half as wide as the one before
    std::vector<Table> lobes_;
};

/// Values about 0.5 with structure at all sizes, as things in the world have.
inline double fractal_noise(V3d p, int octaves, double roughness = 0.55) {
    double sum = 0, size = 1, all = 0;
    for (int i = 0; i < octaves; ++i) {
        sum += size * value_noise(p);
        all += size;
        size *= roughness;
        p = p * 2.07 + V3d(3.1, 5.7, 1.3);
    }
    return sum / all;
}

/// What a surface looks like, by position on it.
struct Texture {
    enum Kind { plain, stripes, checks, windows, planks, speckle, grain, bricks } kind = plain;
    V3d color{0.5}, other{0.2};
    double pitch = 0.3, rough = 0.3;
    V3d shift{0};

    static Texture random(Dice& dice) {
        Texture t;
        t.kind = static_cast<Kind>(dice.whole(0, 7));
        t.color = dice.color(0.6);
        t.other = dice.chance(0.5) ? t.color * dice.log_uniform(0.3, 2) : dice.color(0.6);
        t.pitch = dice.log_uniform(0.05, 0.8);
        t.rough = dice.uniform(0.05, 0.6);
        t.shift = V3d(dice.uniform(0, 90), dice.uniform(0, 90), dice.uniform(0, 90));
        return t;
    }

    V3d at(double u, double v, int octaves = 4) const {
        const double noise =
            1 + rough * 2 * (fractal_noise(V3d(u, v, 0) * (1.5 / pitch) + shift, octaves) - 0.5);
        const auto cell = [&](double x) { return static_cast<int>(std::floor(x / pitch)); };
        const int i = cell(u), j = cell(v);
        switch (kind) {
            case stripes:
                return ((i & 1) ? color : other) * noise;
            case checks:
                return (((i + j) & 1) ? color : other) * noise;
            case windows: {
                const double x = u / pitch - i, y = v / pitch - j;
                if (x < 0.25 || x > 0.8 || y < 0.2 || y > 0.75) return color * noise;
                return other * (0.3 + 1.4 * hash(i, j, 7));
            }
            case planks: {
                const double along = fractal_noise(V3d(u * 0.3, v * 6, i) * (2 / pitch), 3);
                return color * (0.5 + along) * (0.7 + 0.6 * hash(i, 3, 1)) *
                       (u / pitch - i < 0.04 ? 0.3 : 1.0);
            }
            case bricks: {
                const double x = u / pitch + 0.5 * (cell(2.5 * v) & 1), y = 2.5 * v / pitch;
                if (x - std::floor(x) < 0.06 || y - std::floor(y) < 0.12) return other * noise;
                return color * noise *
                       (0.7 + 0.6 * hash(int(std::floor(x)), int(std::floor(y)), 2));
            }
            case speckle:
                return hash(cell(8 * u), cell(8 * v), 5) > 0.6 ? other * noise : color * noise;
            case grain:
                return color * (0.3 + 1.4 * fractal_noise(V3d(u, v, 2) * (3 / pitch) + shift,
                                                          octaves + 1, 0.75));
            default:
                return color * noise;
        }
    }
};

/// A room, a street, a clearing or a studio made of boxes around the ball, seen by rays.
class Surroundings {
public:
    explicit Surroundings(Dice& dice) {
        const int kind = dice.whole(0, 4);
        sun_ = V3d(dice.uniform(-1, 1), dice.uniform(0.2, 1), dice.uniform(-1, 1)).normalized();
        sky_ = V3d(dice.uniform(0.3, 0.9), dice.uniform(0.5, 0.9), 1) * dice.log_uniform(0.3, 3);
        horizon_ = V3d(1, dice.uniform(0.7, 1), dice.uniform(0.5, 1)) * dice.log_uniform(0.4, 3);
        cloud_ = dice.uniform(0, 1);
        sunny_ = dice.chance(0.6) ? dice.log_uniform(20, 3000) : 0;
        noise_ = V3d(dice.uniform(0, 90), dice.uniform(0, 90), dice.uniform(0, 90));
        floor_ = -dice.uniform(0.8, 1.7);
        ground_ = Texture::random(dice);
        ground_.pitch *= 3;
        ambient_ = dice.uniform(0.15, 0.6);
        if (kind <= 1) room(dice);
        if (kind == 2) street(dice);
        if (kind == 3) clearing(dice);
        if (kind == 4) studio(dice);
    }

    V3d operator()(V3d d) const {
        double best = 1e9;
        const Block* hit = nullptr;
        int side = 0;
        for (const Block& b : blocks_) {
            double near = 1e-6, far = best;
            int face = 0;
            for (int k = 0; k < 3 && near < far; ++k) {
                const double inverse = 1 / (std::abs(d[k]) < 1e-9 ? 1e-9 : d[k]);
                double t0 = b.low[k] * inverse, t1 = b.high[k] * inverse;
                if (t0 > t1) std::swap(t0, t1);
                if (t0 > near) near = t0, face = k;
                far = std::min(far, t1);
            }
            if (near >= far || near < 1e-5) continue;
            const V3d p = d * near;
            if (b.leaves > 0 && fractal_noise(p * b.leaves + noise_, 4, 0.7) < 0.47) continue;
            best = near, hit = &b, side = face;
        }
        if (walls_.x > 0) {  // inside of a room: the far side of a box
            double wall = 1e9;
            int face = 0;
            for (int k = 0; k < 3; ++k) {
                const double limit =
                    k == 1 ? (d.y > 0 ? walls_.y : floor_) : (d[k] > 0 ? walls_[k] : -walls_[k]);
                const double t = std::abs(d[k]) > 1e-9 ? limit / d[k] : 1e9;
                if (t < wall) wall = t, face = k;
            }
            if (wall < best) {
                const V3d p = d * wall;
                const auto k = static_cast<std::size_t>(face == 1 && d.y < 0 ? 3 : face);
                const Texture& texture = k == 3 ? ground_ : paper_[k];
                return lit(face == 0   ? texture.at(p.y, p.z)
                           : face == 1 ? texture.at(p.x, p.z)
                                       : texture.at(p.x, p.y),
                           d, face) *
                       (0.6 + 0.4 * std::min(1.0, 1 / (0.2 + 0.1 * wall * wall)));
            }
        } else if (d.y < 0 && floor_ / d.y < best) {
            const double t = floor_ / d.y;
            const int octaves = t < 6 ? 5 : t < 30 ? 3 : 1;
            const double fade = std::min(1.0, 25 / t);
            const V3d mean = (ground_.color + ground_.other) * 0.5;
            return lit(ground_.at(d.x * t, d.z * t, octaves) * fade + mean * (1 - fade),
                       V3d(0, -1, 0), 1);
        }
        if (!hit) return above(d);
        const V3d p = d * best;
        const V3d color = side == 0   ? hit->paint.at(p.z, p.y)
                          : side == 1 ? hit->paint.at(p.x, p.z)
                                      : hit->paint.at(p.x, p.y);
        if (hit->glow > 0) return V3d(1, 0.95, 0.85) * hit->glow;
        if (hit->leaves > 0)
            return lit(color * 2 * fractal_noise(p * hit->leaves * 1.7, 3, 0.8), d, side);
        return lit(color, d, side);
    }

private:
    struct Block {
        V3d low, high;
        Texture paint;
        double glow = 0, leaves = 0;
    };

    V3d lit(V3d color, V3d d, int side) const {
        V3d normal(0);
        normal[side] = d[side] > 0 ? -1 : 1;
        return color * (ambient_ + (1 - ambient_) * 1.5 * std::max(0.0, normal.dot(sun_)));
    }
    V3d above(V3d d) const {
        if (dark_) return V3d(0.02) * (0.5 + fractal_noise(d * 3 + noise_, 4));
        const double t = std::pow(std::clamp(d.y, 0.0, 1.0), 0.5);
        V3d color = horizon_ * (1 - t) + sky_ * t;
        const double cover = fractal_noise(V3d(d.x, 2 * d.y, d.z) * 4 + noise_, 6, 0.6);
        const double part = cloud_ * std::clamp(6 * (cover - 0.48), 0.0, 1.0);
        color = color * (1 - part) + V3d(1.2) * horizon_.length() * part * (0.4 + cover);
        return color + V3d(1, 0.9, 0.8) * (d.dot(sun_) > 0.9995 ? sunny_ : 0.0);
    }
    void add(V3d middle, V3d half, const Texture& paint, double glow = 0, double leaves = 0) {
        blocks_.push_back({middle - half, middle + half, paint, glow, leaves});
    }
    void add_on_floor(Dice& dice, double nearest, double farthest, double low, double high) {
        const double turn = dice.uniform(0, 6.2832), r = dice.log_uniform(nearest, farthest);
        const double height = dice.log_uniform(low, high);
        const V3d half(dice.log_uniform(0.15, 0.4) * r, 0.5 * height,
                       dice.log_uniform(0.05, 0.4) * r);
        add({r * std::sin(turn), floor_ + 0.5 * height, r * std::cos(turn)},
            {std::min(half.x, 0.5 * r), half.y, std::min(half.z, 0.5 * r)}, Texture::random(dice));
    }
    void room(Dice& dice) {
        walls_ = V3d(dice.log_uniform(1.5, 8), dice.uniform(0.8, 2.5), dice.log_uniform(1.5, 8));
        for (Texture& t : paper_) {
            t = Texture::random(dice);
            if (dice.chance(0.7)) t.kind = Texture::plain, t.rough *= 0.3;
        }
        for (int i = dice.whole(0, 5); i > 0; --i) {  // windows and pictures on walls
            const int k = dice.chance(0.5) ? 0 : 2;
            V3d middle(0), half(0.02);
            middle[k] = dice.chance(0.5) ? walls_[k] : -walls_[k];
            middle[2 - k] = dice.uniform(-0.8, 0.8) * walls_[2 - k];
            middle.y = dice.uniform(0, 0.7) * walls_.y;
            half[2 - k] = dice.uniform(0.1, 0.35) * walls_[2 - k];
            half.y = dice.uniform(0.2, 0.5) * walls_.y;
            const double glow = dice.chance(0.5) ? dice.log_uniform(2, 40) : 0;
            add(middle, half, Texture::random(dice), glow);
            if (glow > 0) {  // its bars
                V3d bar = half * 1.1;
                bar[2 - k] = 0.03;
                add(middle * 0.99, bar, Texture{});
                bar = half * 1.1, bar.y = 0.03;
                add(middle * 0.99, bar, Texture{});
            }
        }
        for (int i = dice.whole(0, 8); i > 0; --i)  // lamps
            add({dice.uniform(-0.8, 0.8) * walls_.x, walls_.y * dice.uniform(0.7, 1),
                 dice.uniform(-0.8, 0.8) * walls_.z},
                {dice.log_uniform(0.03, 0.5), 0.03, dice.log_uniform(0.03, 0.3)}, Texture{},
                dice.log_uniform(4, 200));
        for (int i = dice.whole(4, 35); i > 0; --i)
            add_on_floor(dice, 0.7, std::max(walls_.x, walls_.z), 0.2, -floor_ + walls_.y);
    }
    void street(Dice& dice) {
        for (int i = dice.whole(6, 40); i > 0; --i) add_on_floor(dice, 8, 60, 3, 40);
        for (int i = dice.whole(0, 25); i > 0; --i) add_on_floor(dice, 1.5, 15, 0.3, 2.5);
        for (Block& b : blocks_) b.paint.pitch *= b.high.y > 3 ? 5 : 1;
    }
    void clearing(Dice& dice) {
        Texture green = Texture::random(dice);
        green.kind = Texture::grain;
        green.color = V3d(dice.uniform(0.1, 0.4), dice.uniform(0.2, 0.5), 0.1);
        ground_.kind = Texture::grain;
        for (int i = dice.whole(6, 20); i > 0; --i) {
            add_on_floor(dice, 2.5, 14, 1.0, 10);
            Block& b = blocks_.back();
            b.paint = green;
            b.leaves = dice.log_uniform(0.8, 3);
            if (dice.chance(0.5)) b.low.y += 0.3 * (b.high.y - b.low.y);
        }
        for (int i = dice.whole(0, 12); i > 0; --i) {
            add_on_floor(dice, 2, 15, 3, 12);
            Block& b = blocks_.back();
            const V3d middle = (b.low + b.high) * 0.5;
            const double half = dice.log_uniform(0.05, 0.3);
            b.low.x = middle.x - half, b.high.x = middle.x + half;
            b.low.z = middle.z - half, b.high.z = middle.z + half;
        }
        for (int i = dice.whole(0, 8); i > 0; --i) add_on_floor(dice, 1.5, 8, 0.2, 1.5);
    }
    void studio(Dice& dice) {
        dark_ = true;
        ground_.kind = Texture::plain;
        for (int i = dice.whole(2, 7); i > 0; --i) {
            const V3d d = dice.direction();
            add(V3d(d.x, std::abs(d.y), d.z) * dice.uniform(1.5, 4),
                {dice.log_uniform(0.1, 0.8), dice.log_uniform(0.1, 0.8),
                 dice.log_uniform(0.1, 0.8)},
                Texture{}, dice.log_uniform(2, 40));
        }
        for (int i = dice.whole(2, 15); i > 0; --i) add_on_floor(dice, 1, 6, 0.3, 2.5);
    }

    V3d sun_, sky_, horizon_, noise_, walls_{0};
    double cloud_ = 0, sunny_ = 0, floor_ = -1, ambient_ = 0.3;
    bool dark_ = false;
    Texture ground_;
    std::array<Texture, 3> paper_;
    std::vector<Block> blocks_;
};

/// A photo with a ball whose place is known: the ball gives the surroundings, the rest is
/// background. In the camera's frame.
class Plate {
public:
    Plate(const std::string& path, Camera camera, Outline ball)
        : camera_(camera), ball_(ball), levels_(levels_of(read_photo(path))), environment_([this] {
              const MirrorBall mirror(camera_, cone_of(ball_, camera_));
              V3d last(0);
              return Environment([&, last](V3d d) mutable {
                  if (d.z < 0) {
                      const double x = camera_.principal.x - *camera_.focal * d.x / d.z;
                      const double y = camera_.principal.y + *camera_.focal * d.y / d.z;
                      const bool inside = x > 0 && y > 0 && x < size_.width && y < size_.height;
                      if (inside && std::hypot(x - ball_.cx, y - ball_.cy) > 1.03 * ball_.a)
                          return last = at(x, y);
                  }
                  if (const auto p = mirror.to_position(d)) last = at(p->x, p->y);
                  return last;
              });
          }()) {}

    const Environment& environment() const { return environment_; }
    const Camera& camera() const { return camera_; }
    Size size() const { return size_; }
    /// The widest strip beside the ball: from, to.
    std::array<double, 2> strip(bool left) const {
        return left ? std::array{0.0, ball_.cx - 1.05 * ball_.a}
                    : std::array{ball_.cx + 1.05 * ball_.a, double(size_.width)};
    }
    /// As seen by a pixel of so many of the photo's.
    V3d at(double x, double y, double width = 1) const {
        const auto last = static_cast<int>(levels_.size()) - 1;
        const int l = std::clamp(std::ilogb(std::max(width, 1e-3) / 1.4), 0, last);
        const Level& level = levels_[static_cast<std::size_t>(l)];
        const double fx = std::clamp(std::ldexp(x, -l) - 0.5, 0.0, level.size.width - 1.001);
        const double fy = std::clamp(std::ldexp(y, -l) - 0.5, 0.0, level.size.height - 1.001);
        const int i = static_cast<int>(fx), j = static_cast<int>(fy);
        const auto a = static_cast<float>(fx - i), b = static_cast<float>(fy - j);
        return V3d((level.at(i, j) * (1 - a) + level.at(i + 1, j) * a) * (1 - b) +
                   (level.at(i, j + 1) * (1 - a) + level.at(i + 1, j + 1) * a) * b);
    }

private:
    struct Level {
        Size size;
        std::vector<V3f> light;
        const V3f& at(int x, int y) const {
            return light[static_cast<std::size_t>(y) * std::size_t(size.width) + std::size_t(x)];
        }
        Level halved() const {
            Level half{{size.width / 2, size.height / 2}, {}};
            for (int y = 0; y < half.size.height; ++y)
                for (int x = 0; x < half.size.width; ++x)
                    half.light.push_back((at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) +
                                          at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1)) /
                                         4.f);
            return half;
        }
    };

    std::vector<Level> levels_of(const Photo& photo) {
        size_ = photo.window.size;
        std::vector<Level> levels{{size_, linear(photo)}};
        while (levels.size() < 4) levels.push_back(levels.back().halved());
        return levels;
    }
    static std::vector<V3f> linear(const Photo& photo) {
        std::vector<V3f> light(photo.window.size.pixels());
        const auto channels = static_cast<std::size_t>(photo.channels);
        for (std::size_t i = 0; i < light.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                light[i][static_cast<int>(c)] = value(photo, i * channels + c);
        return light;
    }
    static float value(const Photo& photo, std::size_t i) {
        if (photo.type == PixelType::f16)
            return std::max(0.f,
                            float(reinterpret_cast<const Imath::half*>(photo.pixels.data())[i]));
        const double v = std::to_integer<int>(photo.pixels[i]) / 255.0;
        return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }

    Size size_;
    Camera camera_;
    Outline ball_;
    std::vector<Level> levels_;
    Environment environment_;
};

/// The photos of data/photos, with lens and ball as rendered.
inline const std::vector<std::unique_ptr<Plate>>& plates() {
    static const auto all = [] {
        const std::string folder = std::string(CHROMEBALL_DATA) + "/photos/";
        const auto camera = [](int width, int height, double mm) {
            return Camera{width * mm / 36, {0.5 * width, 0.5 * height}};
        };
        std::vector<std::unique_ptr<Plate>> made;
        made.push_back(std::make_unique<Plate>(folder + "city.jpg", camera(1920, 1080, 35),
                                               Outline{960, 517.8, 300, 300, 0}));
        made.push_back(std::make_unique<Plate>(folder + "garden.exr", camera(1920, 1080, 35),
                                               Outline{804.3, 485.2, 220.9, 220, 19.4}));
        made.push_back(std::make_unique<Plate>(folder + "interior.jpg", camera(1920, 1080, 50),
                                               Outline{901.9, 539.6, 260.2, 260.1, 0}));
        made.push_back(std::make_unique<Plate>(folder + "room.exr", camera(4096, 2160, 50),
                                               Outline{2048, 1080, 900, 900, 0}));
        return made;
    }();
    return all;
}

/// Random surroundings by number, each made once.
inline const Environment& surroundings(unsigned number) {
    struct Entry {
        std::once_flag once;
        std::unique_ptr<Environment> made;
    };
    static std::mutex mutex;
    static std::map<unsigned, Entry> all;
    Entry& entry = [&]() -> Entry& {
        const std::lock_guard lock(mutex);
        return all[number];
    }();
    std::call_once(entry.once, [&] {
        Dice dice(number * 7919 + 13);
        entry.made = std::make_unique<Environment>(Surroundings(dice));
    });
    return *entry.made;
}

}  // namespace chromeball::painted
