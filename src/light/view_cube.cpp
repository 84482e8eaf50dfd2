#include "light/view_cube.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "resample/resample.h"

namespace chromeball {
namespace {

constexpr int kGrain = 4096;

template <class Combine>
CellValues combined(const ViewCube& cube, CellValues values, int steps, const Combine& combine) {
    CellValues next(values.size());
    for (int k = 0; k < steps; ++k) {
        for_each_band(static_cast<int>(values.size()), kGrain, [&](int first, int last) {
            for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last);
                 ++i) {
                const auto& n = cube.neighbours(i);
                next[i] =
                    combine(values[i], values[n[0]], values[n[1]], values[n[2]], values[n[3]]);
            }
        });
        values.swap(next);
    }
    return values;
}

}  // namespace

ViewCube::ViewCube(int size) : size_(size), layout_(find_layout("openexr")) {
    const Cube cube;
    const double step = 2.0 / size;
    const auto middle = [&](int i) { return (i + 0.5) * step - 1; };
    // A place beyond a face's edge lies on its neighbour.
    const auto cell_of = [&](int face, int x, int y) {
        if (x < 0 || y < 0 || x >= size || y >= size) {
            const V3d d = cube.direction_on(face, middle(x), middle(y));
            face = face_of(d);
            const V2d ab = cube.coordinates_on(face, d);
            const auto index = [&](double a) {
                return std::clamp(static_cast<int>((a + 1) / step), 0, size - 1);
            };
            x = index(ab.x);
            y = index(ab.y);
        }
        return static_cast<std::uint32_t>((face * size + y) * size + x);
    };
    const std::size_t count = 6 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    directions_.reserve(count);
    neighbours_.reserve(count);
    solid_angles_.reserve(count);
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double a = middle(x), b = middle(y), square = 1 + a * a + b * b;
                directions_.push_back(cube.direction_on(face, a, b));
                neighbours_.push_back({cell_of(face, x - 1, y), cell_of(face, x + 1, y),
                                       cell_of(face, x, y - 1), cell_of(face, x, y + 1)});
                solid_angles_.push_back(step * step / (square * std::sqrt(square)));
            }
}

CellValues widened(const ViewCube& cube, CellValues values, int steps) {
    return combined(cube, std::move(values), steps,
                    [](float a, float b, float c, float d, float e) {
                        return std::max({a, b, c, d, e});
                    });
}

CellValues narrowed(const ViewCube& cube, CellValues values, int steps) {
    return combined(cube, std::move(values), steps,
                    [](float a, float b, float c, float d, float e) {
                        return std::min({a, b, c, d, e});
                    });
}

CellValues blurred(const ViewCube& cube, CellValues values, int steps) {
    return combined(cube, std::move(values), steps,
                    [](float a, float b, float c, float d, float e) {
                        return 0.5F * a + 0.125F * (b + c + d + e);
                    });
}

Image resized(const Image& cube, int size) {
    const Layout& layout = *find_layout("openexr");
    return resample(map_source(cube, layout), layout, size);
}

}  // namespace chromeball
