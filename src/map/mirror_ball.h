#pragma once

#include <array>
#include <numbers>

#include "core/outline.h"
#include "map/camera.h"
#include "map/projection.h"

namespace chromeball {

/// A unit mirror sphere in a photo: position in the photo <-> the direction that is mirrored there,
/// in the camera frame.
///
/// Far away (orthographic): with (s, t) on the unit disk, n = (s, t, sqrt(1 - s^2 - t^2)) and
/// v = (0, 0, 1), r = 2 (n.v) n - v; back, (s, t) = (X, Y) / sqrt(2 L (L + Z)), L the length of r.
/// From a pinhole D radii away the ray q hits p = t q, n = p - C, r = q - 2 (q.n) n; back, see
/// normal_angle(). The default is the map that Debevec calls a mirror ball: the orthographic ball
/// that fills the unit square, its middle +Z.
class MirrorBall {
public:
    static constexpr std::string_view name = "mirror-ball";

    MirrorBall() : MirrorBall(Outline{0.5, 0.5, 0.5, 0.5, 0}) {}
    /// Seen from infinitely far away; an ellipse is taken as a stretched circle.
    explicit MirrorBall(const Outline& outline);
    /// Seen by a pinhole camera (camera.focal must be there) as the ball whose cone is given.
    MirrorBall(const Camera& camera, const Cone& cone);

    bool orthographic() const { return orthographic_; }
    /// Unit vector from the camera to the ball's centre; (0, 0, -1) if orthographic.
    V3d axis() const { return axis_; }
    /// In ball radii; infinite if orthographic.
    double distance() const;
    /// Half-angle of the hidden cone around axis(), radians; 0 if orthographic.
    double hidden_half_angle() const { return orthographic_ ? 0 : half_angle_; }
    /// The ellipse that the ball fills in the photo.
    const Outline& outline() const { return outline_; }

    // Numbers of the formulas, for those who evaluate them for many directions at once. With theta
    // and phi a direction's angles around the line to the camera, the distant ball shows it at
    // (s, t) = sin(theta / 2) (cos phi, sin phi) of its disk; from a pinhole the ray has the
    // direction axis + view_ratio(cos(theta / 2)) (s e1 + t e2), e1 and e2 unit vectors across.

    /// tan(view angle) / sin(theta / 2) of a near ball; smooth in v = cos(theta / 2), 0 < v <= 1.
    double view_ratio(double v) const;
    /// Of a distant ball: (s, t), t up -> offset from the outline's centre in the photo.
    std::array<double, 4> from_disk() const {
        return {from_disk_[0], from_disk_[1], from_disk_[2], from_disk_[3]};
    }
    /// Of a near ball: the camera's focal length and the rest.
    double focal() const { return focal_; }
    V2d principal() const { return principal_; }
    const Distortion& distortion() const { return distortion_; }
    /// See curved().
    double curved_cosine() const { return curved_cosine_; }

    template <class T>
    std::optional<Vec3<T>> to_direction(const Vec2<T>& position) const {
        return orthographic_ ? distant_direction(position) : near_direction(position);
    }
    template <class T>
    std::optional<Vec2<T>> to_position(const Vec3<T>& d) const {
        return orthographic_ ? distant_position(d) : near_position(d);
    }
    double solid_angle(V2d position) const;
    /// Unit vector from the camera through a position, in the camera's frame.
    V3d ray(V2d position) const { return orthographic_ ? V3d(0, 0, -1) : near_ray(position); }
    /// Beyond 150 degrees from the direction towards the camera, and near the hidden cone.
    bool curved(V3d d) const { return d.dot(axis_) > curved_cosine_; }

    /// Cosine of the angle between a unit direction and that from the ball towards the camera.
    double facing(V3d d) const { return -d.dot(axis_); }

private:
    template <class T>
    std::optional<Vec3<T>> distant_direction(const Vec2<T>& position) const {
        using std::sqrt;
        const T dx = position.x - T(outline_.cx), dy = position.y - T(outline_.cy);
        const T s = T(to_disk_[0]) * dx + T(to_disk_[1]) * dy;
        const T t = T(to_disk_[2]) * dx + T(to_disk_[3]) * dy;
        const T square = s * s + t * t;
        if (value_of(square) > 1) return std::nullopt;
        const T n = sqrt(T(1.0) - square);
        return Vec3<T>(T(2.0) * n * s, T(2.0) * n * t, T(1.0) - T(2.0) * square);
    }

    template <class T>
    std::optional<Vec2<T>> distant_position(const Vec3<T>& d) const {
        using std::sqrt;
        const T across = d.x * d.x + d.y * d.y;
        const T length = sqrt(across + d.z * d.z);
        if (value_of(across) == 0 && value_of(d.z) <= 0) return std::nullopt;  // the rim, all of it
        // L + Z loses its digits towards the back pole; there it is (X^2 + Y^2) / (L - Z).
        const T sum = value_of(d.z) < 0 ? across / (length - d.z) : length + d.z;
        const T scale = T(1.0) / sqrt(T(2.0) * length * sum);
        const T s = d.x * scale, t = d.y * scale;
        return Vec2<T>(T(outline_.cx) + T(from_disk_[0]) * s + T(from_disk_[1]) * t,
                       T(outline_.cy) + T(from_disk_[2]) * s + T(from_disk_[3]) * t);
    }

    template <class T>
    Vec3<T> near_ray(const Vec2<T>& position) const {
        const Vec2<T> p =
            distortion_.undistorted(Vec2<T>((position.x - T(principal_.x)) * T(1 / focal_),
                                            (position.y - T(principal_.y)) * T(1 / focal_)));
        return unit(Vec3<T>(p.x, -p.y, T(-1.0)));
    }

    template <class T>
    std::optional<Vec3<T>> near_direction(const Vec2<T>& position) const {
        using std::sqrt;
        const Vec3<T> q = near_ray(position);
        const T cosine = along(q, axis_);
        // The ray passes the centre at D sin(alpha); as a cross product it keeps its digits.
        const Vec3<T> c = constant<T>(axis_);
        const Vec3<T> side(q.y * c.z - q.z * c.y, q.z * c.x - q.x * c.z, q.x * c.y - q.y * c.x);
        const T room = T(1.0) - T(distance_ * distance_) * dot(side, side);
        if (value_of(room) < 0 || value_of(cosine) <= 0) return std::nullopt;
        const T root = sqrt(room);
        const T t = T(distance_) * cosine - root;
        const Vec3<T> n(t * q.x - T(distance_) * c.x, t * q.y - T(distance_) * c.y,
                        t * q.z - T(distance_) * c.z);
        // q.n = -root: n is where the ray enters the unit sphere.
        return unit(Vec3<T>(q.x + T(2.0) * root * n.x, q.y + T(2.0) * root * n.y,
                            q.z + T(2.0) * root * n.z));
    }

    template <class T>
    std::optional<Vec2<T>> near_position(const Vec3<T>& any_length) const {
        using std::atan2, std::sin, std::cos;
        const Vec3<T> d = unit(any_length);
        const T behind = along(d, axis_);
        const Vec3<T> across(d.x - behind * T(axis_.x), d.y - behind * T(axis_.y),
                             d.z - behind * T(axis_.z));
        const T sine = length_of(length_of(across.x, across.y), across.z);
        const T theta = atan2(sine, -behind);
        if (value_of(theta) >= std::numbers::pi - half_angle_) return std::nullopt;
        // tan(alpha) / sin(theta), alpha the view angle; towards the camera its limit.
        T ratio(1 / (2 * distance_ - 1));
        if (value_of(sine) > 1e-9) {
            const T f = normal_angle(theta);
            ratio = sin(f) / (T(distance_) - cos(f)) / sine;
        }
        const Vec3<T> q(T(axis_.x) + ratio * across.x, T(axis_.y) + ratio * across.y,
                        T(axis_.z) + ratio * across.z);
        if (value_of(q.z) >= 0) return std::nullopt;
        const Vec2<T> p = distortion_.distorted(Vec2<T>(-q.x / q.z, q.y / q.z));
        return Vec2<T>(T(principal_.x) + T(focal_) * p.x, T(principal_.y) + T(focal_) * p.y);
    }

    /// The angle f between the normal and the line to the camera where the reflection makes theta
    /// with that line: theta = 2 f + b(f), b = atan2(sin f, D - cos f) the view angle. Monotonic.
    double normal_angle(double theta) const;
    Dual normal_angle(const Dual& theta) const {
        const double f = normal_angle(theta.value);
        return chain(theta, f, 1 / reflection_slope(f));
    }
    /// d theta / d f.
    double reflection_slope(double f) const;

    bool orthographic_ = true;
    Outline outline_;
    double to_disk_[4] = {};    // photo offset -> (s, t), t up
    double from_disk_[4] = {};  // and back
    V3d axis_{0, 0, -1};
    double distance_ = 0;
    double half_angle_ = 0;
    static constexpr double kCos30 = 0.8660254037844386;
    double curved_cosine_ = kCos30;
    double focal_ = 0;
    V2d principal_{0, 0};
    Distortion distortion_;
};

}  // namespace chromeball
