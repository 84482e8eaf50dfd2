#pragma once

#include <array>
#include <optional>

#include "core/outline.h"
#include "detect/detect.h"

namespace chromeball::detecting {

/// What the options ask for, in pixels of the picture that is searched.
struct Wish {
    std::optional<V2d> near;
    std::optional<std::array<double, 2>> radius_range;
    std::optional<Outline> start;
    std::optional<V2d> motion;
    bool expected = false;
};

/// In pixels of the photo's window.
Wish wish_of(const DetectOptions& options, const Photo& photo);

/// The same in a picture that is so many times as large.
Wish scaled(const Wish& wish, double scale);

/// Whether it can be the ball asked for, with a tolerance for a first rough outline.
bool wanted(const Outline& outline, const Wish& wish, double tolerance);

}  // namespace chromeball::detecting
