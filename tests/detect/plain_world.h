#pragma once

#include "detect/dice.h"
#include "detect/painted.h"

namespace chromeball::painted {

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

}  // namespace chromeball::painted
