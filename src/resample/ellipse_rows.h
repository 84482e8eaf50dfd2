#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "core/outline.h"

namespace chromeball {

/// An outline as the unit disk, and where the rows of pixels cross it.
class EllipseRows {
public:
    EllipseRows() = default;
    explicit EllipseRows(const Outline& outline)
        : cx_(outline.cx),
          cy_(outline.cy),
          cos_(std::cos(outline.angle * std::numbers::pi / 180)),
          sin_(std::sin(outline.angle * std::numbers::pi / 180)),
          a_(outline.a),
          b_(outline.b) {}

    /// A position on the unit disk, u along the long axis, and its first-order distance to the rim,
    /// inwards.
    struct Place {
        double u = 0, v = 0;
        double square = 0;      ///< u^2 + v^2
        double gu = 0, gv = 0;  ///< half the square's gradient along the axes
        double depth() const {  ///< pixels; infinite in the middle
            return (1 - square) / (2 * std::hypot(gu, gv));
        }
    };
    Place at(double x, double y) const {
        const double dx = x - cx_, dy = y - cy_;
        Place p;
        p.u = (dx * cos_ + dy * sin_) / a_;
        p.v = (dy * cos_ - dx * sin_) / b_;
        p.square = p.u * p.u + p.v * p.v;
        p.gu = p.u / a_;
        p.gv = p.v / b_;
        return p;
    }

    struct Span {
        double left, right;
    };
    /// The part of the line y that lies in the ellipse made `scale` times as large; nothing where
    /// it passes by.
    std::optional<Span> span(double y, double scale) const {
        const double p = cos_ * cos_ / (a_ * a_) + sin_ * sin_ / (b_ * b_);
        const double q = cos_ * sin_ * (1 / (a_ * a_) - 1 / (b_ * b_));
        const double r = sin_ * sin_ / (a_ * a_) + cos_ * cos_ / (b_ * b_);
        const double dy = y - cy_;
        const double room = q * q * dy * dy - p * (r * dy * dy - scale * scale);
        if (!(room >= 0) || !(scale > 0)) return std::nullopt;
        const double middle = cx_ - q * dy / p, half = std::sqrt(room) / p;
        return Span{middle - half, middle + half};
    }

    double cosine() const { return cos_; }
    double sine() const { return sin_; }

private:
    double cx_ = 0, cy_ = 0, cos_ = 1, sin_ = 0, a_ = 1, b_ = 1;
};

}  // namespace chromeball
