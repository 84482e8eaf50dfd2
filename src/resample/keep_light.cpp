#include "resample/keep_light.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/parallel.h"
#include "resample/filter.h"
#include "resample/mean_over_square.h"
#include "resample/spots.h"

namespace chromeball {
namespace {

/// A part of the picture that has a mapping of its own: all of it, or a cube's face.
struct Cell {
    kernel::TargetForm target;
    int x = 0, y = 0, width = 0, height = 0;
};

std::vector<Cell> cells_of(const Plan& plan) {
    std::vector<Cell> cells;
    for (const PlannedTile& planned : plan.tiles) {
        const kernel::Tile& tile = planned.tile;
        if (cells.empty() || cells.back().x != planned.cell_x || cells.back().y != planned.cell_y)
            cells.push_back({tile.target, planned.cell_x, planned.cell_y, 0, 0});
        cells.back().width = std::max(cells.back().width, tile.x1);
        cells.back().height = std::max(cells.back().height, tile.y1);
    }
    return cells;
}

/// Pixels [x0, x1) x [y0, y1) of a cell.
struct Rectangle {
    std::size_t cell = 0;
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// A box around positions in a cell.
struct Box {
    double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
    bool empty() const { return left > right; }
    void add(V2d p) {
        left = std::min(left, p.x);
        right = std::max(right, p.x);
        top = std::min(top, p.y);
        bottom = std::max(bottom, p.y);
    }
};

/// Light to be added to a pixel.
struct Addition {
    float* pixel;
    float color[3];
};

/// One conversion.
class Keeper {
public:
    Keeper(const Source& source, const Layout& layout, const Plan& plan, ImageView<float> out,
           const Rotation& rotation)
        : source_(source),
          layout_(layout),
          job_(plan.job),
          cells_(cells_of(plan)),
          out_(out),
          rotation_(rotation) {}

    std::vector<Addition> additions(const Spot& spot) const {
        Drawn drawn;
        for (const Rectangle& where : rectangles(spot))
            for (int y = where.y0; y < where.y1; y += kernel::kTileHeight)
                for (int x = where.x0; x < where.x1; x += kernel::kTileWidth)
                    draw(spot,
                         {where.cell, x, y, std::min(x + kernel::kTileWidth, where.x1),
                          std::min(y + kernel::kTileHeight, where.y1)},
                         drawn);
        V3d missed(0, 0, 0);
        for (int c = 0; c < 3; ++c)
            missed[c] = set_channel(drawn, c, spot.light[c], highest(spot, c));
        if (missed != V3d(0, 0, 0)) put(spot, missed, drawn.pixels);
        return std::move(drawn.pixels);
    }

private:
    /// What is not black of a spot drawn alone.
    struct Drawn {
        std::vector<Addition> pixels;
        std::vector<double> steradians;
    };

    /// Makes a channel of what was drawn the difference to what holds `light`. Too much is made
    /// less everywhere alike. Of too little, b is made b + more b (1 - b / highest): nothing
    /// becomes brighter than the spot's own pixels. Gives the light that is missed if taps had no
    /// more than a glimpse of the spot.
    static double set_channel(Drawn& drawn, int channel, double light, double highest) {
        const auto value = [&](std::size_t i) -> float& { return drawn.pixels[i].color[channel]; };
        double sum = 0, room = 0, most = 0;
        for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
            const double b = static_cast<double>(value(i)), omega = drawn.steradians[i];
            sum += omega * b;
            room += omega * b * (1 - b / highest);
            most = std::max(most, b);
        }
        constexpr double kGlimpse = 0.25;
        const double lacking = light - sum;
        const bool missed = sum < kGlimpse * light;
        const double more = room > 0 ? std::min(lacking / room, highest / most) : 0;
        for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
            const double b = static_cast<double>(value(i));
            double added = 0;
            if (lacking > 0 && !missed)
                added = b * more * (1 - b / highest);
            else if (lacking < 0)
                added = b * lacking / sum;
            value(i) = static_cast<float>(added);
        }
        return missed ? lacking : 0;
    }

    /// Puts light into the pixel that shows a spot's middle. Of the thin slices at a lat-long's
    /// pole, and of an angular map's edge, a much larger pixel's taps may see one or none.
    void put(const Spot& spot, V3d light, std::vector<Addition>& to) const {
        const auto d = direction_at(
            source_, spot.top,
            V2d(0.5 * (spot.left + spot.right + 1), 0.5 * (spot.top + spot.bottom + 1)));
        const auto p = d ? std::visit([&](const auto& m) { return m.to_position(rotation_ * *d); },
                                      layout_.projection)
                         : std::nullopt;
        if (!p) return;
        const int x = std::clamp(static_cast<int>(p->x * out_.size.width), 0, out_.size.width - 1);
        const int y =
            std::clamp(static_cast<int>(p->y * out_.size.height), 0, out_.size.height - 1);
        const double omega = solid_angle(x, y);
        Addition addition{out_.pixel(x, y), {}};
        for (int c = 0; c < 3 && omega > 0; ++c)
            addition.color[c] = static_cast<float>(std::min(light[c] / omega, highest(spot, c)));
        to.push_back(addition);
    }

    static double highest(const Spot& spot, int channel) {
        float most = 0;
        for (const kernel::LitPixel& pixel : spot.pixels)
            most = std::max(most, pixel.color[channel]);
        return static_cast<double>(most);
    }

    void draw(const Spot& spot, const Rectangle& where, Drawn& drawn) const {
        const Cell& cell = cells_[where.cell];
        const int width = where.x1 - where.x0;
        Image pixels({width, where.y1 - where.y0}, 4);
        kernel::Tile tile;
        tile.target = cell.target;
        tile.x0 = where.x0;
        tile.y0 = where.y0;
        tile.x1 = where.x1;
        tile.y1 = where.y1;
        tile.out = pixels.row(0);
        tile.stride = 4 * static_cast<std::ptrdiff_t>(width);
        kernel::draw_lit(job_, tile,
                         {source_.pixels.row(0), spot.pixels.data(), spot.pixels.size()});
        for (int y = where.y0; y < where.y1; ++y)
            for (int x = where.x0; x < where.x1; ++x) {
                const float* p = pixels.pixel(x - where.x0, y - where.y0);
                if (p[0] == 0 && p[1] == 0 && p[2] == 0) continue;
                drawn.pixels.push_back({out_.pixel(cell.x + x, cell.y + y), {p[0], p[1], p[2]}});
                drawn.steradians.push_back(solid_angle(cell.x + x, cell.y + y));
            }
    }

    /// Of a pixel of the output; of one that a disk's edge cuts as if all of it had directions:
    /// what is missing is in its alpha.
    double solid_angle(int x, int y) const {
        const double width = out_.size.width, height = out_.size.height;
        return std::visit(
            [&](const auto& shape) {
                double sum = 0;
                int count = 0;
                mean_over_square([&](double dx, double dy) {
                    const double one = shape.solid_angle(V2d((x + dx) / width, (y + dy) / height));
                    sum += one;
                    count += one > 0;
                    return one;
                });
                return count > 0 ? sum / count / (width * height) : 0;
            },
            layout_.projection);
    }

    /// Which pixels of the output may show a spot.
    std::vector<Rectangle> rectangles(const Spot& spot) const {
        // A cubic tap looks two pixels far.
        constexpr double kReach = filter::kCubicReach;
        const double left = spot.left + 0.5 - kReach, top = spot.top + 0.5 - kReach;
        const double width = spot.right - spot.left + 2 * kReach,
                     height = spot.bottom - spot.top + 2 * kReach;
        const int nx = static_cast<int>(std::ceil(width)), ny = static_cast<int>(std::ceil(height));
        std::vector<V3d> directions;
        for (int j = 0; j <= ny; ++j)
            for (int i = 0; i <= nx; ++i) {
                const V2d place(left + width * i / nx, top + height * j / ny);
                if (const auto d = direction_at(source_, spot.top, place))
                    directions.push_back(rotation_ * *d);
            }
        std::vector<Rectangle> result;
        if (const auto* cube = std::get_if<Cube>(&layout_.projection)) {
            for (std::size_t face = 0; face < cells_.size(); ++face)
                add(face, box_on_face(*cube, static_cast<int>(face), directions), result);
            return result;
        }
        std::visit([&](const auto& shape) { add(0, box_of(shape, directions), result); },
                   layout_.projection);
        return result;
    }

    /// On the face's plane, so that it reaches the face's edges however far apart the places are.
    Box box_on_face(const Cube& cube, int face, const std::vector<V3d>& directions) const {
        constexpr double kLeastDepth = 0.2;  // on a face 0.58 at least
        const double half = 0.5 * cells_[static_cast<std::size_t>(face)].width;
        Box box;
        for (const V3d& d : directions)
            if (d.dot(cube.layout().forward(face)) > kLeastDepth)
                box.add((cube.coordinates_on(face, d) + V2d(1, 1)) * half);
        return box;
    }

    template <class P>
    Box box_of(const P& shape, const std::vector<V3d>& directions) const {
        constexpr bool kLatLong = std::is_same_v<P, LatLong>;
        const double width = out_.size.width, height = out_.size.height;
        Box box;
        double first_x = 0;
        V3d sum(0, 0, 0);
        for (const V3d& d : directions) {
            const auto position = shape.to_position(d);
            if (!position) continue;
            V2d at(position->x * width, position->y * height);
            if (kLatLong) {  // round the short way, from the first one
                if (box.empty()) first_x = at.x;
                at.x -= width * std::round((at.x - first_x) / width);
            }
            box.add(at);
            sum += d;
        }
        if (kLatLong && !box.empty()) widen_at_poles(sum.normalized(), directions, box);
        return box;
    }

    /// Near a pole of a lat-long all columns show the spot, and all rows up to the pole.
    void widen_at_poles(V3d middle, const std::vector<V3d>& directions, Box& box) const {
        double radius = 0;
        for (const V3d& d : directions) radius = std::max(radius, (d - middle).length());
        // 2: beyond that distance the spot spans 60 degrees of longitude
        if (std::hypot(middle.x, middle.z) > 2 * radius) return;
        box.left = 0;
        box.right = out_.size.width;
        if (middle.y > 0)
            box.top = 0;
        else
            box.bottom = out_.size.height;
    }

    void add(std::size_t cell, const Box& box, std::vector<Rectangle>& to) const {
        if (box.empty()) return;
        const int width = cells_[cell].width, height = cells_[cell].height;
        // Between the places that were looked up, curves go a bit beyond them; and a pixel's taps
        // beyond the pixel, where they follow straight lines.
        const auto margin = [](double low, double high) { return 1 + 0.1 * (high - low); };
        const double across = margin(box.left, box.right), down = margin(box.top, box.bottom);
        const int y0 = std::max(0, static_cast<int>(std::floor(box.top - down))),
                  y1 = std::min(height, static_cast<int>(std::ceil(box.bottom + down)));
        int x0 = static_cast<int>(std::floor(box.left - across)),
            x1 = static_cast<int>(std::ceil(box.right + across));
        if (std::holds_alternative<LatLong>(layout_.projection)) {
            if (x1 - x0 >= width) {
                x0 = 0, x1 = width;
            } else if (x0 < 0) {
                to.push_back({cell, x0 + width, y0, width, y1});
            } else if (x1 > width) {
                to.push_back({cell, 0, y0, x1 - width, y1});
            }
        }
        x0 = std::max(0, x0), x1 = std::min(width, x1);
        if (x0 < x1 && y0 < y1) to.push_back({cell, x0, y0, x1, y1});
    }

    const Source& source_;
    const Layout& layout_;
    const kernel::Job& job_;
    std::vector<Cell> cells_;
    ImageView<float> out_;
    const Rotation& rotation_;
};

}  // namespace

void keep_light(const Source& source, const Layout& layout, const Plan& plan, ImageView<float> out,
                const Rotation& rotation, const Watch& watch) {
    const std::vector<Spot> spots = spots_of(source);
    if (spots.empty()) return;
    const Keeper keeper(source, layout, plan, out, rotation);
    std::vector<std::vector<Addition>> additions(spots.size());
    constexpr int kGrain = 8;
    for_each_band(static_cast<int>(spots.size()), kGrain,
                  [&](int first, int last) {
                      for (int i = first; i < last; ++i)
                          additions[static_cast<std::size_t>(i)] =
                              keeper.additions(spots[static_cast<std::size_t>(i)]);
                  },
                  {watch.stop, nullptr});
    // One after the other: a pixel may show several, and sums of floats depend on their order.
    for (const auto& spot : additions)
        for (const Addition& a : spot)
            for (int c = 0; c < 3; ++c) a.pixel[c] += a.color[c];
}

}  // namespace chromeball
