#pragma once

#include <tuple>
#include <variant>

#include "map/angular.h"
#include "map/cube.h"
#include "map/latlong.h"
#include "map/mirror_ball.h"

namespace chromeball {

/// Every projection the toolkit knows. Add yours here; the law tests follow by themselves, and a
/// row in layouts.cpp gives it a name for --layout and --from.
using Projections = std::tuple<LatLong, Cube, Angular, MirrorBall>;

template <class Tuple>
struct VariantOf;
template <class... P>
struct VariantOf<std::tuple<P...>> {
    static_assert((Projection<P> && ...));
    using type = std::variant<P...>;
};

/// One of them; visited once for an image or a row, never for a pixel.
using AnyProjection = VariantOf<Projections>::type;

}  // namespace chromeball
