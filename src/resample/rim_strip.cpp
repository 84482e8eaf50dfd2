#include "resample/rim_strip.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
constexpr double kAlongReach = 4.0 / 3;  // sigmas: nearly a box, whose ends stay within 4 pixels

/// How far along the rim pixels count as one: 0.7 degrees around the ball, at most 3 pixels.
double along_sigma_of(const Outline& outline) { return std::clamp(0.012 * outline.b, 0.5, 3.0); }

int wrapped(int column, int columns) { return ((column % columns) + columns) % columns; }

}  // namespace

RimStrip::RimStrip(const Image& pixels, const Outline& outline, double first_depth)
    : outline_(outline),
      cos_(std::cos(outline.angle * pi / 180)),
      sin_(std::sin(outline.angle * pi / 180)),
      first_(first_depth),
      last_(first_depth + std::min(kWidth, 0.1 * outline.b)) {
    const double around = 2 * pi * outline.a;
    const int columns = static_cast<int>(std::clamp(std::ceil(around), 8.0, kMostColumns));
    const int rows = 1 + static_cast<int>(std::ceil((last_ - first_) * kRowsPerPixel));
    strip_ = Image({columns, rows}, 4);
    // One thread: the same sums in the same order, and it is a thin ring of pixels.
    const double deepest = last_ + 4 * kDepthSigma;
    const double along_sigma = std::max(0.5, along_sigma_of(outline) * columns / around);
    for (int y = 0; y < pixels.height(); ++y)
        for (int x = 0; x < pixels.width(); ++x) {
            const float* pixel = pixels.pixel(x, y);
            if (!(pixel[3] > 0)) continue;
            if (const auto at = place(x + 0.5, y + 0.5, deepest)) splat(*at, pixel, along_sigma);
        }
}

std::optional<RimStrip::Place> RimStrip::place(double x, double y, double deepest) const {
    const double dx = x - outline_.cx, dy = y - outline_.cy;
    const double u = (dx * cos_ + dy * sin_) / outline_.a;
    const double v = (dy * cos_ - dx * sin_) / outline_.b;
    const double square = u * u + v * v;
    // Surely deeper: the ellipse shrunk by that much along its short axis.
    const double inner = 1 - deepest / outline_.b;
    if (inner > 0 && square < inner * inner) return std::nullopt;
    const double gu = u / outline_.a, gv = v / outline_.b;
    const double gradient = 2 * std::sqrt(gu * gu + gv * gv);
    if (gradient == 0) return std::nullopt;
    Place at;
    at.depth = (1 - square) / gradient;
    if (at.depth > deepest) return std::nullopt;
    at.turn = (std::atan2(v, u) / (2 * pi) + 0.5) * strip_.width();
    return at;
}

void RimStrip::splat(const Place& place, const float* pixel, double along_sigma) {
    const double row = (place.depth - first_) * kRowsPerPixel;
    const double row_reach = kDepthReach * kRowsPerPixel;
    const int first_row = std::max(0, static_cast<int>(std::ceil(row - row_reach)));
    const int last_row =
        std::min(strip_.height() - 1, static_cast<int>(std::floor(row + row_reach)));
    const double along_reach = kAlongReach * along_sigma;
    const int first_column = static_cast<int>(std::ceil(place.turn - along_reach));
    const int last_column = static_cast<int>(std::floor(place.turn + along_reach));
    for (int j = first_row; j <= last_row; ++j) {
        const double off = (j - row) / (kDepthSigma * kRowsPerPixel);
        const double weight = std::exp(-0.5 * off * off);
        for (int i = first_column; i <= last_column; ++i) {
            const double aside = (i - place.turn) / along_sigma;
            const auto w = static_cast<float>(weight * std::exp(-0.5 * aside * aside));
            float* to = strip_.pixel(wrapped(i, strip_.width()), j);
            for (int c = 0; c < 4; ++c) to[c] += w * pixel[c];
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
    const int i = wrapped(static_cast<int>(left), strip_.width());
    const int next = i + 1 < strip_.width() ? i + 1 : 0;
    const auto fx = static_cast<float>(at->turn - left), fy = static_cast<float>(row - j);
    Rgbw sum;
    sum.add((1 - fx) * (1 - fy), strip_.pixel(i, j));
    sum.add(fx * (1 - fy), strip_.pixel(next, j));
    sum.add((1 - fx) * fy, strip_.pixel(i, j + 1));
    sum.add(fx * fy, strip_.pixel(next, j + 1));
    if (!(sum.w > 1e-12F)) return std::nullopt;
    return sum;
}

}  // namespace chromeball
