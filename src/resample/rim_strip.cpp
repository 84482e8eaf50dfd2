#include "resample/rim_strip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace chromeball {
namespace {

using std::numbers::pi;

constexpr int kRowsPerPixel = 8;     // of depth
constexpr double kDepthSigma = 0.2;  // pixels; found by trying 0.15 to 0.3 on renders
constexpr double kMostColumns =
    65536;                      // along the rim, one a pixel; of balls larger than any photo fewer
constexpr double kWidth = 3.5;  // pixels of depth that the strip covers, in a ball not tiny

// A row's depth may have its nearest usable pixels a whole pixel away, where the rim runs along
// rows.
constexpr double kDepthReach = 1.1;
constexpr std::size_t kMostRowsReached =
    static_cast<std::size_t>(2 * kDepthReach * kRowsPerPixel) + 2;
constexpr double kAlongReach = 4.0 / 3;  // sigmas: nearly a box, whose ends stay within 4 pixels

/// How far along the rim pixels count as one: 0.7 degrees around the ball, at most 3 pixels.
double along_sigma_of(const Outline& outline) { return std::clamp(0.012 * outline.b, 0.5, 3.0); }

constexpr int kBlockColumns = 256;
constexpr int kBandRows = 32;

/// exp(-x^2 / 2) at x, x + step, ...: each from the one before by two products.
class GaussianSteps {
public:
    GaussianSteps(double x, double step)
        : value_(std::exp(-0.5 * x * x)),
          ratio_(std::exp(-x * step - 0.5 * step * step)),
          bend_(std::exp(-step * step)) {}
    double next() {
        const double value = value_;
        value_ *= ratio_;
        ratio_ *= bend_;
        return value;
    }

private:
    double value_, ratio_, bend_;
};

int wrapped(int column, int columns) { return ((column % columns) + columns) % columns; }

}  // namespace

RimStrip::RimStrip(const Image& pixels, const Outline& outline, double first_depth)
    : outline_(outline),
      rows_(outline),
      first_(first_depth),
      last_(first_depth + std::min(kWidth, 0.1 * outline.b)) {
    const double around = 2 * pi * outline.a;
    const int columns = static_cast<int>(std::clamp(std::ceil(around), 8.0, kMostColumns));
    const int rows = 1 + static_cast<int>(std::ceil((last_ - first_) * kRowsPerPixel));
    strip_ = Image({columns + 1, rows}, 4);
    const double along_sigma = std::max(0.5, along_sigma_of(outline) * columns / around);
    const double reach = kAlongReach * along_sigma;
    const std::vector<RingPixel> pixels_there = ring(pixels, last_ + 4 * kDepthSigma);

    // Blocks of columns are for threads: each takes the pixels that reach into it, in their order.
    const int blocks = (columns + kBlockColumns - 1) / kBlockColumns;
    std::vector<std::vector<std::size_t>> reaching(static_cast<std::size_t>(blocks));
    for (std::size_t i = 0; i < pixels_there.size(); ++i) {
        const double turn = pixels_there[i].place.turn;
        const int first = static_cast<int>(std::ceil(turn - reach)),
                  last = static_cast<int>(std::floor(turn + reach));
        int before = -1;
        for (int column = first;; column = std::min(column + kBlockColumns, last)) {
            const int block = wrapped(column, columns) / kBlockColumns;
            auto& list = reaching[static_cast<std::size_t>(block)];
            if (block != before && (list.empty() || list.back() != i)) list.push_back(i);
            before = block;
            if (column >= last) break;
        }
    }
    for_each_band(blocks, 1, [&](int first, int last) {
        for (int block = first; block < last; ++block)
            for (const std::size_t i : reaching[static_cast<std::size_t>(block)])
                splat(pixels_there[i], along_sigma, block * kBlockColumns,
                      std::min(columns, (block + 1) * kBlockColumns) - 1);
    });
    for (int y = 0; y < rows; ++y) std::copy_n(strip_.pixel(0, y), 4, strip_.pixel(columns, y));
}

double RimStrip::rows_per_pixel() const { return kRowsPerPixel; }

std::vector<RimStrip::RingPixel> RimStrip::ring(const Image& pixels, double deepest) const {
    const double inner = 1 - deepest / outline_.b;
    const int bands = (pixels.height() + kBandRows - 1) / kBandRows;
    std::vector<std::vector<RingPixel>> parts(static_cast<std::size_t>(bands));
    for_each_band(pixels.height(), kBandRows, [&](int first, int last) {
        auto& part = parts[static_cast<std::size_t>(first / kBandRows)];
        const auto look = [&](int y, double from, double to) {
            const int x0 = static_cast<int>(std::clamp(from, 0.0, double(pixels.width())));
            const int x1 = static_cast<int>(std::clamp(to, 0.0, double(pixels.width())));
            for (int x = x0; x < x1; ++x) {
                const float* pixel = pixels.pixel(x, y);
                if (!(pixel[3] > 0)) continue;
                if (const auto at = place(x + 0.5, y + 0.5, deepest)) part.push_back({*at, pixel});
            }
        };
        for (int y = first; y < last; ++y) {
            const auto outer_span = rows_.span(y + 0.5, 1);
            if (!outer_span) continue;  // what is usable lies inside
            const auto inner_span = rows_.span(y + 0.5, inner);
            // Two pixels more than is needed: place() decides.
            const double left = outer_span->left - 2, right = outer_span->right + 2;
            if (inner_span && inner_span->right - inner_span->left > 4) {
                look(y, left, inner_span->left + 2);
                look(y, inner_span->right - 2, right);
            } else {
                look(y, left, right);
            }
        }
    });
    std::vector<RingPixel> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

std::optional<RimStrip::Place> RimStrip::place(double x, double y, double deepest) const {
    const EllipseRows::Place p = rows_.at(x, y);
    // Surely deeper: the ellipse shrunk by that much along its short axis.
    const double inner = 1 - deepest / outline_.b;
    if (inner > 0 && p.square < inner * inner) return std::nullopt;
    if (p.gu == 0 && p.gv == 0) return std::nullopt;
    Place at;
    at.depth = p.depth();
    if (at.depth > deepest) return std::nullopt;
    at.turn = (std::atan2(p.v, p.u) / (2 * pi) + 0.5) * columns();
    return at;
}

void RimStrip::splat(const RingPixel& from, double along_sigma, int from_column, int to_column) {
    const double row = (from.place.depth - first_) * kRowsPerPixel;
    const double row_reach = kDepthReach * kRowsPerPixel;
    const int first_row = std::max(0, static_cast<int>(std::ceil(row - row_reach)));
    const int last_row =
        std::min(strip_.height() - 1, static_cast<int>(std::floor(row + row_reach)));
    const double turn = from.place.turn, reach = kAlongReach * along_sigma;
    const int first = static_cast<int>(std::ceil(turn - reach)),
              last = static_cast<int>(std::floor(turn + reach));
    std::array<double, kMostRowsReached> down;
    GaussianSteps deeper((first_row - row) / (kDepthSigma * kRowsPerPixel),
                         1 / (kDepthSigma * kRowsPerPixel));
    for (int j = first_row; j <= last_row; ++j)
        down[static_cast<std::size_t>(j - first_row)] = deeper.next();
    GaussianSteps along((first - turn) / along_sigma, 1 / along_sigma);
    for (int i = first; i <= last; ++i) {
        const double weight = along.next();
        const int column = wrapped(i, columns());
        if (column < from_column || column > to_column) continue;
        for (int j = first_row; j <= last_row; ++j) {
            const auto w =
                static_cast<float>(weight * down[static_cast<std::size_t>(j - first_row)]);
            float* to = strip_.pixel(column, j);
            for (int c = 0; c < 4; ++c) to[c] += w * from.pixel[c];
        }
    }
}

std::optional<Rgbw> RimStrip::tap(double x, double y) const {
    if (strip_.empty()) return std::nullopt;
    const auto at = place(x, y, last_);
    if (!at) return std::nullopt;
    const double row =
        std::clamp((at->depth - first_) * kRowsPerPixel, 0.0, strip_.height() - 1.001);
    const double left = std::floor(at->turn);
    const int j = static_cast<int>(row);
    const int i = wrapped(static_cast<int>(left), columns());
    const auto fx = static_cast<float>(at->turn - left), fy = static_cast<float>(row - j);
    Rgbw sum;
    sum.add((1 - fx) * (1 - fy), strip_.pixel(i, j));
    sum.add(fx * (1 - fy), strip_.pixel(i + 1, j));
    sum.add((1 - fx) * fy, strip_.pixel(i, j + 1));
    sum.add(fx * fy, strip_.pixel(i + 1, j + 1));
    if (!(sum.w > 1e-12F)) return std::nullopt;
    return sum;
}

}  // namespace chromeball
