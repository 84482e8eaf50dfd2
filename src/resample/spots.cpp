#include "resample/spots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "resample/copies.h"
#include "resample/filter.h"
#include "resample/mean_over_square.h"

namespace chromeball {
namespace {

using std::numbers::pi;

/// A pixel of the prepared picture.
struct Place {
    int x = 0, y = 0;
};

constexpr int kBandRows = 32;
/// How far a cubic tap looks, in whole pixels.
constexpr int kReach = 2;

/// Of a pixel's light in that row, over that of a pixel of mean solid angle. In a lat-long it
/// follows from the row; elsewhere it differs too little to matter for what counts as bright.
double weight_of_row(const Source& source, int y) {
    if (!std::holds_alternative<LatLong>(source.projection)) return 1;
    const int height = source.pixels.height() - 2 * source.border;
    return 0.5 * pi * std::cos(pi * (0.5 - (y - source.border + 0.5) / height));
}

/// Whether a pixel's light is shown by that pixel alone.
class ShownAlone {
public:
    explicit ShownAlone(const Source& source) : source_(source) {
        if (source.ball) rows_ = EllipseRows(*source.ball);
    }

    bool operator()(int x, int y) const {
        const Image& pixels = source_.pixels;
        if (std::holds_alternative<Angular>(source_.projection)) {
            constexpr double kEdge = 4;  // what the edge cuts, and the pixels drawn from there
            const double middle = 0.5 * pixels.width();
            return std::hypot(x + 0.5 - middle, y + 0.5 - middle) < middle - source_.border - kEdge;
        }
        if (!source_.ball) return true;
        const int margin = kReach + source_.border;
        if (x < margin || y < margin || x >= pixels.width() - margin ||
            y >= pixels.height() - margin)
            return false;
        // 1.5: to the middles of the diagonal neighbours, where the last taps are that see it
        if (rows_.at(x + 0.5, y + 0.5).depth() < source_.rim.last_depth() + 1.5) return false;
        for (int j = -kReach; j <= kReach; ++j)
            for (int i = -kReach; i <= kReach; ++i)
                if (!(pixels.pixel(x + i, y + j)[3] > filter::kPure)) return false;
        return true;
    }

private:
    const Source& source_;
    EllipseRows rows_;
};

/// From what on a pixel, in any channel, outshines the rest.
std::array<double, 3> limits(const Source& source) {
    std::array<double, 3> limits{};
    for (std::size_t y = 0; y < source.lights.size(); ++y)
        for (std::size_t c = 0; c < 3; ++c)
            limits[c] += weight_of_row(source, static_cast<int>(y)) *
                         static_cast<double>(source.lights[y].sum[c]);
    const double pixels = 4 * pi / source.mean_solid_angle;
    for (double& limit : limits)
        limit *= std::max(spots::kLeastShare, spots::kLeastExcess / pixels);
    return limits;
}

std::vector<Place> bright_pixels(const Source& source) {
    const std::array<double, 3> limit = limits(source);
    const auto above = [&](const auto& values, double weight) {
        for (std::size_t c = 0; c < 3; ++c)
            if (weight * static_cast<double>(values[c]) > limit[c]) return true;
        return false;
    };
    std::vector<int> rows;
    for (int y = 0; y < static_cast<int>(source.lights.size()); ++y)
        if (above(source.lights[static_cast<std::size_t>(y)].highest, weight_of_row(source, y)))
            rows.push_back(y);
    const ShownAlone shown_alone(source);
    std::vector<std::vector<Place>> found(rows.size());
    for_each_band(static_cast<int>(rows.size()), kBandRows, [&](int first, int last) {
        for (int i = first; i < last; ++i) {
            const int y = rows[static_cast<std::size_t>(i)];
            const double weight = weight_of_row(source, y);
            for (int x = source.border; x < source.pixels.width() - source.border; ++x) {
                const float* p = source.pixels.pixel(x, y);
                if (!above(p, weight)) continue;
                const bool finite =
                    std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
                if (finite && shown_alone(x, y))
                    found[static_cast<std::size_t>(i)].push_back({x, y});
            }
        }
    });
    std::vector<Place> all;
    for (const auto& row : found) all.insert(all.end(), row.begin(), row.end());
    return all;
}

bool before(const Place& one, const Place& other) {
    return one.y != other.y ? one.y < other.y : one.x < other.x;
}

/// Groups of pixels next to each other, none wider or higher than spots::kMostAcross beside and
/// below its first pixel.
std::vector<std::vector<Place>> groups(const std::vector<Place>& places) {
    std::vector<std::vector<Place>> all;
    std::vector<bool> taken(places.size());
    const auto find = [&](Place p) {
        return static_cast<std::size_t>(std::lower_bound(places.begin(), places.end(), p, before) -
                                        places.begin());
    };
    for (std::size_t first = 0; first < places.size(); ++first) {
        if (taken[first]) continue;
        taken[first] = true;
        std::vector<Place> group{places[first]};
        for (std::size_t k = 0; k < group.size(); ++k)
            for (int dy = -1; dy <= 1; ++dy) {
                const Place left{group[k].x - 1, group[k].y + dy};
                if (left.y - places[first].y > spots::kMostAcross) continue;
                for (std::size_t i = find(left);
                     i < places.size() && places[i].y == left.y && places[i].x <= left.x + 2; ++i) {
                    if (taken[i] || std::abs(places[i].x - places[first].x) > spots::kMostAcross)
                        continue;
                    taken[i] = true;
                    group.push_back(places[i]);
                }
            }
        all.push_back(std::move(group));
    }
    return all;
}

double solid_angle_of(const Source& source, Place p) {
    const double x = p.x, y = p.y;
    const auto position = [&](V2d place) -> V2d {
        if (source.face_size == 0) return place;
        // Positions of the layout without borders.
        const double size = source.face_size, padded = size + 2 * source.border;
        const int face = static_cast<int>(p.y / padded);
        return {(place.x - source.border) / size,
                (place.y - source.border - face * 2.0 * source.border) / (6 * size)};
    };
    const bool cube = source.face_size > 0;
    const Affine from_pixels = cube ? Affine{} : source.to_pixels.inverse();
    const double area = cube ? 1 / (6.0 * source.face_size * source.face_size)
                             : std::abs(from_pixels.determinant());
    return area *
           std::visit(
               [&](const auto& projection) {
                   return mean_over_square([&](double dx, double dy) {
                       return projection.solid_angle(from_pixels(position(V2d(x + dx, y + dy))));
                   });
               },
               source.projection);
}

/// The colour around a group: the mean of the pixels next to it that are not bright themselves.
std::array<float, 3> ground_of(const Source& source, const std::vector<Place>& group,
                               const std::vector<Place>& bright) {
    std::vector<Place> around;
    for (const Place& p : group)
        for (int k = 0; k < 9; ++k) {
            const Place beside{p.x + k % 3 - 1, p.y + k / 3 - 1};
            if (!std::binary_search(bright.begin(), bright.end(), beside, before))
                around.push_back(beside);
        }
    std::sort(around.begin(), around.end(), before);
    std::array<double, 3> sum{};
    int count = 0;
    for (std::size_t i = 0; i < around.size(); ++i) {
        if (i > 0 && !before(around[i - 1], around[i])) continue;
        const float* color = source.pixels.pixel(around[i].x, around[i].y);
        if (!std::isfinite(color[0] + color[1] + color[2])) continue;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(color[c]);
        ++count;
    }
    std::array<float, 3> ground{};
    for (std::size_t c = 0; c < 3 && count > 0; ++c)
        ground[c] = static_cast<float>(std::max(0.0, sum[c] / count));
    return ground;
}

Spot spot_of(const Source& source, const std::vector<Place>& group,
             const std::vector<Place>& bright) {
    const std::array<float, 3> ground = ground_of(source, group, bright);
    Spot spot;
    spot.left = spot.right = group.front().x;
    spot.top = spot.bottom = group.front().y;
    const int stride = source.pixels.width();
    for (const Place& p : group) {
        spot.left = std::min(spot.left, p.x);
        spot.right = std::max(spot.right, p.x);
        spot.top = std::min(spot.top, p.y);
        spot.bottom = std::max(spot.bottom, p.y);
        std::array<float, 3> color{};
        for (std::size_t c = 0; c < 3; ++c)
            color[c] = std::max(0.0F, source.pixels.pixel(p.x, p.y)[c] - ground[c]);
        spot.light += V3d(color[0], color[1], color[2]) * solid_angle_of(source, p);
        spot.pixels.push_back({p.y * stride + p.x, {color[0], color[1], color[2]}});
        for (const Copy& copy : copies_of(source, p.x, p.y))
            spot.pixels.push_back(
                {copy.y * stride + copy.x,
                 {copy.part * color[0], copy.part * color[1], copy.part * color[2]}});
    }
    std::sort(spot.pixels.begin(), spot.pixels.end(),
              [](const auto& one, const auto& other) { return one.at < other.at; });
    // A pixel of a border may show several of them.
    std::size_t last = 0;
    for (std::size_t i = 1; i < spot.pixels.size(); ++i) {
        if (spot.pixels[i].at != spot.pixels[last].at) {
            spot.pixels[++last] = spot.pixels[i];
            continue;
        }
        for (int c = 0; c < 3; ++c) spot.pixels[last].color[c] += spot.pixels[i].color[c];
    }
    spot.pixels.resize(last + 1);
    return spot;
}

}  // namespace

std::vector<Spot> spots_of(const Source& source) {
    const std::vector<Place> bright = bright_pixels(source);
    const auto all = groups(bright);
    std::vector<Spot> spots(all.size());
    for_each_band(static_cast<int>(all.size()), kBandRows, [&](int first, int last) {
        for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i)
            spots[i] = spot_of(source, all[i], bright);
    });
    return spots;
}

std::optional<V3d> direction_at(const Source& source, int y, V2d place) {
    if (source.face_size > 0) {
        const int size = source.face_size, padded = size + 2 * source.border;
        const int face = y / padded;
        return std::get<Cube>(source.projection)
            .direction_on(face, 2 * (place.x - source.border) / size - 1,
                          2 * (place.y - face * padded - source.border) / size - 1);
    }
    const V2d position = source.to_pixels.inverse()(place);
    return std::visit([&](const auto& projection) { return projection.to_direction(position); },
                      source.projection);
}

}  // namespace chromeball
