#include "detect/streaks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/statistics.h"
#include "detect/turned.h"

// What moved evenly by L while the shutter was open is the mean of its picture over a window of
// that length. The slope of such a mean is the difference of the picture at the window's two ends,
// so every edge appears twice along the motion, L apart and with opposite signs: the second
// derivative along the motion is the negative of itself L further on, and its autocorrelation has a
// dip there. Textures have none that is as deep but close to the origin. The dip needs no rim and
// no background, and tells the length to about a pixel.

namespace chromeball::detecting {
namespace {

constexpr double kInside = 0.8;    // of the radius: nearer to the rim all is squeezed
constexpr double kLongest = 0.65;  // motion, of the radius

/// Mean squares and product of slopes, each weighed down by its size, so that a lamp does not speak
/// for all.
struct Slopes {
    double xx = 0, yy = 0, xy = 0;

    double half() const { return 0.5 * (xx + yy); }
    double apart() const { return std::hypot(0.5 * (xx - yy), xy); }
    /// The way along which they are least, radians.
    double heading() const { return 0.5 * std::atan2(-2 * xy, yy - xx); }
};

Slopes slopes_of(const Level& level, const Outline& o) {
    const double reach = kInside * o.b;
    const int margin = 4;  // of the filters
    const cv::Rect all(0, 0, level.grey.size.width, level.grey.size.height);
    const cv::Rect box =
        cv::Rect(cv::Point(cvFloor(o.cx - reach) - margin, cvFloor(o.cy - reach) - margin),
                 cv::Point(cvCeil(o.cx + reach) + margin, cvCeil(o.cy + reach) + margin)) &
        all;
    Slopes slopes;
    if (box.empty()) return slopes;
    cv::Mat smooth, gx, gy;
    cv::GaussianBlur(matrix(level)(box), smooth, cv::Size(0, 0), 1.2);
    cv::Sobel(smooth, gx, CV_32F, 1, 0, 3, 0.125);
    cv::Sobel(smooth, gy, CV_32F, 0, 1, 3, 0.125);
    for (int y = 0; y < box.height; ++y)
        for (int x = 0; x < box.width; ++x) {
            if (std::hypot(box.x + x + 0.5 - o.cx, box.y + y + 0.5 - o.cy) > reach) continue;
            const double u = gx.at<float>(y, x), v = gy.at<float>(y, x);
            const double weight =
                1 / (std::hypot(u, v) + 0.25 * static_cast<double>(level.noise) + 0.004);
            slopes.xx += weight * u * u, slopes.yy += weight * v * v, slopes.xy += weight * u * v;
        }
    return slopes;
}

/// Second derivatives along the rows, of about one size in all rows, none much larger than usual.
cv::Mat bends_of(const Turned& inside, double sigma, bool smooth_across) {
    const cv::Mat across =
        smooth_across ? cv::getGaussianKernel(7, 1, CV_32F) : cv::Mat::ones(1, 1, CV_32F);
    cv::Mat bends;
    cv::sepFilter2D(inside.pixels, bends, CV_32F, bend_kernel(sigma), across, cv::Point(-1, -1), 0,
                    cv::BORDER_REPLICATE);
    bends = bends.mul(inside.mask);
    std::vector<double> sizes;
    for (int y = 0; y < bends.rows; ++y) {
        const double count = std::max(1.0, cv::sum(inside.mask.row(y))[0]);
        sizes.push_back(cv::norm(bends.row(y)) / std::sqrt(count));
    }
    const double usual_size = median(sizes);
    for (int y = 0; y < bends.rows; ++y)
        bends.row(y) /= sizes[static_cast<std::size_t>(y)] + usual_size + 1e-12;
    constexpr double kMost = 1.5;
    const double usual = cv::norm(bends) / std::sqrt(std::max(1.0, cv::sum(inside.mask)[0]));
    cv::min(bends, kMost * usual, bends);
    cv::max(bends, -kMost * usual, bends);
    return bends;
}

/// Of the rows, by lag; 1 at none.
std::vector<double> autocorrelation(const cv::Mat& rows, const cv::Mat& mask, int longest) {
    std::vector<double> result;
    for (int lag = 0; lag <= longest; ++lag) {
        double sum = 0, count = 0;
        for (int y = 0; y < rows.rows; ++y) {
            const float *v = rows.ptr<float>(y), *m = mask.ptr<float>(y);
            float s = 0, c = 0;
            for (int x = 0; x + lag < rows.cols; ++x)
                s += v[x] * v[x + lag], c += m[x] * m[x + lag];
            sum += static_cast<double>(s), count += static_cast<double>(c);
        }
        result.push_back(sum / std::max(count, 1.0));
    }
    const double first = std::max(result.front(), 1e-30);
    for (double& v : result) v /= first;
    return result;
}

/// Dips of an autocorrelation, with the lag to a fraction of a pixel.
struct Dip {
    double lag, clarity;
};

std::vector<Dip> dips_of(const std::vector<double>& a, double sigma) {
    std::vector<Dip> dips;
    const int longest = static_cast<int>(a.size()) - 2;
    const auto at = [&](int lag) { return a[static_cast<std::size_t>(lag)]; };
    const auto highest = [&](int first, int last) {
        return *std::max_element(a.begin() + first, a.begin() + last + 1);
    };
    for (int k = static_cast<int>(2 * sigma) + 1; k < longest; ++k) {
        if (!(at(k) < 0 && at(k) < at(k - 1) && at(k) <= at(k + 1))) continue;
        // The filter's own lobe ends at 2.5 sigma.
        const int before =
            std::min(k, std::max(static_cast<int>(2.5 * sigma), k - static_cast<int>(5 * sigma)));
        const int after = std::min(longest, k + static_cast<int>(6 * sigma));
        const double stands_out = std::min(highest(before, k), highest(k, after)) - at(k);
        const double bend = at(k - 1) - 2 * at(k) + at(k + 1);
        const double shift = bend > 0 ? 0.5 * (at(k - 1) - at(k + 1)) / bend : 0;
        dips.push_back({k + shift, stands_out * std::sqrt(-at(k))});
    }
    return dips;
}

}  // namespace

double smoothness_along(const Level& level, const Outline& outline) {
    const Slopes slopes = slopes_of(level, outline);
    return std::sqrt(std::max(0.0, slopes.half() - slopes.apart()) /
                     std::max(slopes.half() + slopes.apart(), 1e-12));
}

std::vector<Streaks> streaks_of(const Level& level, const Outline& outline, std::size_t most) {
    constexpr double kTurn = 5 * std::numbers::pi / 180;
    constexpr int kTurns = 3;  // to either side of where slopes are least
    struct Filter {
        double sigma;
        bool smooth_across;
    };
    std::vector<Streaks> found;
    if (!(outline.b > 12)) return found;
    const double heading = slopes_of(level, outline).heading();
    const int longest = static_cast<int>(kLongest * outline.b);
    for (int turn = -kTurns; turn <= kTurns; ++turn) {
        const double way = heading + turn * kTurn;
        const Turned inside = turned(level, outline, way, kInside * outline.b);
        for (const auto& [sigma, smooth_across] : {Filter{1.2, false}, Filter{2.2, true}}) {
            const cv::Mat bends = bends_of(inside, sigma, smooth_across);
            for (const Dip& dip : dips_of(autocorrelation(bends, inside.mask, longest), sigma))
                found.push_back({V2d(std::cos(way), std::sin(way)) * dip.lag, dip.clarity});
        }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Streaks& a, const Streaks& b) { return a.clarity > b.clarity; });
    std::vector<Streaks> kept;
    for (const Streaks& s : found) {
        if (kept.size() == most) break;
        const double length = s.motion.length();
        if (std::none_of(kept.begin(), kept.end(), [&](const Streaks& k) {
                return std::abs(k.motion.length() - length) < std::max(1.5, 0.1 * length);
            }))
            kept.push_back(s);
    }
    return kept;
}

V2d settled_motion(const Level& level, const Outline& outline, const V2d& first) {
    constexpr double kReach = 0.13;  // of the motion
    constexpr double kSigma = 1.2;
    const double length = first.length();
    if (!(length > 1) || !(outline.b > 12)) return first;
    const double heading = std::atan2(first.y, first.x);
    const Turned inside = turned(level, outline, heading, kInside * outline.b);
    const cv::Mat bends = bends_of(inside, kSigma, false);
    const int reach = std::max(2, cvCeil(kReach * length)), middle = cvRound(length);
    // Products of what lies (middle + i, j) apart: least where edges meet their own second ends.
    cv::Mat1d products(2 * reach + 1, 2 * reach + 1);
    for (int j = -reach; j <= reach; ++j)
        for (int i = -reach; i <= reach; ++i) {
            const int lag = middle + i;
            const cv::Rect one(0, std::max(0, -j), bends.cols - lag, bends.rows - std::abs(j));
            const cv::Rect other(lag, std::max(0, j), one.width, one.height);
            if (lag < 1 || one.width < 1 || one.height < 1) {
                products(j + reach, i + reach) = 0;
                continue;
            }
            const double count = inside.mask(one).dot(inside.mask(other));
            products(j + reach, i + reach) = bends(one).dot(bends(other)) / std::max(count, 1.0);
        }
    cv::Point at;
    cv::minMaxLoc(products, nullptr, nullptr, &at, nullptr);
    if (at.x == 0 || at.y == 0 || at.x == 2 * reach || at.y == 2 * reach) return first;
    const auto top = [](double before, double here, double after) {
        const double bend = before - 2 * here + after;
        return bend > 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
    };
    const double along = middle + at.x - reach +
                         top(products(at.y, at.x - 1), products(at), products(at.y, at.x + 1));
    const double across =
        at.y - reach + top(products(at.y - 1, at.x), products(at), products(at.y + 1, at.x));
    const V2d way = first / length;
    return way * along + V2d(-way.y, way.x) * across;
}

}  // namespace chromeball::detecting
