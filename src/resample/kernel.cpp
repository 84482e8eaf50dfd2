// The resampler's vector kernels, once for every kind of processor.
//
// A tile is drawn row by row. Positions of the pixels' middles, and of their neighbours, are
// computed for all lanes at once into a few rows that stay in the nearest cache; differences of
// neighbours are the Jacobian. What is straight and whole takes taps along it; the rest (around the
// back of the ball, poles, seams, the rim, the frame) is collected and takes its taps where the
// exact mapping puts each of them.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "resample/kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "resample/filter.h"
#include "resample/kernel.h"
#include "resample/kernel_map-inl.h"
#include "resample/kernel_tap-inl.h"
#include "resample/simd.h"

#ifndef CHROMEBALL_RESAMPLE_KERNEL_ONCE
#define CHROMEBALL_RESAMPLE_KERNEL_ONCE
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace chromeball::kernel {
namespace {

constexpr int kMostLanes = 16;
/// Room for a tile's row, a neighbour on each side, and what a last vector writes beyond.
constexpr int kRow = kTileWidth + 2 + 2 * kMostLanes;
constexpr int kBatch = 256;  // taps that are placed at once

// What is done for a pixel.
constexpr std::int32_t kFour = 0, kMany = 1, kCubic = 2, kExact = 3;

constexpr float kMagnified = static_cast<float>(filter::kMagnified),
                kCubicReach = static_cast<float>(filter::kCubicReach),
                kNearlyStraight = static_cast<float>(filter::kNearlyStraight),
                kTapsPerPixel = static_cast<float>(filter::kTapsPerPixel);
using filter::kLeastTaps, filter::kMostTaps, filter::kPure, filter::kUnknownTaps;

/// Positions of a row's pixels: [0] is the left neighbour of the first.
struct alignas(64) PlacedRow {
    float x[kRow], y[kRow], face[kRow], bend[kRow];
    float target_bend[kRow];             // without the source's
    float dx[kRow], dy[kRow], dz[kRow];  // directions, of a cube only
};

/// A row's pixels, sorted out.
struct alignas(64) SortedRow {
    std::int32_t what[kRow], nx[kRow], ny[kRow];
    float xx[kRow], xy[kRow], yx[kRow], yy[kRow];  // source pixels per step right and down
    std::int32_t at[4][kRow];                      // of the first four taps: pixel, and fractions
    float fx[4][kRow], fy[4][kRow];
};

/// Taps waiting to be placed and taken.
struct alignas(64) Batch {
    int count = 0;
    float x[kBatch + kMostLanes], y[kBatch + kMostLanes];
    int pixel[kBatch];
    float dx[kBatch + kMostLanes], dy[kBatch + kMostLanes], dz[kBatch + kMostLanes];
    float px[kBatch + kMostLanes], py[kBatch + kMostLanes], face[kBatch + kMostLanes],
        bend[kBatch + kMostLanes];
    std::int32_t at[kBatch + kMostLanes], strip_at[kBatch + kMostLanes];
    float fx[kBatch + kMostLanes], fy[kBatch + kMostLanes];
    float strip_fx[kBatch + kMostLanes], strip_fy[kBatch + kMostLanes];
    float inside[kBatch + kMostLanes];  // 1: has something to show
};

/// Pixels that need exact taps, and their sums so far.
struct alignas(64) ExactRow {
    int count = 0;
    int pixel[kRow];
    double taps[kRow];
    double sum[kRow][4];
};

/// Where the taps of a pixel lie in it, from -1/2 to 1/2, row by row.
struct alignas(64) TapGrid {
    static constexpr int kMostTaps = 64;
    float x[kMostTaps + kMostLanes] = {}, y[kMostTaps + kMostLanes] = {};
};

/// The grids of up to kMostTaps taps, made once.
class TapGrids {
public:
    TapGrids() {
        for (int nx = 1; nx <= TapGrid::kMostTaps; ++nx)
            for (int ny = 1; nx * ny <= TapGrid::kMostTaps; ++ny) {
                TapGrid grid;
                for (int k = 0; k < nx * ny; ++k) {
                    grid.x[k] = (static_cast<float>(k % nx) + 0.5F) / static_cast<float>(nx) - 0.5F;
                    grid.y[k] = (static_cast<float>(k / nx) + 0.5F) / static_cast<float>(ny) - 0.5F;
                }
                if (ny == 1) first_[nx] = grids_.size();
                grids_.push_back(grid);
            }
    }
    /// Null for more taps.
    const TapGrid* find(int nx, int ny) const {
        if (nx * ny > TapGrid::kMostTaps) return nullptr;
        return &grids_[first_[nx] + static_cast<std::size_t>(ny - 1)];
    }

private:
    std::size_t first_[TapGrid::kMostTaps + 1] = {};
    std::vector<TapGrid> grids_;
};

const TapGrids& tap_grids() {
    static const TapGrids grids;
    return grids;
}

struct Scratch {
    PlacedRow placed[3];
    SortedRow sorted;
    Batch batch;
    ExactRow exact;
    alignas(64) float column[kRow], line[kRow];
};

}  // namespace
}  // namespace chromeball::kernel
#endif

HWY_BEFORE_NAMESPACE();
namespace chromeball::kernel {
namespace HWY_NAMESPACE {

HWY_INLINE std::size_t lanes() { return hn::Lanes(D()); }
HWY_INLINE V load(const float* from) { return hn::LoadU(D(), from); }
HWY_INLINE void store(V value, float* to) { hn::StoreU(value, D(), to); }

void directions(const TargetForm& target, const float* x, const float* y, std::size_t count,
                float* dx, float* dy, float* dz, float* bend) {
    with_target(target, [&](const auto& direction) HWY_ATTR {
        for (std::size_t i = 0; i < count; i += lanes()) {
            const Direction d = direction(load(x + i), load(y + i));
            store(d.x, dx + i);
            store(d.y, dy + i);
            store(d.z, dz + i);
            store(d.bend, bend + i);
        }
    });
}

/// bend: the larger one of the target's and the source's.
void places(const SourceForm& source, const float* dx, const float* dy, const float* dz,
            const float* target_bend, std::size_t count, float* x, float* y, float* face,
            float* bend) {
    with_source(source, [&](const auto& place) HWY_ATTR {
        for (std::size_t i = 0; i < count; i += lanes()) {
            const Place p = place(load(dx + i), load(dy + i), load(dz + i));
            store(p.x, x + i);
            store(p.y, y + i);
            store(p.face, face + i);
            store(hn::Max(p.bend, load(target_bend + i)), bend + i);
        }
    });
}

/// The source's pixels and its rim's as they are.
class AllPixels {
public:
    TapSum taps() const { return {}; }
    TapSum rim_taps() const { return {}; }
    HWY_INLINE Pixel cubic(const float* pixel, std::ptrdiff_t row, float fx, float fy) const {
        return cubic_tap(pixel, row, fx, fy);
    }
};

/// As if all pixels were black but a few; weights are those of the picture.
class LitPixels {
public:
    explicit LitPixels(const LitForm& form) : form_(form) {}

    class Taps {
    public:
        explicit Taps(const LitPixels& pixels, bool lit) : pixels_(pixels), lit_(lit) {}
        void add(const float* pixel, std::ptrdiff_t row, float fx, float fy) {
            if (!lit_ || !(pixels_.may_hold(pixel, 2) || pixels_.may_hold(pixel + row, 2))) {
                const float* below = pixel + row;
                weight_ += (1 - fy) * ((1 - fx) * pixel[3] + fx * pixel[7]) +
                           fy * ((1 - fx) * below[3] + fx * below[7]);
                return;
            }
            alignas(32) float copy[4 * 4];
            for (int y = 0; y < 2; ++y) pixels_.copy(pixel + y * row, 2, copy + 8 * y);
            sum_.add(copy, 8, fx, fy);
        }
        Pixel total() const {
            const float weight[4] = {0, 0, 0, weight_};
            return kernel::HWY_NAMESPACE::add(sum_.total(), load_pixel(weight));
        }

    private:
        const LitPixels& pixels_;
        bool lit_;
        float weight_ = 0;  ///< of taps that see none of the few
        TapSum sum_;
    };
    Taps taps() const { return Taps(*this, true); }
    /// None of the few is near the rim.
    Taps rim_taps() const { return Taps(*this, false); }

    Pixel cubic(const float* pixel, std::ptrdiff_t row, float fx, float fy) const {
        alignas(32) float pixels[4 * 16];
        for (int y = 0; y < 4; ++y) copy(pixel + (y - 1) * row - 4, 4, pixels + 16 * y);
        return cubic_tap(pixels + 16 + 4, 16, fx, fy);
    }

private:
    /// False if surely none of the pixels is one of the few.
    bool may_hold(const float* first, int count) const {
        const std::ptrdiff_t at = (first - form_.picture) / 4;
        return at + count > form_.pixels->at && at <= form_.pixels[form_.count - 1].at;
    }
    /// Pixels of a row.
    void copy(const float* from, int count, float* to) const {
        for (int i = 0; i < count; ++i, from += 4, to += 4) {
            std::fill_n(to, 3, 0.0F);
            to[3] = from[3];
            if (const LitPixel* found = find((from - form_.picture) / 4))
                std::copy_n(found->color, 3, to);
        }
    }
    const LitPixel* find(std::ptrdiff_t at) const {
        const LitPixel* end = form_.pixels + form_.count;
        if (at < form_.pixels->at || at > (end - 1)->at) return nullptr;
        const LitPixel* found = std::lower_bound(
            form_.pixels, end, at, [](const LitPixel& p, std::ptrdiff_t i) { return p.at < i; });
        return found->at == at ? found : nullptr;
    }

    const LitForm& form_;
};

/// One tile being drawn.
template <class Pixels>
class Drawing {
public:
    Drawing(const Job& job, const Tile& tile, const Pixels& pixels, Scratch& scratch)
        : source_(job.source), pixels_(pixels), adaptive_(job.adaptive), tile_(tile), s_(scratch) {
        const int left = adaptive_ ? tile.x0 - 1 : tile.x0;
        for (int i = 0; i < kRow; ++i)
            s_.column[i] = static_cast<float>(left + i) + 0.5F - 0.5F * tile.target.width;
        width_ = tile.x1 - tile.x0;
    }

    void draw() {
        if (!adaptive_) {
            for (int y = tile_.y0; y < tile_.y1; ++y) {
                place(y, s_.placed[0]);
                sort_fast(s_.placed[0]);
                take(y);
            }
            return;
        }
        place(tile_.y0 - 1, s_.placed[0]);
        place(tile_.y0, s_.placed[1]);
        for (int y = tile_.y0; y < tile_.y1; ++y) {
            const int k = y - tile_.y0;
            place(y + 1, s_.placed[(k + 2) % 3]);
            middle_ = &s_.placed[(k + 1) % 3];
            sort(s_.placed[k % 3], *middle_, s_.placed[(k + 2) % 3]);
            take(y);
        }
    }

    void locate(float* x, float* y) {
        const std::size_t first = adaptive_ ? 1 : 0;
        const float face_rows =
            source_.face_pixels > 0 ? static_cast<float>(source_.face_pixels / source_.stride) : 0;
        PlacedRow& row = s_.placed[0];
        for (int j = tile_.y0; j < tile_.y1; ++j) {
            place(j, row);
            for (std::size_t i = first; i < first + static_cast<std::size_t>(width_); ++i) {
                const bool shown = row.bend[i] < kNowhere;
                *x++ = shown ? row.x[i] : std::numeric_limits<float>::quiet_NaN();
                *y++ = shown ? row.y[i] + face_rows * row.face[i]
                             : std::numeric_limits<float>::quiet_NaN();
            }
        }
    }

private:
    void place(int y, PlacedRow& row) {
        const std::size_t count = static_cast<std::size_t>(width_ + (adaptive_ ? 2 : 0));
        const float middle = static_cast<float>(y) + 0.5F - 0.5F * tile_.target.height;
        std::fill_n(s_.line, count + kMostLanes, middle);
        directions(tile_.target, s_.column, s_.line, count, row.dx, row.dy, row.dz,
                   row.target_bend);
        places(source_, row.dx, row.dy, row.dz, row.target_bend, count, row.x, row.y, row.face,
               row.bend);
    }

    /// Whether all within reach of a position can be taken from the picture without a look at
    /// seams, the frame or the rim.
    HWY_INLINE hn::Mask<D> whole(V x, V y, V reach_x, V reach_y) const {
        auto in = hn::And(hn::Ge(hn::Sub(x, reach_x), set(source_.left)),
                          hn::Le(hn::Add(x, reach_x), set(source_.right)));
        in = hn::And(in, hn::And(hn::Ge(hn::Sub(y, reach_y), set(source_.top)),
                                 hn::Le(hn::Add(y, reach_y), set(source_.bottom))));
        if (source_.shape != SourceForm::Shape::ball) return in;
        const Disk disk = on_disk(x, y);
        const V reach = hn::Mul(hn::Sqrt(hn::MulAdd(reach_x, reach_x, hn::Mul(reach_y, reach_y))),
                                set(1 / source_.short_axis));
        const V inner = hn::Sub(set(1 - source_.strip.last / source_.short_axis), reach);
        return hn::And(
            in, hn::And(hn::Gt(inner, hn::Zero(D())), hn::Lt(disk.square, hn::Mul(inner, inner))));
    }

    struct Disk {
        V u, v, square;
    };
    HWY_INLINE Disk on_disk(V x, V y) const {
        const V dx = hn::Sub(x, set(source_.centre_x)), dy = hn::Sub(y, set(source_.centre_y));
        const float* m = source_.to_disk.data();
        const V u = hn::MulAdd(set(m[0]), dx, hn::Mul(set(m[1]), dy));
        const V v = hn::MulAdd(set(m[2]), dx, hn::Mul(set(m[3]), dy));
        return {u, v, hn::MulAdd(u, u, hn::Mul(v, v))};
    }

    /// The upper left of the four pixels around a position, and how far it is from its middle.
    HWY_INLINE void split(V x, V y, V face, std::int32_t* at, float* fx, float* fy) const {
        const D d;
        const DI di;
        const V half = set(0.5F);
        // Positions that count are positive, and truncation is floor.
        const VI ix = hn::ConvertTo(di, hn::Sub(x, half)), iy = hn::ConvertTo(di, hn::Sub(y, half));
        VI pixel = hn::Add(hn::Mul(iy, hn::Set(di, source_.stride)), ix);
        if (source_.shape == SourceForm::Shape::cube)
            pixel =
                hn::Add(pixel, hn::Mul(hn::ConvertTo(di, face), hn::Set(di, source_.face_pixels)));
        hn::StoreU(pixel, di, at);
        store(hn::Sub(hn::Sub(x, half), hn::ConvertTo(d, ix)), fx);
        store(hn::Sub(hn::Sub(y, half), hn::ConvertTo(d, iy)), fy);
    }

    void sort_fast(const PlacedRow& row) {
        const DI di;
        SortedRow& to = s_.sorted;
        const V zero = hn::Zero(D());
        for (std::size_t i = 0; i < static_cast<std::size_t>(width_); i += lanes()) {
            const V x = load(row.x + i), y = load(row.y + i);
            const auto simple =
                hn::And(hn::Lt(load(row.bend + i), set(kNowhere)), whole(x, y, zero, zero));
            hn::StoreU(
                hn::IfThenElse(hn::RebindMask(di, simple), hn::Set(di, kFour), hn::Set(di, kExact)),
                di, to.what + i);
            split(x, y, load(row.face + i), to.at[0] + i, to.fx[0] + i, to.fy[0] + i);
        }
    }

    void sort(const PlacedRow& above, const PlacedRow& row, const PlacedRow& below) {
        const DI di;
        SortedRow& to = s_.sorted;
        const V half = set(0.5F);
        for (std::size_t i = 0; i < static_cast<std::size_t>(width_); i += lanes()) {
            const std::size_t c = i + 1;
            const V x = load(row.x + c), y = load(row.y + c), face = load(row.face + c);
            const Neighbour left = neighbour(row, c - 1, face), right = neighbour(row, c + 1, face);
            const Neighbour up = neighbour(above, c, face), down = neighbour(below, c, face);
            V xx, xy, yx, yy;
            difference(left, right, x, y, xx, xy);
            difference(up, down, x, y, yx, yy);
            if (source_.shape == SourceForm::Shape::latlong) {
                xx = unwrapped(xx);
                yx = unwrapped(yx);
            }
            const V length_x = length(xx, xy), length_y = length(yx, yy);
            const VI nx = sample_count(length_x), ny = sample_count(length_y);
            const V reach_x = hn::Mul(half, hn::Add(hn::Abs(xx), hn::Abs(yx)));
            const V reach_y = hn::Mul(half, hn::Add(hn::Abs(xy), hn::Abs(yy)));
            const V bend = load(row.bend + c);
            const auto known = hn::Lt(bend, set(kNowhere));
            auto cubic = hn::And(known, hn::Lt(hn::Max(length_x, length_y), set(kMagnified)));
            const auto straight = hn::Or(hn::Lt(bend, set(kCurved)),
                                         hn::And(known, hn::And(nearly_straight(left, right, x, y),
                                                                nearly_straight(up, down, x, y))));
            auto simple = hn::And(straight, whole(x, y, reach_x, reach_y));
            if (source_.shape == SourceForm::Shape::ball)
                cubic = hn::And(cubic, whole(x, y, set(kCubicReach), set(kCubicReach)));
            simple = hn::Or(simple, cubic);
            const VI two = hn::Set(di, 2), unknown = hn::Set(di, kUnknownTaps);
            const auto small = hn::And(hn::Eq(nx, two), hn::Eq(ny, two));
            VI what = hn::IfThenElse(small, hn::Set(di, kFour), hn::Set(di, kMany));
            what = hn::IfThenElse(hn::RebindMask(di, cubic), hn::Set(di, kCubic), what);
            hn::StoreU(hn::IfThenElse(hn::RebindMask(di, simple), what, hn::Set(di, kExact)), di,
                       to.what + i);
            // A pixel of whose middle nothing is known may still be shown in part.
            const auto lost = hn::RebindMask(di, hn::Not(known));
            hn::StoreU(hn::IfThenElse(lost, unknown, nx), di, to.nx + i);
            hn::StoreU(hn::IfThenElse(lost, unknown, ny), di, to.ny + i);
            store(xx, to.xx + i);
            store(xy, to.xy + i);
            store(yx, to.yx + i);
            store(yy, to.yy + i);
            const V quarter = set(0.25F);
            // The cubic's only tap takes the first one's place.
            const V sx = hn::IfThenZeroElse(cubic, hn::Mul(quarter, hn::Add(xx, yx)));
            const V sy = hn::IfThenZeroElse(cubic, hn::Mul(quarter, hn::Add(xy, yy)));
            const V tx = hn::Mul(quarter, hn::Sub(xx, yx)), ty = hn::Mul(quarter, hn::Sub(xy, yy));
            split(hn::Sub(x, sx), hn::Sub(y, sy), face, to.at[0] + i, to.fx[0] + i, to.fy[0] + i);
            split(hn::Add(x, tx), hn::Add(y, ty), face, to.at[1] + i, to.fx[1] + i, to.fy[1] + i);
            split(hn::Sub(x, tx), hn::Sub(y, ty), face, to.at[2] + i, to.fx[2] + i, to.fy[2] + i);
            split(hn::Add(x, sx), hn::Add(y, sy), face, to.at[3] + i, to.fx[3] + i, to.fy[3] + i);
        }
    }

    struct Neighbour {
        V x, y, bend;
    };
    /// Source pixels per step of the output, from both neighbours, or where the target ends from
    /// one. (What the source does not show, as a hidden direction, still has a place: on the rim.)
    HWY_INLINE void difference(const Neighbour& before, const Neighbour& after, V x, V y, V& dx,
                               V& dy) const {
        const auto has_before = hn::Lt(before.bend, set(kNowhere)),
                   has_after = hn::Lt(after.bend, set(kNowhere));
        const V scale = hn::IfThenElse(hn::And(has_before, has_after), set(0.5F), set(1));
        dx = hn::Mul(scale, hn::Sub(hn::IfThenElse(has_after, after.x, x),
                                    hn::IfThenElse(has_before, before.x, x)));
        dy = hn::Mul(scale, hn::Sub(hn::IfThenElse(has_after, after.y, y),
                                    hn::IfThenElse(has_before, before.y, y)));
    }
    /// A neighbour's position; of a cube on the plane of the pixel's own face.
    HWY_INLINE Neighbour neighbour(const PlacedRow& row, std::size_t i, V face) const {
        if (source_.shape != SourceForm::Shape::cube)
            return {load(row.x + i), load(row.y + i), load(row.target_bend + i)};
        const Place p =
            CubeSource(source_).on_face(load(row.dx + i), load(row.dy + i), load(row.dz + i), face);
        return {p.x, p.y, load(row.target_bend + i)};
    }

    /// Whether a pixel between two neighbours lies where a straight line puts it, near enough.
    HWY_INLINE hn::Mask<D> nearly_straight(const Neighbour& before, const Neighbour& after, V x,
                                           V y) const {
        const V two = set(2), limit = set(kNearlyStraight), nowhere = set(kNowhere);
        const V bend_x = hn::Abs(hn::NegMulAdd(two, x, hn::Add(before.x, after.x)));
        const V bend_y = hn::Abs(hn::NegMulAdd(two, y, hn::Add(before.y, after.y)));
        return hn::And(hn::Lt(hn::Max(bend_x, bend_y), limit),
                       hn::And(hn::Lt(before.bend, nowhere), hn::Lt(after.bend, nowhere)));
    }

    /// A step in a lat-long, the short way round.
    HWY_INLINE V unwrapped(V step) const {
        const V turns = hn::Round(hn::Mul(step, set(2 / source_.x_scale)));
        return hn::NegMulAdd(turns, set(0.5F * source_.x_scale), step);
    }

    static HWY_INLINE V length(V dx, V dy) { return hn::Sqrt(hn::MulAdd(dx, dx, hn::Mul(dy, dy))); }

    /// As sample_count of the scalar reference.
    HWY_INLINE VI sample_count(V footprint) const {
        const V count = hn::Ceil(hn::Mul(set(kTapsPerPixel), footprint));
        return hn::ConvertTo(DI(), hn::Min(hn::Max(count, set(kLeastTaps)), set(kMostTaps)));
    }

    const float* pixel(std::int32_t index) const {
        return source_.pixels + 4 * static_cast<std::ptrdiff_t>(index);
    }

    /// Takes the taps of a sorted row and stores the pixels.
    void take(int y) {
        float* out = tile_.out + (y - tile_.y0) * tile_.stride;
        s_.exact.count = 0;
        if (adaptive_)
            take_simple<4>(out);
        else
            take_simple<1>(out);
        if (s_.exact.count > 0) take_exact(y, out);
    }

    template <int kTaps>
    void take_simple(float* out) {
        const SortedRow& row = s_.sorted;
        const std::ptrdiff_t down = 4 * static_cast<std::ptrdiff_t>(source_.stride);
        const bool ball = source_.shape == SourceForm::Shape::ball;
        for (int i = 0; i < width_; ++i) {
            if (row.what[i] == kExact) {
                s_.exact.pixel[s_.exact.count++] = i;
                continue;
            }
            Pixel total;
            float taps = kTaps;
            if (kTaps == 1 || row.what[i] == kFour) {
                auto sum = pixels_.taps();
                for (int k = 0; k < kTaps; ++k)
                    sum.add(pixel(row.at[k][i]), down, row.fx[k][i], row.fy[k][i]);
                total = sum.total();
            } else if (row.what[i] == kCubic) {
                total = pixels_.cubic(pixel(row.at[0][i]), down, row.fx[0][i], row.fy[0][i]);
                taps = 1;
            } else {
                total = many_taps(i);
                taps = static_cast<float>(row.nx[i] * row.ny[i]);
            }
            if (ball) {
                const float weight = alpha_of(total);
                // Pixels that must not be used are among these.
                if (!(weight > kPure * taps)) {
                    s_.exact.pixel[s_.exact.count++] = i;
                    continue;
                }
                total = divide(total, gray(weight));
            } else {
                total = divide(total, gray(taps));
            }
            // Where there is little to do a pixel, a large picture takes its way past the caches:
            // they need not read what is written.
            if (kTaps == 1 && tile_.large)
                stream_pixel(total, out + 4 * i);
            else
                store_pixel(total, out + 4 * i);
        }
    }

    /// Taps along the Jacobian.
    Pixel grid_taps(int i, const TapGrid& grid, int count) const {
        const SortedRow& row = s_.sorted;
        const PlacedRow& placed = *middle_;
        alignas(64) std::int32_t at[TapGrid::kMostTaps + kMostLanes];
        alignas(64) float fx[TapGrid::kMostTaps + kMostLanes], fy[TapGrid::kMostTaps + kMostLanes];
        const V x = set(placed.x[i + 1]), y = set(placed.y[i + 1]), face = set(placed.face[i + 1]);
        const V xx = set(row.xx[i]), xy = set(row.xy[i]), yx = set(row.yx[i]), yy = set(row.yy[i]);
        for (int k = 0; k < count; k += static_cast<int>(lanes())) {
            const V s = load(grid.x + k), t = load(grid.y + k);
            split(hn::MulAdd(s, xx, hn::MulAdd(t, yx, x)), hn::MulAdd(s, xy, hn::MulAdd(t, yy, y)),
                  face, at + k, fx + k, fy + k);
        }
        const std::ptrdiff_t down = 4 * static_cast<std::ptrdiff_t>(source_.stride);
        auto sum = pixels_.taps();
        for (int k = 0; k < count; ++k) sum.add(pixel(at[k]), down, fx[k], fy[k]);
        return sum.total();
    }

    /// nx x ny taps along the Jacobian.
    Pixel many_taps(int i) const {
        const SortedRow& row = s_.sorted;
        const PlacedRow& placed = *middle_;
        const std::ptrdiff_t down = 4 * static_cast<std::ptrdiff_t>(source_.stride);
        const int nx = row.nx[i], ny = row.ny[i];
        if (const TapGrid* grid = grids_.find(nx, ny)) return grid_taps(i, *grid, nx * ny);
        alignas(64) std::int32_t at[kMostTaps + kMostLanes];
        alignas(64) float fx[kMostTaps + kMostLanes], fy[kMostTaps + kMostLanes];
        const D d;
        const float step = 1 / static_cast<float>(nx), step_down = 1 / static_cast<float>(ny);
        const V face = set(placed.face[i + 1]);
        Pixel total = gray(0);
        for (int j = 0; j < ny; ++j) {
            const float t = (static_cast<float>(j) + 0.5F) * step_down - 0.5F;
            const float x0 = placed.x[i + 1] + t * row.yx[i], y0 = placed.y[i + 1] + t * row.yy[i];
            for (int k = 0; k < nx; k += static_cast<int>(lanes())) {
                const V s = hn::MulAdd(hn::Add(hn::Iota(d, static_cast<float>(k)), set(0.5F)),
                                       set(step), set(-0.5F));
                split(hn::MulAdd(s, set(row.xx[i]), set(x0)),
                      hn::MulAdd(s, set(row.xy[i]), set(y0)), face, at + k, fx + k, fy + k);
            }
            auto sum = pixels_.taps();  // of a row: so thousands of taps keep their digits
            for (int k = 0; k < nx; ++k) sum.add(pixel(at[k]), down, fx[k], fy[k]);
            total = add(total, sum.total());
        }
        return total;
    }

    void take_exact(int y, float* out) {
        ExactRow& exact = s_.exact;
        for (int k = 0; k < exact.count; ++k) {
            const int i = exact.pixel[k];
            const int nx = adaptive_ ? s_.sorted.nx[i] : 1;
            const int ny = adaptive_ ? s_.sorted.ny[i] : 1;
            exact.taps[k] = static_cast<double>(nx * ny);
            std::fill_n(exact.sum[k], 4, 0.0);
            const float left = static_cast<float>(tile_.x0 + i) - 0.5F * tile_.target.width;
            const float top = static_cast<float>(y) - 0.5F * tile_.target.height;
            if (const TapGrid* grid = grids_.find(nx, ny)) {
                collect(k, left + 0.5F, top + 0.5F, *grid, nx * ny);
                continue;
            }
            const float down = 1 / static_cast<float>(ny);
            for (int j = 0; j < ny; ++j)
                collect(k, left, top + (static_cast<float>(j) + 0.5F) * down, nx);
        }
        flush();
        for (int k = 0; k < exact.count; ++k) {
            float* to = out + 4 * static_cast<std::ptrdiff_t>(exact.pixel[k]);
            const double taps = exact.taps[k];
            for (int c = 0; c < 4; ++c) to[c] = static_cast<float>(exact.sum[k][c] / taps);
            to[3] = std::min(to[3], 1.0F);
        }
    }

    void collect(int pixel, float x, float y, const TapGrid& grid, int count) {
        Batch& batch = s_.batch;
        if (batch.count + count > kBatch) flush();
        for (int k = 0; k < count; k += static_cast<int>(lanes())) {
            store(hn::Add(set(x), load(grid.x + k)), batch.x + batch.count + k);
            store(hn::Add(set(y), load(grid.y + k)), batch.y + batch.count + k);
        }
        std::fill_n(batch.pixel + batch.count, count, pixel);
        batch.count += count;
    }

    /// A row of taps from a pixel's left side to its right.
    void collect(int pixel, float left, float y, int count) {
        Batch& batch = s_.batch;
        if (batch.count + count > kBatch) flush();
        const V step = set(1 / static_cast<float>(count));
        for (int k = 0; k < count; k += static_cast<int>(lanes())) {
            const V middle = hn::Add(hn::Iota(D(), static_cast<float>(k)), set(0.5F));
            store(hn::MulAdd(middle, step, set(left)), batch.x + batch.count + k);
            store(set(y), batch.y + batch.count + k);
        }
        std::fill_n(batch.pixel + batch.count, count, pixel);
        batch.count += count;
    }

    void flush() {
        Batch& batch = s_.batch;
        const auto count = static_cast<std::size_t>(batch.count);
        if (count == 0) return;
        // What a last vector computes beyond is some place, and not used.
        std::fill_n(batch.x + count, kMostLanes, batch.x[count - 1]);
        std::fill_n(batch.y + count, kMostLanes, batch.y[count - 1]);
        directions(tile_.target, batch.x, batch.y, count, batch.dx, batch.dy, batch.dz, batch.bend);
        places(source_, batch.dx, batch.dy, batch.dz, batch.bend, count, batch.px, batch.py,
               batch.face, batch.bend);
        prepare(count);
        // The taps of a pixel follow each other.
        for (int k = 0; k < batch.count;) {
            const int pixel = batch.pixel[k];
            Pixel sum = gray(0);
            for (; k < batch.count && batch.pixel[k] == pixel; ++k)
                if (batch.inside[k] > 0) sum = add(sum, exact_tap(k));
            float values[4];
            store_pixel(sum, values);
            for (int c = 0; c < 4; ++c) s_.exact.sum[pixel][c] += static_cast<double>(values[c]);
        }
        batch.count = 0;
    }

    void prepare(std::size_t count) {
        Batch& batch = s_.batch;
        const bool ball = source_.shape == SourceForm::Shape::ball;
        for (std::size_t i = 0; i < count; i += lanes()) {
            V x = load(batch.px + i), y = load(batch.py + i);
            auto in = hn::Lt(load(batch.bend + i), set(kNowhere));
            if (ball) {
                in = hn::And(
                    in,
                    hn::And(hn::And(hn::Ge(x, set(source_.left)), hn::Le(x, set(source_.right))),
                            hn::And(hn::Ge(y, set(source_.top)), hn::Le(y, set(source_.bottom)))));
                in = hn::And(in, hn::Eq(x, x));
            }
            store(hn::IfThenElseZero(in, set(1)), batch.inside + i);
            x = hn::IfThenElse(in, x, set(1));
            y = hn::IfThenElse(in, y, set(1));
            split(x, y, load(batch.face + i), batch.at + i, batch.fx + i, batch.fy + i);
            if (ball && source_.strip.pixels) on_strip(x, y, i);
        }
    }

    /// Where on the rim's strip positions lie; -1 where deeper.
    HWY_INLINE void on_strip(V x, V y, std::size_t i) {
        const D d;
        const DI di;
        Batch& batch = s_.batch;
        const StripForm& strip = source_.strip;
        const Disk disk = on_disk(x, y);
        const V gu = hn::Mul(disk.u, set(1 / source_.long_axis)),
                gv = hn::Mul(disk.v, set(1 / source_.short_axis));
        const V gradient = hn::Sqrt(hn::MulAdd(gu, gu, hn::Mul(gv, gv)));
        const V depth = hn::Div(hn::Sub(set(1), disk.square),
                                hn::Max(hn::Add(gradient, gradient), set(1e-30F)));
        const auto deeper = hn::Gt(depth, set(strip.last));
        const V row =
            hn::Min(hn::Max(hn::Mul(hn::Sub(depth, set(strip.first)), set(strip.rows_per_pixel)),
                            hn::Zero(d)),
                    set(static_cast<float>(strip.rows) - 1.001F));
        const V columns = set(static_cast<float>(strip.columns));
        V turn = hn::MulAdd(atan2_over_pi(disk.v, disk.u), hn::Mul(set(0.5F), columns),
                            hn::Mul(set(0.5F), columns));
        turn =
            hn::IfThenElse(hn::Ge(turn, columns), hn::Zero(d), turn);  // half a turn is both ends
        const VI column = hn::ConvertTo(di, turn), line = hn::ConvertTo(di, row);
        const VI at = hn::Add(hn::Mul(line, hn::Set(di, strip.columns + 1)), column);
        hn::StoreU(hn::IfThenElse(hn::RebindMask(di, deeper), hn::Set(di, -1), at), di,
                   batch.strip_at + i);
        store(hn::Sub(turn, hn::ConvertTo(d, column)), batch.strip_fx + i);
        store(hn::Sub(row, hn::ConvertTo(d, line)), batch.strip_fy + i);
    }

    HWY_INLINE Pixel exact_tap(int k) const {
        const Batch& batch = s_.batch;
        if (source_.shape != SourceForm::Shape::ball) return image_tap(k);
        const StripForm& strip = source_.strip;
        Pixel value = gray(0);
        if (strip.pixels && batch.strip_at[k] >= 0) {
            auto tap = pixels_.rim_taps();
            tap.add(strip.pixels + 4 * static_cast<std::ptrdiff_t>(batch.strip_at[k]),
                    4 * (static_cast<std::ptrdiff_t>(strip.columns) + 1), batch.strip_fx[k],
                    batch.strip_fy[k]);
            value = tap.total();
        }
        if (!(alpha_of(value) > 1e-12F)) value = image_tap(k);
        const float weight = alpha_of(value);
        return weight > 0 ? divide(value, gray(weight)) : gray(0);
    }

    HWY_INLINE Pixel image_tap(int k) const {
        const Batch& batch = s_.batch;
        auto tap = pixels_.taps();
        tap.add(pixel(batch.at[k]), 4 * static_cast<std::ptrdiff_t>(source_.stride), batch.fx[k],
                batch.fy[k]);
        return tap.total();
    }

    const SourceForm& source_;
    const Pixels& pixels_;
    bool adaptive_;
    const Tile& tile_;
    Scratch& s_;
    const TapGrids& grids_ = tap_grids();
    const PlacedRow* middle_ = nullptr;
    int width_ = 0;
};

void draw_tile(const Job& job, const Tile& tile) {
    Scratch scratch;
    Drawing(job, tile, AllPixels(), scratch).draw();
}

void draw_lit_tile(const Job& job, const Tile& tile, const LitForm& lit) {
    Scratch scratch;
    Drawing(job, tile, LitPixels(lit), scratch).draw();
}

void locate_tile(const Job& job, const Tile& tile, float* x, float* y) {
    Scratch scratch;
    Drawing(job, tile, AllPixels(), scratch).locate(x, y);
}

}  // namespace HWY_NAMESPACE
}  // namespace chromeball::kernel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chromeball::kernel {

HWY_EXPORT(draw_tile);
HWY_EXPORT(draw_lit_tile);
HWY_EXPORT(locate_tile);

void draw(const Job& job, const Tile& tile) { HWY_DYNAMIC_DISPATCH(draw_tile)(job, tile); }

void draw_lit(const Job& job, const Tile& tile, const LitForm& lit) {
    HWY_DYNAMIC_DISPATCH(draw_lit_tile)(job, tile, lit);
}

void locate(const Job& job, const Tile& tile, float* x, float* y) {
    HWY_DYNAMIC_DISPATCH(locate_tile)(job, tile, x, y);
}

}  // namespace chromeball::kernel

namespace chromeball {
namespace {

/// Of those that this file was compiled for.
std::int64_t runnable_targets() {
    hwy::SetSupportedTargetsForTest(0);
    return hwy::SupportedTargets() & HWY_TARGETS;
}

}  // namespace

std::vector<std::string> simd_targets() {
    std::vector<std::string> names;
    // Better ones have lower bits.
    for (std::int64_t rest = runnable_targets(); rest != 0; rest &= rest - 1)
        names.emplace_back(hwy::TargetName(rest & -rest));
    return names;
}

bool use_simd_target(std::string_view name) {
    std::int64_t wanted = 0;
    for (std::int64_t rest = runnable_targets(); rest != 0; rest &= rest - 1)
        if (name == hwy::TargetName(rest & -rest)) wanted = rest & -rest;
    if (wanted == 0 && !name.empty()) return false;
    hwy::SetSupportedTargetsForTest(wanted);
    return true;
}

}  // namespace chromeball
#endif
