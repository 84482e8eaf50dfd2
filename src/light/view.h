#pragma once

#include <optional>
#include <span>
#include <vector>

#include "map/orientation.h"
#include "resample/source.h"

namespace chromeball {

/// One view of the light at a place: the ball of a photo, or a map, in its own camera's frame.
struct View {
    Source source;
    /// How far single pixels are to be trusted, 0 to 1, in the first channel of a source with the
    /// same projection: clipped ones little, masked ones not at all. None: all of them.
    std::optional<Source> trust;
};

/// The ball of a photo whose outline or camera is not known for sure.
struct BallModel {
    Outline outline;
    Camera camera;
    bool camera_known = true;  ///< else only its principal point is
    /// How far off the outline may be: a standard deviation of its middle and its radius, pixels;
    /// 0: it is as told.
    double deviation = 0;
};

/// What may be changed of it.
struct BallChange {
    double right = 0, down = 0;   ///< of the outline's middle, pixels
    double growth = 0;            ///< of its axes, a part of them
    double inverse_distance = 0;  ///< 1 / ball radii, where the camera is not known; 0: far away

    bool operator==(const BallChange&) const = default;
};

/// The ball after a change. Nothing where no camera makes it look so.
std::optional<MirrorBall> ball_of(const BallModel& model, const BallChange& change);

/// Radians across a pixel where the view shows finest.
double finest_pixel(const Source& source);

/// A view in ever coarser pictures of log light, to compare it with others.
///
/// Values are log2(x / m + 0.02), x red, green, blue up to 16 m, m the view's own median luminance:
/// exposures differ by a constant, and neither lamps that clip nor noise in shadows weigh much.
class ViewPyramid {
public:
    explicit ViewPyramid(const View& view);

    struct Sample {
        float value[3];
        float weight;  ///< 0: not shown; else the square of how sharply, 0 to 1
    };
    /// What the view shows in directions of the world, averaged over about `angle` radians.
    void sample(std::span<const V3d> world, const Rotation& to_world, double angle,
                std::span<Sample> out) const;

    /// How values change with the place in the picture, per pixel of places().
    struct Slope {
        float right[3], down[3];
    };
    /// The same with the slopes there; those are 0 where nothing is shown.
    void sample(std::span<const V3d> world, const Rotation& to_world, double angle,
                std::span<Sample> out, std::span<Slope> slopes) const;

    /// Where in the picture directions of the world are shown, in its finest pixels; NaN where they
    /// are not.
    void places(std::span<const V3d> world, const Rotation& to_world, std::span<V2d> out) const;
    /// From one place to another, the short way round.
    V2d way(V2d from, V2d to) const;

    const AnyProjection& projection() const { return projection_; }
    /// The same picture taken as that of another ball with the same outline.
    void set_ball(const MirrorBall& ball);
    /// The finest angle that is worth asking for.
    double finest_angle() const { return finest_; }

private:
    std::optional<V2d> position(const MirrorBall& ball, V3d d, double sharp) const;
    template <class P>
    std::optional<V2d> position(const P& projection, V3d d, double) const {
        return projection.to_position(d);
    }
    template <class Work>
    void for_each_place(std::span<const V3d> world, const Rotation& to_world,
                        const Work& work) const;

    AnyProjection projection_;
    std::vector<double> ratios_;  // of a near ball: MirrorBall::view_ratio by v
    Affine to_pixels_;
    bool around_ = false;  // whether the picture's columns go round
    double finest_ = 0;
    std::vector<Image> levels_;  // log light times weight, and weight
};

/// The median luminance of what a picture shows: of its pixels with more than half alpha, colour
/// multiplied by it. 1 where that is nothing.
float median_light(const Image& picture);

/// Directions spread evenly over the sphere. Swinbank, Purser: Fibonacci grids, 2006.
std::vector<V3d> fibonacci_directions(int count);

}  // namespace chromeball
