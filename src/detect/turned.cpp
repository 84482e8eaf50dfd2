#include "detect/turned.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace chromeball::detecting {

cv::Mat matrix(const Level& level) {
    return {level.grey.size.height, level.grey.size.width, CV_32F,
            const_cast<float*>(level.grey.values.data())};
}

Turned turned(const Level& level, const Outline& o, double heading, double reach) {
    const double c = std::cos(heading), s = std::sin(heading);
    const int half = cvFloor(reach), side = 2 * half + 1;
    // Pixel (half, half) of the result is the middle of the outline.
    const cv::Matx23d from(c, -s, o.cx - 0.5 - c * half + s * half, s, c,
                           o.cy - 0.5 - s * half - c * half);
    Turned result;
    cv::warpAffine(matrix(level), result.pixels, from, cv::Size(side, side),
                   cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    result.mask = cv::Mat::zeros(side, side, CV_32F);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const double u = x - half, v = y - half;
            const double px = o.cx + c * u - s * v, py = o.cy + s * u + c * v;
            if (u * u + v * v < reach * reach && px > 0 && py > 0 && px < level.grey.size.width &&
                py < level.grey.size.height)
                result.mask.at<float>(y, x) = 1;
        }
    return result;
}

cv::Mat bend_kernel(double sigma) {
    const int half = cvCeil(4 * sigma);
    cv::Mat kernel(1, 2 * half + 1, CV_32F);
    double sum = 0;
    for (int i = -half; i <= half; ++i) {
        const double z = i / sigma, v = (z * z - 1) * std::exp(-0.5 * z * z);
        kernel.at<float>(0, i + half) = static_cast<float>(v);
        sum += v;
    }
    return kernel - sum / (2 * half + 1);
}

}  // namespace chromeball::detecting
