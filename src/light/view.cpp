#include "light/view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/luminance.h"
#include "core/parallel.h"
#include "core/statistics.h"
#include "map/layouts.h"
#include "resample/resample.h"

namespace chromeball {
namespace {

using std::numbers::pi;

/// Below that part of the median light noise is all there is; above the other lamps may clip.
constexpr float kFloor = 0.02F, kCeiling = 16;

/// Means of 2 x 2 pixels, by weight.
Image halved(const Image& image) {
    Image out({std::max(1, image.width() / 2), std::max(1, image.height() / 2)}, 4);
    for_each_band(out.height(), 16, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < out.width(); ++x) {
                float* to = out.pixel(x, y);
                for (int k = 0; k < 4; ++k) {
                    const float* p = image.pixel(std::min(2 * x + k % 2, image.width() - 1),
                                                 std::min(2 * y + k / 2, image.height() - 1));
                    for (int c = 0; c < 4; ++c) to[c] += 0.25F * p[c];
                }
            }
    });
    return out;
}

Image log_light(const Image& image, float median) {
    Image out(image.size(), 4);
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x) {
            const float* p = image.pixel(x, y);
            float* to = out.pixel(x, y);
            if (!(p[3] > 0)) continue;
            for (int c = 0; c < 3; ++c) {
                const float part = std::clamp(p[c] / (p[3] * median), 0.0F, kCeiling);
                to[c] = p[3] * std::log2(part + kFloor);
            }
            to[3] = p[3];
        }
    return out;
}

/// How a view shows a direction: the finest angle that a pixel spans anywhere over the coarsest one
/// that it spans there. Of a distant ball cos(theta / 2), theta the angle from the camera, and
/// nearly so of a near one; of a map as good as 1.
template <class P>
double sharpness_of(const P& projection, V3d d) {
    if constexpr (std::is_same_v<P, MirrorBall>) {
        return std::sqrt(std::max(0.0, 0.5 * (1 + projection.facing(d))));
    } else {
        return 1;
    }
}

}  // namespace

float median_light(const Image& picture) {
    std::vector<double> light;
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const float* p = picture.pixel(x, y);
            if (p[3] > 0.5F) light.push_back(luminance(p) / static_cast<double>(p[3]));
        }
    const double middle = median(std::move(light));
    return middle > 0 ? static_cast<float>(middle) : 1;
}

std::optional<MirrorBall> ball_of(const BallModel& model, const BallChange& change) {
    Outline outline = model.outline;
    outline.cx += change.right;
    outline.cy += change.down;
    outline.a *= 1 + change.growth;
    outline.b *= 1 + change.growth;
    Camera camera = model.camera;
    if (!model.camera_known)
        camera.focal =
            change.inverse_distance > 0
                ? focal_from_distance(outline, camera.principal, 1 / change.inverse_distance)
                : std::nullopt;
    if (camera.orthographic()) {
        if (model.camera_known || !(change.inverse_distance > 0)) return MirrorBall(outline);
        return std::nullopt;
    }
    const Cone cone = cone_of(outline, camera);
    if (!(cone.half_angle > 0 && cone.half_angle < 0.49 * pi)) return std::nullopt;
    return MirrorBall(camera, cone);
}

double finest_pixel(const Source& source) {
    // In its middle a ball of radius r turns a pixel into 2 / r.
    if (source.ball) return 2 / source.ball->b;
    return std::sqrt(source.mean_solid_angle);
}

ViewPyramid::ViewPyramid(const View& view) : projection_(view.source.projection) {
    if (const auto* ball = std::get_if<MirrorBall>(&projection_)) set_ball(MirrorBall(*ball));
    Image linear;
    if (view.source.ball) {
        linear = view.source.pixels;
        to_pixels_ = view.source.to_pixels;
        finest_ = finest_pixel(view.source);
    } else {
        constexpr int kHeight = 512;  // 0.35 degrees are fine enough: refinement sees parts of it
        const Layout& latlong = *find_layout("latlong");
        linear = resample(view.source, latlong, kHeight);
        projection_ = LatLong();
        to_pixels_ = scale(linear.width(), linear.height());
        around_ = true;
        finest_ = pi / kHeight;
    }
    const float median = median_light(linear);
    while (true) {
        levels_.push_back(log_light(linear, median));
        if (std::min(linear.width(), linear.height()) < 8) break;
        linear = halved(linear);
    }
}

/// Entries of the table of view_ratio, whose second differences are then below 1e-6 of it.
constexpr int kRatios = 1024;

void ViewPyramid::set_ball(const MirrorBall& ball) {
    projection_ = ball;
    ratios_.clear();
    if (ball.orthographic()) return;
    for (int i = 0; i <= kRatios; ++i)
        ratios_.push_back(ball.view_ratio(std::max(1e-3, static_cast<double>(i) / kRatios)));
}

std::optional<V2d> ViewPyramid::position(const MirrorBall& ball, V3d d, double sharp) const {
    if (ball.orthographic()) return ball.to_position(d);
    // As MirrorBall::to_position, with a table in place of Newton's steps; sharp is cos(theta / 2).
    const double at = std::min(sharp, 1.0) * kRatios;
    const auto low = std::min(static_cast<std::size_t>(at), ratios_.size() - 2);
    const double part = at - static_cast<double>(low);
    const double ratio =
        ((1 - part) * ratios_[low] + part * ratios_[low + 1]) / (2 * std::max(sharp, 1e-3));
    const V3d axis = ball.axis();
    const V3d q = axis + (d - axis * d.dot(axis)) * ratio;
    if (!(q.z < 0)) return std::nullopt;
    const V2d p = ball.distortion().distorted(V2d(-q.x / q.z, q.y / q.z));
    return ball.principal() + p * ball.focal();
}

/// Calls work(index, place in the picture, weight) for all directions that are shown.
template <class Work>
void ViewPyramid::for_each_place(std::span<const V3d> world, const Rotation& to_world,
                                 const Work& work) const {
    const Rotation to_camera = to_world.inverse();
    // Below that the rim's pixels span so much that they tell nothing; the hidden cone is there.
    constexpr double kLeast = 0.12;
    std::visit(
        [&]<class P>(const P& projection) {
            double hidden = -2;
            if constexpr (std::is_same_v<P, MirrorBall>)
                hidden = -std::cos(projection.hidden_half_angle());
            for_each_band(static_cast<int>(world.size()), 512, [&](int first, int last) {
                for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last);
                     ++i) {
                    const V3d d = to_camera * world[i];
                    const double sharp = sharpness_of(projection, d);
                    if (sharp < kLeast) continue;
                    if constexpr (std::is_same_v<P, MirrorBall>)
                        if (projection.facing(d) <= hidden) continue;
                    if (const auto place = position(projection, d, sharp))
                        work(i, to_pixels_(*place), static_cast<float>(sharp * sharp));
                }
            });
        },
        projection_);
}

void ViewPyramid::sample(std::span<const V3d> world, const Rotation& to_world, double angle,
                         std::span<Sample> out) const {
    sample(world, to_world, angle, out, {});
}

void ViewPyramid::sample(std::span<const V3d> world, const Rotation& to_world, double angle,
                         std::span<Sample> out, std::span<Slope> slopes) const {
    const int wanted = static_cast<int>(std::lround(std::log2(std::max(1.0, angle / finest_))));
    const int level = std::min(wanted, static_cast<int>(levels_.size()) - 1);
    const Image& picture = levels_[static_cast<std::size_t>(level)];
    const double shrink = 1.0 / (1 << level);
    const auto column = [&](int x) {
        if (!around_) return std::clamp(x, 0, picture.width() - 1);
        return (x % picture.width() + picture.width()) % picture.width();
    };
    /// False where nothing is shown.
    const auto value_at = [&](double x, double y, float* value) {
        const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
        const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
        float sum[4] = {};
        for (int k = 0; k < 4; ++k) {
            const float w = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy);
            const float* from =
                picture.pixel(column(x0 + k % 2), std::clamp(y0 + k / 2, 0, picture.height() - 1));
            for (int c = 0; c < 4; ++c) sum[c] += w * from[c];
        }
        if (!(sum[3] > 0.01F)) return 0.0F;
        for (int c = 0; c < 3; ++c) value[c] = sum[c] / sum[3];
        return std::min(sum[3], 1.0F);
    };
    std::fill(out.begin(), out.end(), Sample{});
    std::fill(slopes.begin(), slopes.end(), Slope{});
    for_each_place(world, to_world, [&](std::size_t i, V2d place, float weight) {
        const V2d p = place * shrink;
        if (!around_ &&
            !(p.x >= 0 && p.y >= 0 && p.x <= picture.width() && p.y <= picture.height()))
            return;
        const double x = p.x - 0.5, y = p.y - 0.5;
        out[i].weight = weight * value_at(x, y, out[i].value);
        if (slopes.empty() || !(out[i].weight > 0)) return;
        // As wide as what values are averaged over.
        constexpr double kReach = 0.5;
        float low[3], high[3];
        const auto slope = [&](double dx, double dy, float* to) {
            if (!(value_at(x - dx, y - dy, low) > 0) || !(value_at(x + dx, y + dy, high) > 0))
                return;
            for (int c = 0; c < 3; ++c)
                to[c] = (high[c] - low[c]) * static_cast<float>(shrink / (2 * kReach));
        };
        slope(kReach, 0, slopes[i].right);
        slope(0, kReach, slopes[i].down);
    });
}

void ViewPyramid::places(std::span<const V3d> world, const Rotation& to_world,
                         std::span<V2d> out) const {
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    std::fill(out.begin(), out.end(), V2d(kNowhere, kNowhere));
    for_each_place(world, to_world, [&](std::size_t i, V2d place, float) { out[i] = place; });
}

V2d ViewPyramid::way(V2d from, V2d to) const {
    V2d by = to - from;
    if (around_) by.x -= levels_.front().width() * std::round(by.x / levels_.front().width());
    return by;
}

std::vector<V3d> fibonacci_directions(int count) {
    std::vector<V3d> directions;
    directions.reserve(static_cast<std::size_t>(count));
    const double turn = pi * (3 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(std::max(0.0, 1 - z * z));
        directions.emplace_back(r * std::cos(turn * i), r * std::sin(turn * i), z);
    }
    return directions;
}

}  // namespace chromeball
