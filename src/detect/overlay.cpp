#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/luminance.h"
#include "detect/detect.h"
#include "detect/grey.h"

namespace chromeball {
namespace {

using detecting::Grey;

constexpr int kFraction = 4;  // bits of sub-pixel position in OpenCV's drawing

const cv::Scalar kFound(60, 255, 60), kDoubtful(255, 180, 0), kOther(90, 160, 255);
const cv::Scalar kShadow(0, 0, 0);

std::uint8_t srgb(float light) {
    const double v = std::clamp<double>(light, 0, 1);
    const double code = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255 * code));
}

/// A pixel's colour with a luminance of 1; white where it tells none.
V3d tint_of(const Photo& photo, std::size_t pixel) {
    const auto channels = static_cast<std::size_t>(photo.channels);
    if (channels < 3) return V3d(1);
    float color[3];
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = pixel * channels + c;
        if (photo.type == PixelType::f16)
            color[c] = static_cast<float>(reinterpret_cast<const half*>(photo.pixels.data())[at]);
        else
            color[c] = reinterpret_cast<const float*>(photo.pixels.data())[at];
        if (!(color[c] >= 0 && color[c] < 1e30F)) return V3d(1);
    }
    const double light = luminance(color);
    return light > 1e-30 ? V3d(Imath::V3f(color[0], color[1], color[2])) / light : V3d(1);
}

/// Codes of integers as they are; floats by the curve of the picture that detection looked at,
/// because in that the outline can be judged, in their own colours.
Photo canvas_of(const Photo& photo) {
    Photo out;
    out.name = photo.name;
    out.type = PixelType::u8;
    out.channels = 3;
    out.window = photo.window;
    out.display = photo.display;
    out.color.space = "srgb_texture";
    const std::size_t count = photo.window.size.pixels();
    out.pixels.resize(3 * count);
    auto* to = reinterpret_cast<std::uint8_t*>(out.pixels.data());
    if (is_integer(photo.type)) {
        const auto channels = static_cast<std::size_t>(photo.channels);
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(photo.pixels.data());
        const auto* words = reinterpret_cast<const std::uint16_t*>(photo.pixels.data());
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t from = i * channels + (channels < 3 ? 0 : c);
                to[3 * i + c] = photo.type == PixelType::u8
                                    ? bytes[from]
                                    : static_cast<std::uint8_t>(words[from] >> 8);
            }
        return out;
    }
    const Grey grey = detecting::grey_of(photo);
    for (std::size_t i = 0; i < count; ++i) {
        const float part = static_cast<float>(grey.pixels.values[i]) / 65535.f;
        const V3d color = tint_of(photo, i) * static_cast<double>(part * part);
        for (int c = 0; c < 3; ++c)
            to[3 * i + static_cast<std::size_t>(c)] = srgb(static_cast<float>(color[c]));
    }
    return out;
}

/// A continuous position in OpenCV's fixed point, whose integers are pixel centres.
cv::Point fixed(double x, double y) {
    const auto code = [](double v) {
        return static_cast<int>(std::lround((v - 0.5) * (1 << kFraction)));
    };
    return {code(x), code(y)};
}

void draw_ellipse(cv::Mat& canvas, const Outline& o, const cv::Scalar& color, int thickness) {
    std::vector<cv::Point> points;
    for (int i = 0; i < 720; ++i) {
        const V2d p = rim_point(o, i * CV_PI / 360);
        points.push_back(fixed(p.x, p.y));
    }
    cv::polylines(canvas, points, true, color, thickness, cv::LINE_AA, kFraction);
}

void draw_cross(cv::Mat& canvas, double x, double y, double arm, const cv::Scalar& color,
                int thickness) {
    cv::line(canvas, fixed(x - arm, y), fixed(x + arm, y), color, thickness, cv::LINE_AA,
             kFraction);
    cv::line(canvas, fixed(x, y - arm), fixed(x, y + arm), color, thickness, cv::LINE_AA,
             kFraction);
}

}  // namespace

Photo overlay(const Photo& photo, const std::vector<Candidate>& candidates, double threshold) {
    Photo out = canvas_of(photo);
    const Size size = out.window.size;
    if (size.pixels() == 0) return out;
    cv::Mat canvas(size.height, size.width, CV_8UC3, out.pixels.data());
    const int unit = std::max(1, std::max(size.width, size.height) / 1000);

    // The best one last, so that it lies on top.
    for (std::size_t i = candidates.size(); i-- > 0;) {
        const Candidate& ball = candidates[i];
        Outline o = ball.outline;
        o.cx -= out.window.x;
        o.cy -= out.window.y;
        const bool best = i == 0;
        const cv::Scalar color = !best ? kOther : ball.confidence >= threshold ? kFound : kDoubtful;
        draw_ellipse(canvas, o, color, best ? 2 * unit : unit);
        if (best) draw_cross(canvas, o.cx, o.cy, std::max(4.0, 0.03 * o.b), color, unit);
        const auto text = fmt::format("{:.2f}", ball.confidence);
        const cv::Point where(static_cast<int>(o.cx) + 6 * unit, static_cast<int>(o.cy) - 6 * unit);
        const double height = 0.5 * unit;
        cv::putText(canvas, text, where, cv::FONT_HERSHEY_SIMPLEX, height, kShadow, 3 * unit);
        cv::putText(canvas, text, where, cv::FONT_HERSHEY_SIMPLEX, height, color, unit);
    }
    return out;
}

}  // namespace chromeball
