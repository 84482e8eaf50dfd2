#include "light/grey_facets.h"

#include <algorithm>
#include <cmath>

#include "light/view.h"

namespace chromeball {
namespace {

/// The part of an even light that the mirror ball hides from a place on the grey one.
double hidden_part(V3d normal, const BallBeside& mirror, const std::vector<V3d>& directions) {
    double hidden = 0, all = 0;
    for (const V3d& d : directions) {
        const double cosine = std::max(0.0, normal.dot(d));
        all += cosine;
        if (cosine > 0 && mirror.hides(normal, d)) hidden += cosine;
    }
    return hidden / all;
}

}  // namespace

std::vector<GreyFacet> grey_facets(const BallPicture& grey, const std::vector<char>& usable,
                                   const BallBeside& mirror) {
    constexpr int kAcross = 40;  // squares over the ball's width
    const Outline& e = grey.ball.outline();
    const double radius = std::sqrt(e.a * e.b * std::abs(grey.to_pixels.determinant()));
    const int side = std::max(1, static_cast<int>(2 * radius / kAcross));
    const int columns = grey.pixels->width() / side + 1;
    std::vector<GreyFacet> cells(static_cast<std::size_t>(columns) *
                                 static_cast<std::size_t>(grey.pixels->height() / side + 1));
    for_ball(grey, [&](int x, int y, const ShownByBall& shown) {
        const auto at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(grey.pixels->width()) +
            static_cast<std::size_t>(x);
        if (!usable[at]) return;
        // Away from the rim, where lens blur mixes in what is behind, and paint is no diffuser.
        constexpr double kGrazing = 0.35;
        if (-shown.normal.dot(shown.view) < kGrazing) return;
        GreyFacet& cell =
            cells[static_cast<std::size_t>(y / side) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(x / side)];
        cell.normal += shown.normal;
        ++cell.pixels;
        for (std::size_t c = 0; c < 3; ++c)
            cell.shown[c] += static_cast<double>(grey.pixels->pixel(x, y)[c]);
    });
    const auto directions = fibonacci_directions(1000);
    std::vector<GreyFacet> facets;
    for (GreyFacet cell : cells) {
        if (cell.pixels < std::max(1, side * side / 8)) continue;
        cell.normal.normalize();
        // What the mirror ball throws there in place of what it hides (lamps drawn out, itself) is
        // not known well; facing it that would be a third of the light.
        constexpr double kMost = 0.05;
        if (hidden_part(cell.normal, mirror, directions) > kMost) continue;
        for (double& v : cell.shown) v /= cell.pixels;
        facets.push_back(cell);
    }
    return facets;
}

}  // namespace chromeball
