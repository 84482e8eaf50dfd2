#include "light/merge_ghosts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/statistics.h"

namespace chromeball {
namespace {

/// One photo's mean light in a cell, in the common unit.
struct CellLight {
    std::array<float, 3> mean{};
    std::array<float, 3> sigma{};   ///< of the mean, by noise and by half a pixel's shift
    std::array<bool, 3> clipped{};  ///< the mean is a least value
    bool seen = false;              ///< the photo reaches there
};

class Cells {
public:
    Cells(std::span<const MergePhoto> photos, Size size)
        : size_(size), photos_(photos.size()), cells_(size.pixels() * photos.size()) {}
    CellLight& at(std::size_t cell, std::size_t photo) { return cells_[cell * photos_ + photo]; }
    const CellLight& at(std::size_t cell, std::size_t photo) const {
        return cells_[cell * photos_ + photo];
    }
    Size size() const { return size_; }
    std::size_t photos() const { return photos_; }

private:
    Size size_;
    std::size_t photos_;
    std::vector<CellLight> cells_;
};

constexpr float kClipped = 0.96f;  // of white

CellLight cell_light(const MergePhoto& photo, const Response& response, ImageView<const float> rows,
                     int left, int cell) {
    CellLight light;
    light.seen = true;
    const auto white = static_cast<float>(photo.photo.white);
    const float unit = static_cast<float>(1 / photo.exposure);
    const float count = static_cast<float>(cell * cell);
    for (std::size_t c = 0; c < 3; ++c) {
        float sum = 0, square = 0, variance = 0;
        for (int y = 0; y < cell; ++y)
            for (int x = 0; x < cell; ++x) {
                const float z = rows.pixel(left + x, y)[c];
                const float v = response.light(z);
                light.clipped[c] = light.clipped[c] || !(z < kClipped * white);
                sum += v, square += v * v;
            }
        const float mean = sum / count;
        const float z = rows.pixel(left + cell / 2, cell / 2)[c];
        variance = static_cast<float>(noise_variance(photo.photo, static_cast<double>(mean),
                                                     static_cast<double>(response.slope(z))));
        // Rounding does not average out where all pixels are alike.
        const float texture = std::sqrt(std::max(0.0f, square / count - mean * mean));
        light.mean[c] = mean * unit;
        light.sigma[c] =
            unit * std::hypot(std::sqrt(variance / 4), texture / static_cast<float>(cell));
    }
    return light;
}

/// Largest contradiction of two photos over a cell: how far apart their light is, as a part of the
/// larger, beyond what noise explains. 0 where one of them does not tell.
float contradiction(const CellLight& a, const CellLight& b) {
    if (!a.seen || !b.seen) return 0;
    float most = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        // A clipped one is at least so bright: it cannot be too dark.
        const bool a_tells = !a.clipped[c] || a.mean[c] > b.mean[c];
        const bool b_tells = !b.clipped[c] || b.mean[c] > a.mean[c];
        if (!a_tells || !b_tells) continue;
        const float noise = 4 * std::hypot(a.sigma[c], b.sigma[c]);
        const float apart = std::abs(a.mean[c] - b.mean[c]) - noise;
        const float larger = std::max(a.mean[c], b.mean[c]);
        if (apart > 0 && larger > 0) most = std::max(most, apart / larger);
    }
    return most;
}

Cells measured(std::span<const MergePhoto> photos, const Response& response, int cell, Size size,
               const Watch& watch) {
    Cells cells(photos, size);
    const Size picture = photos.front().photo.size;
    for_each_band(
        size.height, 4,
        [&](int first, int last) {
            Image rows({picture.width, cell}, 3);
            for (int y = first; y < last; ++y)
                for (std::size_t k = 0; k < photos.size(); ++k) {
                    const MergePhoto& photo = photos[k];
                    const int top = y * cell + static_cast<int>(std::lround(photo.shift.y));
                    if (top < 0 || top + cell > picture.height) continue;
                    photo.photo.read(top, top + cell, rows.view());
                    for (int x = 0; x < size.width; ++x) {
                        const int left = x * cell + static_cast<int>(std::lround(photo.shift.x));
                        if (left < 0 || left + cell > picture.width) continue;
                        const std::size_t at =
                            static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                            static_cast<std::size_t>(x);
                        cells.at(at, k) = cell_light(photo, response, rows.view(), left, cell);
                    }
                }
        },
        watch);
    return cells;
}

using Flags = std::vector<char>;

/// From how large a contradiction on something moved: beyond what curves and tags that are a little
/// wrong do everywhere.
float threshold_of(const Cells& cells) {
    std::vector<double> typical;
    for (std::size_t cell = 0; cell < cells.size().pixels(); ++cell)
        for (std::size_t k = 0; k + 1 < cells.photos(); ++k)
            typical.push_back(
                static_cast<double>(contradiction(cells.at(cell, k), cells.at(cell, k + 1))));
    if (typical.empty()) return 1;
    return std::min(0.15f + 2 * static_cast<float>(median(std::move(typical))), 0.5f);
}

Flags contradicting(const Cells& cells, float threshold) {
    Flags flags(cells.size().pixels());
    for (std::size_t cell = 0; cell < flags.size(); ++cell)
        for (std::size_t a = 0; a < cells.photos() && !flags[cell]; ++a)
            for (std::size_t b = a + 1; b < cells.photos(); ++b)
                if (contradiction(cells.at(cell, a), cells.at(cell, b)) > threshold) {
                    flags[cell] = 1;
                    break;
                }
    return flags;
}

template <class F>
void for_neighbours(Size size, std::size_t cell, F f) {
    const int x = static_cast<int>(cell % static_cast<std::size_t>(size.width));
    const int y = static_cast<int>(cell / static_cast<std::size_t>(size.width));
    for (int j = std::max(0, y - 1); j <= std::min(size.height - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(size.width - 1, x + 1); ++i)
            if (i != x || j != y)
                f(static_cast<std::size_t>(j) * static_cast<std::size_t>(size.width) +
                  static_cast<std::size_t>(i));
}

/// Without those that stand nearly alone, then one wider all round.
Flags regions_of(const Flags& flags, Size size) {
    Flags kept(flags.size()), wide(flags.size());
    for (std::size_t cell = 0; cell < flags.size(); ++cell) {
        int around = 0;
        for_neighbours(size, cell, [&](std::size_t n) { around += flags[n]; });
        kept[cell] = flags[cell] && around >= 2;
    }
    for (std::size_t cell = 0; cell < flags.size(); ++cell) {
        wide[cell] = kept[cell];
        for_neighbours(size, cell, [&](std::size_t n) { wide[cell] |= kept[n]; });
    }
    return wide;
}

/// The cells of the region that `start` is in; they are wiped from `flags`.
std::vector<std::size_t> take_region(Flags& flags, Size size, std::size_t start) {
    std::vector<std::size_t> region{start};
    flags[start] = 0;
    for (std::size_t i = 0; i < region.size(); ++i)
        for_neighbours(size, region[i], [&](std::size_t n) {
            if (!flags[n]) return;
            flags[n] = 0;
            region.push_back(n);
        });
    return region;
}

bool tells(const CellLight& light) {
    if (!light.seen) return false;
    for (std::size_t c = 0; c < 3; ++c)
        if (light.clipped[c]) return false;
    return true;
}

/// How surely a photo shows a cell: 0 clipped, near 1 where the light is well above its noise.
float shown(const CellLight& light) {
    if (!tells(light)) return 0;
    const float mean = light.mean[0] + light.mean[1] + light.mean[2];
    const float sigma = light.sigma[0] + light.sigma[1] + light.sigma[2];
    return mean > 0 ? mean / (mean + 4 * sigma) : 0;
}

/// Of each photo, how many others contradict it in a cell, of those that still count.
std::vector<int> contradicted(const Cells& cells, std::size_t cell, const std::vector<bool>& out,
                              float threshold) {
    std::vector<int> count(cells.photos());
    for (std::size_t a = 0; a < cells.photos(); ++a)
        for (std::size_t b = a + 1; b < cells.photos(); ++b)
            if (!out[a] && !out[b] &&
                contradiction(cells.at(cell, a), cells.at(cell, b)) > threshold)
                ++count[a], ++count[b];
    return count;
}

/// How little each photo is to be believed in a region: how many contradict it there, and where
/// that is equal, how little it shows.
std::vector<double> doubts(const Cells& cells, const std::vector<std::size_t>& region,
                           float threshold) {
    std::vector<double> doubt(cells.photos());
    const std::vector<bool> none(cells.photos());
    for (const std::size_t cell : region) {
        const auto count = contradicted(cells, cell, none, threshold);
        for (std::size_t k = 0; k < doubt.size(); ++k)
            doubt[k] += count[k] + 0.01 * (1 - static_cast<double>(shown(cells.at(cell, k))));
    }
    for (double& d : doubt) d /= static_cast<double>(region.size());
    return doubt;
}

/// Leaves out who is contradicted most, until nobody is; between equals the longest exposure.
void decide(const Cells& cells, std::size_t cell, const std::vector<double>& doubt, float threshold,
            GhostMap& map) {
    std::vector<bool> out(cells.photos());
    for (std::size_t round = 0; round + 1 < cells.photos(); ++round) {
        const auto count = contradicted(cells, cell, out, threshold);
        std::size_t worst = cells.photos();
        for (std::size_t k = 0; k < count.size(); ++k)
            if (count[k] > 0 &&
                (worst == cells.photos() || count[k] + doubt[k] >= count[worst] + doubt[worst]))
                worst = k;
        if (worst == cells.photos()) return;
        out[worst] = true;
        map.allowed[worst][cell] = 0;
    }
}

/// What is left out in a cell is left out beside it, too, where others show it: the edge of what
/// moved covers a part of a cell only.
void widen(const Cells& cells, GhostMap& map) {
    const auto before = map.allowed;
    for (std::size_t cell = 0; cell < map.size.pixels(); ++cell)
        for (std::size_t k = 0; k < cells.photos(); ++k) {
            if (before[k][cell] == 0) continue;
            bool beside = false;
            for_neighbours(map.size, cell, [&](std::size_t n) { beside |= before[k][n] == 0; });
            bool others = false;
            for (std::size_t j = 0; j < cells.photos(); ++j)
                others |= j != k && map.allowed[j][cell] > 0 && tells(cells.at(cell, j));
            if (beside && others) map.allowed[k][cell] = 0;
        }
}

}  // namespace

float GhostMap::at(std::size_t photo, double x, double y) const {
    const double u = std::clamp(x / cell - 0.5, 0.0, size.width - 1.0);
    const double v = std::clamp(y / cell - 0.5, 0.0, size.height - 1.0);
    const int x0 = std::min(static_cast<int>(u), std::max(0, size.width - 2));
    const int y0 = std::min(static_cast<int>(v), std::max(0, size.height - 2));
    const int x1 = std::min(x0 + 1, size.width - 1), y1 = std::min(y0 + 1, size.height - 1);
    const auto get = [&](int i, int j) {
        return allowed[photo][static_cast<std::size_t>(j) * static_cast<std::size_t>(size.width) +
                              static_cast<std::size_t>(i)];
    };
    const auto a = static_cast<float>(u - x0), b = static_cast<float>(v - y0);
    return (1 - b) * ((1 - a) * get(x0, y0) + a * get(x1, y0)) +
           b * ((1 - a) * get(x0, y1) + a * get(x1, y1));
}

void GhostMap::row(std::size_t photo, int y, std::span<float> out) const {
    for (std::size_t x = 0; x < out.size(); ++x)
        out[x] = at(photo, static_cast<double>(x) + 0.5, y + 0.5);
}

bool GhostMap::always(std::size_t photo) const {
    return std::ranges::all_of(allowed[photo], [](float a) { return a == 1; });
}

GhostMap find_ghosts(std::span<const MergePhoto> photos, const Response& response,
                     const Watch& watch) {
    const Size picture = photos.front().photo.size;
    GhostMap map;
    map.cell = std::max(8, std::max(picture.width, picture.height) / 256);
    map.size = {std::max(1, picture.width / map.cell), std::max(1, picture.height / map.cell)};
    map.allowed.assign(photos.size(), std::vector<float>(map.size.pixels(), 1));
    if (photos.size() < 2 || picture.width < map.cell || picture.height < map.cell) return map;
    const Cells cells = measured(photos, response, map.cell, map.size, watch);
    const float threshold = threshold_of(cells);
    Flags flags = regions_of(contradicting(cells, threshold), map.size);
    for (std::size_t cell = 0; cell < flags.size(); ++cell) {
        if (!flags[cell]) continue;
        const auto region = take_region(flags, map.size, cell);
        const auto doubt = doubts(cells, region, threshold);
        for (const std::size_t one : region) decide(cells, one, doubt, threshold, map);
    }
    widen(cells, map);
    return map;
}

}  // namespace chromeball
