#include "detect/pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

#include "detect/turned.h"

namespace chromeball::detecting {
namespace {

constexpr int kRays = 160;
constexpr double kStep = 0.5;   // pixels between offsets
constexpr double kReach = 0.3;  // of the radius
constexpr double kMost = 2;     // of a product; they are about 1 where edges are
/// Of a rim before the rest of the ball: all of it is an edge.
constexpr double kRimGain = 1.2;
/// Independent pixels in one: neighbours are filtered alike.
constexpr double kIndependent = 0.1;

/// Second derivatives along the motion, about 1 wherever there are edges.
cv::Mat bends_around(const Turned& around, double sigma, double length) {
    cv::Mat bends, size;
    cv::sepFilter2D(around.pixels, bends, CV_32F, bend_kernel(sigma),
                    cv::getGaussianKernel(5, 0.8, CV_32F), cv::Point(-1, -1), 0,
                    cv::BORDER_REPLICATE);
    cv::GaussianBlur(bends.mul(bends), size, cv::Size(0, 0), std::max(6.0, length), 3);
    cv::sqrt(size, size);
    const double usual = cv::sum(size.mul(around.mask))[0] / std::max(1.0, cv::sum(around.mask)[0]);
    size += 0.3 * usual + 1e-9;
    return bends / size;
}

}  // namespace

Pairs::Pairs(const Level& level, const Outline& start, const V2d& motion)
    : base_(shape_of(start)), rays_(rays_of(start, kRays)) {
    const double length = motion.length(), r = base_.radius, half_length = 0.5 * length;
    const double sigma = std::max(1.2, 0.1 * length);
    const double heading = std::atan2(motion.y, motion.x), c = std::cos(heading),
                 s = std::sin(heading);
    const double reach = (1 + kReach) * start.a + half_length + 2;
    const Turned around = turned(level, start, heading, reach);
    const cv::Mat bends = bends_around(around, sigma, length);
    const int side = bends.cols, middle = side / 2;

    // NaN where it is not known.
    const auto at = [&](const cv::Mat& m, double x, double y) {
        const int i = cvFloor(x), j = cvFloor(y);
        if (i < 0 || j < 0 || i + 1 >= side || j + 1 >= side) return 0.0;
        const float *top = m.ptr<float>(j), *bottom = m.ptr<float>(j + 1);
        const double u = x - i, v = y - j;
        return (1 - v) *
                   ((1 - u) * static_cast<double>(top[i]) + u * static_cast<double>(top[i + 1])) +
               v * ((1 - u) * static_cast<double>(bottom[i]) +
                    u * static_cast<double>(bottom[i + 1]));
    };
    cv::Mat pairs = cv::Mat::zeros(side, side, CV_32F);
    double sum = 0, squares = 0, count = 0;
    std::array<double, 2> ring{}, ring_size{};  // right inside and right outside of the rim
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            if (at(around.mask, x - half_length, y) * at(around.mask, x + half_length, y) < 1)
                continue;
            const double pair = std::clamp(
                -at(bends, x - half_length, y) * at(bends, x + half_length, y), -kMost, kMost);
            pairs.at<float>(y, x) = static_cast<float>(pair);
            const double rho = std::hypot(x - middle, y - middle) / r;
            if (rho > 0.8 && rho < 1.2) {
                const std::size_t side_of = rho > 1;
                const bool at_rim = std::abs(rho - 1) * r < 1.5 * sigma;
                if (side_of == 0 || !at_rim) ring[side_of] += pair, ring_size[side_of] += 1;
            }
            if (rho > 0.8) continue;
            sum += pair, squares += pair * pair, count += 1;
        }
    const double mean = std::max(0.0, sum / std::max(count, 1.0));
    const auto density = [&](std::size_t i) { return ring[i] / std::max(ring_size[i], 1.0); };
    ending_ = (density(0) - density(1)) / std::max(mean, 0.02);
    const double variance = std::max(squares / std::max(count, 1.0) - mean * mean, 1e-6);
    const double weight = kIndependent * mean / variance;  // of a pixel, for normal noise

    half_ = cvCeil(kReach * r / kStep);
    const double rim = kRimGain * sigma;
    for (const Ray& ray : rays_) {
        double all = 0;
        const double arc = 2 * CV_PI * r / kRays;
        for (int k = -half_; k <= half_; ++k) {
            const double d = k * kStep;
            const double px = ray.x + d * ray.nx - start.cx, py = ray.y + d * ray.ny - start.cy;
            const double x = c * px + s * py + middle, y = c * py - s * px + middle;
            const double known = at(around.mask, x, y);
            const double pair = at(pairs, x, y);
            all += known * (pair - 0.5 * mean) * kStep * (1 + d / r);
            inside_.push_back(static_cast<float>(weight * arc * (all + rim * pair)));
        }
    }
}

double Pairs::evidence(const Shape& shape) const {
    const double r = base_.radius, dx = shape.x - base_.x, dy = shape.y - base_.y;
    const double dr = shape.radius - r, d1 = r * (shape.e1 - base_.e1),
                 d2 = r * (shape.e2 - base_.e2);
    double sum = 0;
    const float* row = inside_.data();
    for (const Ray& ray : rays_) {
        const double offset = ray.nx * dx + ray.ny * dy + dr + ray.cos2 * d1 + ray.sin2 * d2;
        const double at = std::clamp(offset / kStep + half_, 0.0, 2 * half_ - 0.001);
        const auto i = static_cast<std::size_t>(at);
        const double u = at - static_cast<double>(i);
        sum += (1 - u) * static_cast<double>(row[i]) + u * static_cast<double>(row[i + 1]);
        row += 2 * half_ + 1;
    }
    return sum;
}

}  // namespace chromeball::detecting
