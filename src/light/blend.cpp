#include "light/blend.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/statistics.h"
#include "light/confidence.h"
#include "light/fill.h"
#include "light/photographer.h"

namespace chromeball {
namespace {

using Gain = std::array<double, 3>;

/// Cells across a face: 0.45 degrees in its middle.
constexpr int kCube = 256;

/// A blend of brightness: cells across a face in which it is smooth, and how sharply the more
/// confident view wins there (confidence to that power).
struct Band {
    int size;
    float power;
};
constexpr std::array kBands{Band{8, 8}, Band{16, 16}, Band{32, 32}};
/// The same for what is left, the detail: over some 5 degrees between balls seen from two sides.
constexpr float kDetailPower = 128;

/// Factors that make views as bright as the first one, from medians of ratios in every overlap,
/// reconciled by least squares in stops.
std::vector<Gain> matched_gains(const std::vector<CubeView>& views) {
    const auto count = static_cast<Eigen::Index>(views.size());
    std::vector<Gain> gains(views.size(), Gain{1, 1, 1});
    const std::size_t cells = views.front().confidence.size();
    for (std::size_t c = 0; c < 3; ++c) {
        Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
        normal(0, 0) = 1e6;  // the first one stays
        for (Eigen::Index i = 1; i < count; ++i) normal(i, i) = 1e-6;
        for (std::size_t i = 0; i < views.size(); ++i)
            for (std::size_t j = i + 1; j < views.size(); ++j) {
                std::vector<double> stops;
                for (std::size_t cell = 0; cell < cells; ++cell) {
                    constexpr float kGood = 0.3F;
                    if (std::min(views[i].confidence[cell], views[j].confidence[cell]) < kGood)
                        continue;
                    const float* p = views[i].light.row(0) + 4 * cell;
                    const float* q = views[j].light.row(0) + 4 * cell;
                    if (p[c] > 0 && q[c] > 0)
                        stops.push_back(std::log2(p[c] * q[3] / (q[c] * p[3])));
                }
                if (stops.size() < 100) continue;
                const auto weight = static_cast<double>(stops.size());
                const double difference = median(std::move(stops));  // log i - log j
                const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
                normal(a, a) += weight;
                normal(b, b) += weight;
                normal(a, b) -= weight;
                normal(b, a) -= weight;
                right[a] -= weight * difference;
                right[b] += weight * difference;
            }
        const Eigen::VectorXd solved = normal.ldlt().solve(right);
        for (std::size_t i = 0; i < views.size(); ++i)
            gains[i][c] = std::exp2(solved[static_cast<Eigen::Index>(i)] - solved[0]);
    }
    return gains;
}

void multiply(Image& picture, const Gain& gain) {
    float* p = picture.row(0);
    for (std::size_t i = 0; i < picture.size().pixels(); ++i, p += 4)
        for (std::size_t c = 0; c < 3; ++c) p[c] *= static_cast<float>(gain[c]);
}

/// What each view counts for, in sum 1 where any is believed, else 0.
std::vector<CellValues> shares(const std::vector<CubeView>& views, float power) {
    const std::size_t cells = views.front().confidence.size();
    std::vector<CellValues> all(views.size(), CellValues(cells));
    for_each_band(static_cast<int>(cells), 4096, [&](int first, int last) {
        for (auto cell = static_cast<std::size_t>(first); cell < static_cast<std::size_t>(last);
             ++cell) {
            float most = 0, sum = 0;
            for (const CubeView& view : views) most = std::max(most, view.confidence[cell]);
            constexpr float kLeast = 1e-6F;  // at the edge of the hidden cone it goes to 0
            if (!(most > kLeast)) continue;
            for (std::size_t i = 0; i < views.size(); ++i) {
                all[i][cell] = std::pow(views[i].confidence[cell] / most, power);
                sum += all[i][cell];
            }
            for (CellValues& share : all) share[cell] /= sum;
        }
    });
    return all;
}

/// Shares also in cells that a view does not show, from their neighbours: where exactly it ends its
/// own alpha knows better than cells do. What it shows and is not to be used stays without.
void extend(const ViewCube& cube, const std::vector<CubeView>& views,
            std::vector<CellValues>& share) {
    std::vector<char> known(cube.cells());
    std::vector<std::uint32_t> front;
    for (std::size_t cell = 0; cell < cube.cells(); ++cell)
        for (const CellValues& one : share)
            if (one[cell] > 0) known[cell] = 1;
    const auto add_unknown_neighbours = [&](std::size_t cell, std::vector<std::uint32_t>& to) {
        for (const std::uint32_t n : cube.neighbours(cell))
            if (!known[n]) to.push_back(n);
    };
    for (std::size_t cell = 0; cell < cube.cells(); ++cell)
        if (known[cell]) add_unknown_neighbours(cell, front);
    while (!front.empty()) {
        std::sort(front.begin(), front.end());
        front.erase(std::unique(front.begin(), front.end()), front.end());
        std::vector<std::uint32_t> reached, next;
        for (const std::uint32_t cell : front) {
            float around = 0, taken = 0;
            for (const std::uint32_t n : cube.neighbours(cell)) around += known[n] ? 1.0F : 0.0F;
            for (std::size_t i = 0; i < share.size(); ++i) {
                if (views[i].light.row(0)[4 * static_cast<std::size_t>(cell) + 3] > 0.99F) continue;
                for (const std::uint32_t n : cube.neighbours(cell))
                    if (known[n]) share[i][cell] += share[i][n] / around;
                taken += share[i][cell];
            }
            if (taken > 0) reached.push_back(cell);
        }
        for (const std::uint32_t cell : reached) known[cell] = 1;
        for (const std::uint32_t cell : reached) add_unknown_neighbours(cell, next);
        front = std::move(next);
    }
}

/// Stops by which views are brightened or darkened so that they agree in the large: pictures of the
/// cube, one a view, smooth. In every band views are drawn towards their mean.
std::vector<Image> levelled(const ViewCube& cube, const std::vector<CubeView>& views) {
    const Size picture = cube.layout().picture(cube.size());
    std::vector<Image> stops(views.size());
    for (Image& one : stops) one = Image(picture, 4);
    std::vector<Image> logs(views.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
        logs[i] = Image(picture, 4);
        const float* p = views[i].light.row(0);
        float* to = logs[i].row(0);
        for (std::size_t cell = 0; cell < cube.cells(); ++cell, p += 4, to += 4) {
            if (!(views[i].confidence[cell] > 0.05F)) continue;
            if (!(std::min({p[0], p[1], p[2]}) > 0)) continue;
            for (int c = 0; c < 3; ++c) to[c] = std::log2(p[c] / p[3]);
            to[3] = 1;
        }
    }
    for (const Band& band : kBands) {
        const auto share = shares(views, band.power);
        std::vector<Image> corrections;
        for (std::size_t i = 0; i < views.size(); ++i) {
            Image off(picture, 4);  // stops to the mean, where two views can be compared
            for (std::size_t cell = 0; cell < cube.cells(); ++cell) {
                float total = 0, mean[3] = {};
                int known = 0;
                const std::size_t at = 4 * cell;
                if (logs[i].row(0)[at + 3] == 0) continue;
                for (std::size_t j = 0; j < views.size(); ++j) {
                    if (logs[j].row(0)[at + 3] == 0) continue;
                    ++known;
                    total += share[j][cell];
                    for (std::size_t c = 0; c < 3; ++c)
                        mean[c] +=
                            share[j][cell] * (logs[j].row(0)[at + c] + stops[j].row(0)[at + c]);
                }
                if (known < 2 || !(total > 0.5F)) continue;
                float* to = off.row(0) + at;
                float most = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    to[c] = mean[c] / total - logs[i].row(0)[at + c] - stops[i].row(0)[at + c];
                    most = std::max(most, std::abs(to[c]));
                }
                // More is no difference in brightness but something else to be seen.
                constexpr float kMost = 0.5F;
                const float tukey = std::max(0.0F, 1 - most * most / (kMost * kMost));
                to[3] = tukey * tukey;
                for (std::size_t c = 0; c < 3; ++c) to[c] *= to[3];
            }
            Image coarse = resized(off, band.size);
            float* p = coarse.row(0);
            for (std::size_t k = 0; k < coarse.size().pixels(); ++k, p += 4) {
                constexpr float kEnough = 0.1F;
                for (int c = 0; c < 3; ++c) p[c] = p[3] > kEnough ? p[c] / p[3] : 0;
                p[3] = p[3] > kEnough ? 1 : 0;
            }
            fill_gaps(coarse);
            p = coarse.row(0);
            for (std::size_t k = 0; k < coarse.size().pixels(); ++k, p += 4) p[3] = 1;
            corrections.push_back(resized(coarse, cube.size()));
        }
        for (std::size_t i = 0; i < views.size(); ++i)
            for (std::size_t cell = 0; cell < cube.cells(); ++cell)
                for (std::size_t c = 0; c < 3; ++c)
                    stops[i].row(0)[4 * cell + c] += corrections[i].row(0)[4 * cell + c];
    }
    for (Image& one : stops) {
        float* p = one.row(0);
        for (std::size_t k = 0; k < cube.cells(); ++k, p += 4) p[3] = 1;
    }
    return stops;
}

/// Cell values as the red channel of a picture.
Image picture_of(const ViewCube& cube, const CellValues& values) {
    Image picture(cube.layout().picture(cube.size()), 4);
    float* p = picture.row(0);
    for (std::size_t i = 0; i < values.size(); ++i, p += 4) {
        p[0] = values[i];
        p[3] = 1;
    }
    return picture;
}

/// From the cube, smooth in between, to the output.
class ToOutput {
public:
    ToOutput(const ViewCube& cube, const Layout& layout, int size, const Rotation& to_output)
        : cube_(cube), layout_(layout), size_(size) {
        how_.rotation = to_output;
        how_.keeps_light = false;  // shares and stops are no light
    }
    Image operator()(const Image& picture) const {
        return resample(map_source(picture, cube_.layout()), layout_, size_, how_);
    }
    Image operator()(const CellValues& values) const { return (*this)(picture_of(cube_, values)); }

private:
    const ViewCube& cube_;
    const Layout& layout_;
    int size_;
    ResampleOptions how_;
};

template <class Work>
void for_each_row(const Image& image, const Work& work) {
    for_each_band(image.height(), 16, [&](int first, int last) {
        for (int y = first; y < last; ++y) work(y);
    });
}

/// Colours over the whole sphere: the blend on the cube, its gaps filled. In log light, so that a
/// lamp at a gap's edge does not flood it.
Image filled_cube(const ViewCube& cube, const std::vector<CubeView>& views,
                  const std::vector<Image>& stops, const std::vector<CellValues>& share) {
    Image picture(cube.layout().picture(cube.size()), 4);
    constexpr float kDark = 1e-6F;
    for (std::size_t cell = 0; cell < cube.cells(); ++cell) {
        float* to = picture.row(0) + 4 * cell;
        float total = 0;
        for (std::size_t i = 0; i < views.size(); ++i) {
            const float* p = views[i].light.row(0) + 4 * cell;
            if (!(share[i][cell] > 0) || !(p[3] > 0)) continue;
            total += share[i][cell];
            for (std::size_t c = 0; c < 3; ++c)
                to[c] += share[i][cell] * p[c] / p[3] * std::exp2(stops[i].row(0)[4 * cell + c]);
        }
        if (!(total > 0.5F)) {
            std::fill_n(to, 4, 0.0F);
            continue;
        }
        for (int c = 0; c < 3; ++c) to[c] = std::log2(std::max(to[c] / total, kDark));
        to[3] = 1;
    }
    fill_gaps(picture);
    for (std::size_t cell = 0; cell < cube.cells(); ++cell) {
        float* to = picture.row(0) + 4 * cell;
        for (int c = 0; c < 3; ++c) to[c] = std::exp2(to[c]);
        to[3] = 1;
    }
    return picture;
}

std::vector<CubeView> cube_views(const ViewCube& cube, const std::vector<PlacedView>& views,
                                 const Watch& watch) {
    double finest = 10;
    for (const PlacedView& placed : views)
        finest = std::min(finest, finest_pixel(placed.view.source));
    std::vector<CubeView> result;
    for (const PlacedView& placed : views) {
        CubeView view;
        ResampleOptions how;
        how.rotation = placed.to_world;
        view.light = resample(placed.view.source, cube.layout(), cube.size(), how);
        watch.check();
        const Rotation to_camera = placed.to_world.inverse();
        std::vector<V3d> directions(cube.cells());
        for (std::size_t i = 0; i < cube.cells(); ++i)
            directions[i] = to_camera * cube.direction(i);
        view.confidence.resize(cube.cells());
        confidence(placed.view, finest, directions, view.confidence);
        for (std::size_t i = 0; i < cube.cells(); ++i)
            if (!(view.light.row(0)[4 * i + 3] > 0.5F)) view.confidence[i] = 0;
        if (placed.camera) view.camera = placed.to_world * *placed.camera;
        view.pixel = finest_pixel(placed.view.source);
        view.to_world = placed.to_world;
        result.push_back(std::move(view));
        watch.check();
    }
    return result;
}

/// The first channel of a picture, where a map has alpha.
Image confidence_where_shown(const Image& picture, const Image& map) {
    Image confidence(map.size(), 1);
    for_each_row(map, [&](int y) {
        for (int x = 0; x < map.width(); ++x)
            confidence.pixel(x, y)[0] =
                map.pixel(x, y)[3] > 0 ? std::clamp(picture.pixel(x, y)[0], 0.0F, 1.0F) : 0;
    });
    return confidence;
}

}  // namespace

Image confidence_of(const PlacedView& view, const Image& map, const Layout& layout,
                    const Rotation& to_output, const Watch& watch) {
    const ViewCube cube(kCube);
    const auto seen = cube_views(cube, {view}, watch);
    const int size = map.width() / layout.width_units;
    const ToOutput drawn(cube, layout, size, to_output);
    return confidence_where_shown(drawn(seen.front().confidence), map);
}

Image confidence_of(const Source& confidence, const Image& map, const Layout& layout,
                    const ResampleOptions& how, const Watch& watch) {
    const int size = map.width() / layout.width_units;
    ResampleOptions plain = how;
    plain.keeps_light = false;
    return confidence_where_shown(resample(confidence, layout, size, plain, watch), map);
}

Blended blend(const std::vector<PlacedView>& views, const Layout& layout, int size,
              const BlendOptions& options, const Watch& watch) {
    const ViewCube cube(kCube);
    auto seen = cube_views(cube, views, watch);
    Blended result;
    result.gains = matched_gains(seen);
    for (std::size_t i = 0; i < seen.size(); ++i) multiply(seen[i].light, result.gains[i]);
    auto masks = photographers(cube, seen);
    if (options.lone_photographer && seen.size() == 1)
        masks.front() = lone_photographer(cube, seen.front());
    for (std::size_t i = 0; i < seen.size(); ++i)
        for (std::size_t cell = 0; cell < cube.cells(); ++cell)
            seen[i].confidence[cell] *= 1 - masks[i][cell];
    watch.check();
    const auto stops = levelled(cube, seen);
    auto share = shares(seen, kDetailPower);
    extend(cube, seen, share);
    watch.check();

    const ToOutput to_output(cube, layout, size, options.to_output);
    result.map = Image(layout.picture(size), 4);
    Image& map = result.map;
    for (std::size_t i = 0; i < views.size(); ++i) {
        ResampleOptions how;
        how.filter = options.filter;
        how.rotation = options.to_output * views[i].to_world;
        const Image light = resample(views[i].view.source, layout, size, how, watch);
        const Image weights = to_output(share[i]);
        const Image levels = to_output(stops[i]);
        for_each_row(map, [&](int y) {
            for (int x = 0; x < map.width(); ++x) {
                const float* p = light.pixel(x, y);
                const float w = std::clamp(weights.pixel(x, y)[0], 0.0F, 1.0F);
                if (!(w > 0) || !(p[3] > 0)) continue;
                float* to = map.pixel(x, y);
                for (std::size_t c = 0; c < 3; ++c)
                    to[c] += w * p[c] * static_cast<float>(result.gains[i][c]) *
                             std::exp2(levels.pixel(x, y)[c]);
                to[3] += w * p[3];
            }
        });
        watch.check();
    }
    for (std::size_t cell = 0; cell < cube.cells(); ++cell) {
        float total = 0;
        for (std::size_t i = 0; i < views.size(); ++i)
            total += share[i][cell] * seen[i].light.row(0)[4 * cell + 3];
        result.covered += static_cast<double>(total) * cube.solid_angle(cell);
    }
    result.covered = std::min(1.0, result.covered / (4 * std::numbers::pi));

    if (options.confidence) {
        CellValues believed(cube.cells());
        for (std::size_t i = 0; i < views.size(); ++i)
            for (std::size_t cell = 0; cell < cube.cells(); ++cell)
                believed[cell] += share[i][cell] * seen[i].confidence[cell];
        result.confidence = confidence_where_shown(to_output(believed), map);
    }
    if (!options.fill) {
        for_each_row(map, [&](int y) {
            for (int x = 0; x < map.width(); ++x) {
                float* p = map.pixel(x, y);
                if (p[3] > 1)
                    for (int c = 3; c >= 0; --c) p[c] /= p[3];
            }
        });
        return result;
    }
    const Image around = to_output(filled_cube(cube, seen, stops, share));
    for_each_row(map, [&](int y) {
        for (int x = 0; x < map.width(); ++x) {
            float* p = map.pixel(x, y);
            const float* q = around.pixel(x, y);
            if (!(q[3] > 0)) continue;  // outside of the layout's directions
            const bool shown = p[3] >= 0.5F;
            // A pixel that is seen in part gets the rest from around.
            const float rest = std::max(0.0F, 1 - p[3]), scale = 1 / std::max(p[3] + rest, 1.0F);
            for (int c = 0; c < 3; ++c) p[c] = (p[c] + rest * q[c] / q[3]) * scale;
            p[3] = shown ? 1 : 0;
        }
    });
    return result;
}

}  // namespace chromeball
