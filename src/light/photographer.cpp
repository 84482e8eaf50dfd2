#include "light/photographer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "light/view.h"

namespace chromeball {
namespace {

using std::numbers::pi;
constexpr double kDegree = pi / 180;

// Stops by which views must differ. Edges that are a little off, and light drawn out at the rim,
// are allowed for by comparing with all that the other view shows near by.
constexpr float kSurely = 0.5F, kPerhaps = 0.2F;
/// Beyond that from the camera nobody is a photographer.
constexpr double kFarthest = 75 * kDegree;
/// How far off each other views may be.
constexpr double kSlack = 0.35 * kDegree;

/// So near to its camera a view shows that camera, if it shows anyone.
constexpr double kCamera = 20 * kDegree;
/// A view less confident than that cannot say anything against another one.
constexpr float kWitness = 0.03F;
/// And one that is less confident than that, as it shows the place at its very rim drawn out over
/// degrees, cannot say that nobody is there.
constexpr float kAlibi = 0.08F;
/// So much of a photographer must be seen surely, before the rest is guessed: steradians, within an
/// angle from the camera.
constexpr double kSeen = 0.002, kSeenWithin = 45 * kDegree;
/// Steps over cells around which views are compared.
constexpr std::array kSteps{2, 4, 8, 16};

/// What a view shows in log2, and the range of that around every cell, for some radii.
struct Ranges {
    std::array<CellValues, 3> value;
    struct Around {
        int steps;
        std::array<CellValues, 3> low, high;
    };
    std::array<Around, kSteps.size()> around;
};

Ranges ranges_of(const ViewCube& cube, const CubeView& view, float median) {
    constexpr float kNoise = 0.03F;  // of the median: darker than that is dark
    Ranges ranges;
    for (std::size_t c = 0; c < 3; ++c) {
        CellValues& values = ranges.value[c];
        values.resize(cube.cells());
        CellValues low(cube.cells()), high(cube.cells());
        const float* p = view.light.row(0);
        for (std::size_t i = 0; i < cube.cells(); ++i, p += 4) {
            const bool shown = p[3] > 0.5F;
            values[i] = shown ? std::log2(std::max(p[c] / p[3], 0.0F) / median + kNoise) : 0;
            low[i] = shown ? values[i] : 1e9F;
            high[i] = shown ? values[i] : -1e9F;
        }
        int done = 0;
        for (std::size_t k = 0; k < kSteps.size(); ++k) {
            low = narrowed(cube, std::move(low), kSteps[k] - done);
            high = widened(cube, std::move(high), kSteps[k] - done);
            done = kSteps[k];
            ranges.around[k].steps = done;
            ranges.around[k].low[c] = low;
            ranges.around[k].high[c] = high;
        }
    }
    return ranges;
}

/// The angle between a direction and a view's camera; pi where that is not known.
double from_camera(const ViewCube& cube, const CubeView& view, std::size_t cell) {
    if (!view.camera) return pi;
    return std::acos(std::clamp(cube.direction(cell).dot(*view.camera), -1.0, 1.0));
}

/// By how many stops a lies outside of what b shows near by.
float beyond(const Ranges& a, const Ranges& b, std::size_t radius, std::size_t cell) {
    float most = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const float value = a.value[c][cell];
        most = std::max(
            {most, b.around[radius].low[c][cell] - value, value - b.around[radius].high[c][cell]});
    }
    return most;
}

/// Where two views disagree, stops; 0 where one of them shows nothing.
CellValues disagreement(const ViewCube& cube, const CubeView& a, const CubeView& b,
                        const Ranges& in_a, const Ranges& in_b) {
    CellValues result(cube.cells());
    const double finest = std::min(a.pixel, b.pixel);
    for_each_band(static_cast<int>(cube.cells()), 4096, [&](int first, int last) {
        for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
            const float least = std::min(a.confidence[i], b.confidence[i]);
            if (!(least > kWitness)) continue;
            // The coarser pixel of both, as far as confidence tells.
            const double reach = kSlack + 1.5 * finest / static_cast<double>(least);
            std::size_t radius = 0;
            while (radius + 1 < kSteps.size() && kSteps[radius] * cube.cell_angle() < reach)
                ++radius;
            result[i] = std::max(beyond(in_a, in_b, radius, i), beyond(in_b, in_a, radius, i));
        }
    });
    return blurred(cube, std::move(result), 4);
}

/// What is marked, and what is joined to it through cells that `joins(cell)` tells.
template <class Joins>
CellValues grown(const ViewCube& cube, CellValues marked, const Joins& joins) {
    std::vector<std::uint32_t> front;
    for (std::size_t i = 0; i < marked.size(); ++i)
        if (marked[i] > 0) front.push_back(static_cast<std::uint32_t>(i));
    while (!front.empty()) {
        const std::uint32_t i = front.back();
        front.pop_back();
        for (const std::uint32_t n : cube.neighbours(i))
            if (marked[n] == 0 && joins(n)) {
                marked[n] = 1;
                front.push_back(n);
            }
    }
    return marked;
}

/// Holes, and gaps between parts, closed by that many steps; then a margin of that many radians,
/// soft at its edge.
CellValues with_margin(const ViewCube& cube, CellValues mask, int close, double margin) {
    mask = narrowed(cube, widened(cube, std::move(mask), close), close);
    const int steps = static_cast<int>(std::ceil(margin / cube.cell_angle()));
    return blurred(cube, widened(cube, std::move(mask), steps), 4);
}

/// Colours counted in bins of half a stop of brightness and a third of a stop of tint.
class Palette {
public:
    /// Weight 0 leaves a colour out.
    void add(const float* light, float weight) {
        if (!(light[3] > 0.5F) || !(weight > 0)) return;
        counts_[bin(light)] += weight;
        total_ += weight;
    }
    /// A probability a bin, of colours as far away as a few bins too.
    void smooth() {
        for (int axis = 0; axis < 3; ++axis)
            for (int round = 0; round < 2; ++round) {
                const auto before = counts_;
                const int stride = axis == 0 ? 1 : axis == 1 ? kBins : kBins * kBins;
                for (int i = 0; i < kBins * kBins * kBins; ++i) {
                    const int at = i / stride % kBins;
                    const auto count = [&](int step) {
                        return before[static_cast<std::size_t>(i + step * stride)];
                    };
                    counts_[static_cast<std::size_t>(i)] =
                        0.5F * count(0) +
                        0.25F * (count(at > 0 ? -1 : 0) + count(at + 1 < kBins ? 1 : 0));
                }
            }
        for (float& count : counts_) count /= std::max(total_, 1e-6F);
    }
    float probability(const float* light) const { return counts_[bin(light)]; }

private:
    static constexpr int kBins = 32;
    static std::size_t bin(const float* light) {
        const auto log = [&](int c) { return std::log2(std::max(light[c] / light[3], 1e-6F)); };
        const auto index = [](float value, float step) {
            return static_cast<std::size_t>(
                std::clamp(static_cast<int>(std::floor(value / step)) + kBins / 2, 0, kBins - 1));
        };
        const float green = log(1);
        return (index(log(0) - green, 0.33F) * kBins + index(log(2) - green, 0.33F)) * kBins +
               index(green, 0.5F);
    }
    std::vector<float> counts_ = std::vector<float>(kBins * kBins * kBins);
    float total_ = 0;
};

/// Whom one view alone seems to show, without a margin.
CellValues guessed(const ViewCube& cube, const CubeView& view) {
    CellValues mask(cube.cells());
    if (!view.camera) return mask;
    // Degrees to the right of the camera and above it, as the view sees them.
    const Rotation to_view = view.to_world.inverse();
    const V3d camera = to_view * *view.camera;
    const double turn = std::atan2(camera.x, camera.z), lift = std::asin(camera.y);
    struct Place {
        double right, up;
    };
    const auto place = [&](std::size_t cell) {
        const V3d d = to_view * cube.direction(cell);
        return Place{std::remainder(std::atan2(d.x, d.z) - turn, 2 * pi) / kDegree,
                     (std::asin(std::clamp(d.y, -1.0, 1.0)) - lift) / kDegree};
    };
    // Who holds a camera stands behind it: head near by, feet far below, arms and tripod beside.
    const auto likely = [](Place p) {
        const double across = p.right / (p.up < 0 ? 11 : 8);
        const double along = p.up > 0 ? p.up / 11 : p.up / 38;
        return std::exp(-0.5 * (across * across + along * along));
    };
    // A hundredth of the sphere that surely is not, weighed evenly; and what surely is.
    Palette person, around;
    const float* light = view.light.row(0);
    for (std::size_t cell = 0; cell < cube.cells(); ++cell) {
        const Place p = place(cell);
        const auto area = static_cast<float>(cube.solid_angle(cell));
        const bool inner = std::abs(p.right) < 3 && p.up < 3 && p.up > -18;
        const bool ring = std::abs(p.right) < 60 && p.up < 45 && p.up > -70 &&
                          (std::abs(p.right) > 26 || p.up > 24);
        if (inner) person.add(light + 4 * cell, area);
        if (ring) around.add(light + 4 * cell, area);
    }
    person.smooth();
    around.smooth();
    CellValues odds(cube.cells());
    for (std::size_t cell = 0; cell < cube.cells(); ++cell) {
        const double prior = 0.9 * likely(place(cell));
        if (!(light[4 * cell + 3] > 0.5F) || prior < 0.02) continue;
        constexpr double kUnknown = 1e-4;  // a colour seen in neither
        const double is = static_cast<double>(person.probability(light + 4 * cell)) + kUnknown;
        const double is_not = static_cast<double>(around.probability(light + 4 * cell)) + kUnknown;
        odds[cell] = static_cast<float>(prior * is / (prior * is + (1 - prior) * is_not));
    }
    odds = blurred(cube, std::move(odds), 3);
    // From the middle outwards.
    constexpr float kJoined = 0.3F;
    for (std::size_t cell = 0; cell < cube.cells(); ++cell) {
        const Place p = place(cell);
        if (std::abs(p.right) < 2 && p.up < 2 && p.up > -12 && odds[cell] > 0.5F) mask[cell] = 1;
    }
    return grown(cube, std::move(mask), [&](std::size_t cell) { return odds[cell] > kJoined; });
}

/// What speaks against a view, a cell.
struct Blame {
    CellValues stops;           ///< by how much others differ from it
    std::vector<bool> allowed;  ///< whether any may say so
    std::vector<bool> unseen;   ///< near its camera, and no other view shows it well
};

/// differ: two views' disagreement.
Blame blame_of(const ViewCube& cube, const std::vector<CubeView>& views, std::size_t accused,
               const std::vector<std::vector<CellValues>>& differ) {
    const std::size_t count = views.size(), cells = cube.cells();
    Blame blame{CellValues(cells), std::vector<bool>(cells), std::vector<bool>(cells)};
    for (std::size_t cell = 0; cell < cells; ++cell) {
        const double angle = from_camera(cube, views[accused], cell);
        if (angle > kFarthest) continue;
        bool witness = false;
        for (std::size_t j = 0; j < count; ++j) {
            if (j == accused || from_camera(cube, views[j], cell) <= angle) continue;
            if (views[j].confidence[cell] > kAlibi) witness = true;
            // A third view that shows the same as this one, and not what the other does.
            bool defended = false;
            for (std::size_t k = 0; k < count; ++k)
                defended = defended ||
                           (k != accused && k != j &&
                            std::min(views[k].confidence[cell], views[accused].confidence[cell]) >
                                kWitness &&
                            from_camera(cube, views[k], cell) > angle &&
                            differ[accused][k][cell] < kPerhaps && differ[j][k][cell] > kPerhaps);
            if (defended) continue;
            blame.allowed[cell] = true;
            blame.stops[cell] = std::max(blame.stops[cell], differ[accused][j][cell]);
        }
        blame.unseen[cell] = !witness && angle < kCamera;
    }
    return blame;
}

/// Whom a view shows, without a margin.
CellValues blamed_person(const ViewCube& cube, const CubeView& view, const Blame& blame) {
    const std::size_t cells = cube.cells();
    CellValues surely(cells);
    double seen = 0;
    for (std::size_t cell = 0; cell < cells; ++cell) {
        surely[cell] = blame.allowed[cell] && blame.stops[cell] >= kSurely ? 1 : 0;
        if (surely[cell] > 0 && from_camera(cube, view, cell) < kSeenWithin)
            seen += cube.solid_angle(cell);
    }
    // Behind him, as views from opposite sides show it, nobody sees sharply: there he is known by
    // his colours alone, and what lies beside him had better stay as his own view shows it.
    if (seen > kSeen && std::ranges::find(blame.unseen, true) != blame.unseen.end()) {
        const int mixed = static_cast<int>(std::ceil(0.8 * view.pixel / cube.cell_angle()));
        const CellValues guess = widened(cube, guessed(cube, view), mixed);
        for (std::size_t cell = 0; cell < cells; ++cell)
            if (blame.unseen[cell] && guess[cell] > 0) surely[cell] = 1;
    }
    return grown(cube, std::move(surely), [&](std::size_t cell) {
        return blame.allowed[cell] && blame.stops[cell] >= kPerhaps;
    });
}

}  // namespace

std::vector<CellValues> photographers(const ViewCube& cube, const std::vector<CubeView>& views) {
    const std::size_t count = views.size();
    std::vector<CellValues> masks(count, CellValues(cube.cells()));
    const float median = median_light(views.front().light);
    std::vector<Ranges> ranges;
    for (const CubeView& view : views) ranges.push_back(ranges_of(cube, view, median));
    std::vector<std::vector<CellValues>> differ(count, std::vector<CellValues>(count));
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j) {
            differ[i][j] = disagreement(cube, views[i], views[j], ranges[i], ranges[j]);
            differ[j][i] = differ[i][j];
        }
    for (std::size_t i = 0; i < count; ++i)
        if (views[i].camera)
            masks[i] =
                with_margin(cube, blamed_person(cube, views[i], blame_of(cube, views, i, differ)),
                            5, 1.2 * kDegree);
    return masks;
}

CellValues lone_photographer(const ViewCube& cube, const CubeView& view) {
    return with_margin(cube, guessed(cube, view), 8, 2 * kDegree);
}

}  // namespace chromeball
