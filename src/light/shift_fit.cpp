#include "light/shift_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "core/statistics.h"

namespace chromeball {
namespace {

/// Of one raster on another, in their pixels.
struct Fit {
    V2d shift{0, 0};
    double deviation = 1e9;  ///< of the shift
    double spread = 0.3;     ///< of what does not fit, natural logarithm; bounded below
    double misfit = 0;       ///< the same before the last step, not bounded
};

/// The equations of one step of Gauss and Newton.
struct ShiftEquations {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double squares = 0, total = 0;  ///< weighted residuals; weights
    std::size_t pixels = 0;
};

/// With the reference's slopes, at a shift.
ShiftEquations equations(const LogRaster& reference, const LogRaster& other, const Fit& fit) {
    ShiftEquations sum;
    for (int y = 0; y < reference.size.height; ++y)
        for (int x = 0; x < reference.size.width; ++x) {
            const std::size_t at = reference.at(x, y);
            if (!(reference.weight[at] > 0)) continue;
            const auto rise = slope(reference, x, y);
            if (!rise) continue;
            const LogSample s = sample(other, x + fit.shift.x, y + fit.shift.y);
            if (!(s.weight > 0)) continue;
            const double off = s.value - static_cast<double>(reference.value[at]);
            // Geman's and McClure's weights.
            const double far = off / (2 * fit.spread);
            const double weight = 1 /
                                  (1 / s.weight + 1 / static_cast<double>(reference.weight[at])) /
                                  (1 + far * far) / (1 + far * far);
            const Eigen::Vector2d row(rise->x, rise->y);
            sum.normal += weight * row * row.transpose();
            sum.right -= weight * off * row;
            sum.squares += weight * off * off;
            sum.total += weight;
            ++sum.pixels;
        }
    return sum;
}

/// One step of Gauss and Newton; false where the rasters share too little.
bool improve(const LogRaster& reference, const LogRaster& other, Fit& fit) {
    const auto& [sums, right, squares, total, pixels] = equations(reference, other, fit);
    constexpr std::size_t kFewest = 200;
    if (pixels < kFewest || !(sums(0, 0) > 0 && sums(1, 1) > 0)) return false;
    const Eigen::Matrix2d normal = sums + 1e-9 * sums.trace() * Eigen::Matrix2d::Identity();
    const auto factors = normal.ldlt();
    const Eigen::Vector2d change = factors.solve(right);
    if (!change.allFinite()) return false;
    // No further than the slopes reach.
    const double length = std::hypot(change[0], change[1]);
    const double part = length > 2 ? 2 / length : 1;
    fit.shift += V2d(change[0], change[1]) * part;
    fit.misfit = std::sqrt(squares / total);
    fit.spread = std::max(0.01, fit.misfit);
    const Eigen::Matrix2d inverse = factors.solve(Eigen::Matrix2d::Identity());
    // Residuals of neighbouring pixels go together, as edges do.
    constexpr double kTogether = 16;
    fit.deviation = std::sqrt(kTogether * (inverse(0, 0) + inverse(1, 1)) * squares /
                              static_cast<double>(pixels));
    return true;
}

/// How badly two rasters fit at a whole-pixel shift: spread of the difference, robustly.
double misfit(const LogRaster& reference, const LogRaster& other, int dx, int dy,
              std::vector<double>& differences) {
    differences.clear();
    std::size_t shown = 0;
    for (int y = 0; y < reference.size.height; ++y)
        for (int x = 0; x < reference.size.width; ++x) {
            const std::size_t at = reference.at(x, y);
            if (!(reference.weight[at] > 0)) continue;
            ++shown;
            const int i = x + dx, j = y + dy;
            if (i < 0 || j < 0 || i >= other.size.width || j >= other.size.height) continue;
            const std::size_t there = other.at(i, j);
            if (!(other.weight[there] > 0)) continue;
            differences.push_back(static_cast<double>(other.value[there] - reference.value[at]));
        }
    if (differences.size() < 60 || differences.size() < shown / 4)
        return std::numeric_limits<double>::infinity();
    const double middle = median(differences);
    double sum = 0;
    for (const double d : differences) sum += std::min(0.5, std::abs(d - middle));
    return sum / static_cast<double>(differences.size());
}

/// The best whole-pixel shift at the coarsest level.
V2d coarse_shift(const LogRaster& reference, const LogRaster& other) {
    const int reach = std::max(reference.size.width, reference.size.height) / 6;
    std::vector<double> differences;
    V2d best(0, 0);
    double least = misfit(reference, other, 0, 0, differences);
    for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
            const double one = misfit(reference, other, dx, dy, differences);
            if (one < least) least = one, best = V2d(dx, dy);
        }
    return best;
}

/// On a tripod photos lie still. A fraction of a pixel that hardly fits better than none is an
/// error: JPEG's errors go together over blocks, and where two photos share little they draw the
/// shift along.
void settle(const LogRaster& reference, const LogRaster& other, Fit& fit) {
    constexpr double kFraction = 0.5, kHardlyBetter = 1.05;
    if (fit.shift.length() > kFraction) return;
    Fit still = fit, here = fit;
    still.shift = V2d(0, 0);
    if (improve(reference, other, still) && improve(reference, other, here) &&
        still.misfit < kHardlyBetter * here.misfit)
        fit.shift = V2d(0, 0);
}

/// Other on reference from a first guess in the finest level's pixels, starting at a level; nothing
/// where they share too little.
std::optional<Fit> fit_from(const LogPyramid& reference, const LogPyramid& other, V2d guess,
                            int level) {
    Fit now;
    now.shift = guess / std::exp2(level);
    bool good = false;
    for (; level >= 0; --level) {
        const auto& a = reference.levels[static_cast<std::size_t>(level)];
        const auto& b = other.levels[static_cast<std::size_t>(level)];
        Fit here = now;
        here.spread = 0.3;
        good = true;
        for (int i = 0; i < 12 && good; ++i) {
            const V2d before = here.shift;
            good = improve(a, b, here);
            if (good && (here.shift - before).length() < 1e-3 && i > 3) break;
        }
        if (good) now = here;
        if (level > 0) now.shift *= 2;
    }
    if (!good) return std::nullopt;
    settle(reference.levels.front(), other.levels.front(), now);
    return now;
}

/// How alike two rasters are at a shift, -1 to 1.
double likeness(const LogRaster& reference, const LogRaster& other, V2d shift) {
    double both = 0, mine = 1e-12, its = 1e-12;
    for (int y = 0; y < reference.size.height; ++y)
        for (int x = 0; x < reference.size.width; ++x) {
            const std::size_t at = reference.at(x, y);
            if (!(reference.weight[at] > 0)) continue;
            const LogSample s = sample(other, x + shift.x, y + shift.y);
            if (!(s.weight > 0)) continue;
            const auto a = static_cast<double>(reference.value[at]);
            const double w = 1 / (1 / s.weight + 1 / static_cast<double>(reference.weight[at]));
            both += w * a * s.value, mine += w * a * a, its += w * s.value * s.value;
        }
    return both / std::sqrt(mine * its);
}

/// As `fit_shift`, in the finest level's pixels, without how alike they are there.
std::optional<Fit> shifted(const LogPyramid& reference, const LogPyramid& other,
                           const std::optional<V2d>& hint) {
    const int coarsest = static_cast<int>(reference.levels.size()) - 1;
    // A few pixels are a fraction of one four levels up.
    if (hint) return fit_from(reference, other, *hint, std::min(coarsest, 4));
    const V2d coarse = coarse_shift(reference.coarsest, other.coarsest);
    auto found = fit_from(reference, other, coarse * std::exp2(coarsest), coarsest);
    if (coarse == V2d(0, 0)) return found;
    // Photos mostly lie nearly still; what is far off has to fit better.
    const auto still = fit_from(reference, other, V2d(0, 0), coarsest);
    if (!still || !found) return still ? still : found;
    const LogRaster &a = reference.levels.front(), &b = other.levels.front();
    return likeness(a, b, still->shift) >= likeness(a, b, found->shift) ? still : found;
}

}  // namespace

std::optional<ShiftFit> fit_shift(const LogPyramid& reference, const LogPyramid& other,
                                  std::optional<V2d> hint, int factor) {
    if (hint) *hint /= factor;
    const auto found = shifted(reference, other, hint);
    if (!found) return std::nullopt;
    return ShiftFit{found->shift * factor, found->deviation * factor,
                    likeness(reference.levels.front(), other.levels.front(), found->shift)};
}

}  // namespace chromeball
