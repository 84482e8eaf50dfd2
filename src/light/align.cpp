#include "light/align.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/parallel.h"
#include "light/log_raster.h"
#include "light/shift_fit.h"

namespace chromeball {
namespace {

/// Finer than this is not worth the time: shifts are found to hundredths of a raster's pixel.
constexpr int kLongest = 1600;

int factor_of(const Window& window) {
    return 1 + (std::max(window.size.width, window.size.height) - 1) / kLongest;
}

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// A bracket's photos as they are compared: by the region, or by the whole picture.
class Comparison {
public:
    Comparison(std::span<const ExposedPhoto> photos, std::span<const int> order,
               const Response& response, const AlignOptions& options, const Watch& watch)
        : photos_(photos),
          response_(response),
          options_(options),
          watch_(watch),
          channel_(channel_to_compare(photos, order)),
          all_{0, 0, photos.front().size},
          region_(options.region.value_or(all_)),
          by_region_(photos.size()),
          by_all_(photos.size()) {
        const auto count = static_cast<int>(order.size());
        for (int i = 0; i < count; ++i) {
            const int photo = order[index(i)];
            const auto beside = [&](int j) {
                return j >= 0 && j < count && whole(order[index(j)]);
            };
            if (whole(photo) || beside(i - 1) || beside(i + 1))
                by_all_[index(photo)] = pyramid_of(photo, all_);
            if (!whole(photo)) by_region_[index(photo)] = pyramid_of(photo, region_);
            watch_.check();
        }
    }

    /// A photo on its neighbour in the order, by what is to be compared of the two.
    std::optional<ShiftFit> fit(int photo, int neighbour) const {
        const bool wide = whole(photo) || whole(neighbour);
        const auto here = hint(photo), there = hint(neighbour);
        std::optional<V2d> between;
        if (here && there) between = *here - *there;
        const auto& made = wide ? by_all_ : by_region_;
        return fit_shift(made[index(neighbour)], made[index(photo)], between,
                         factor_of(wide ? all_ : region_));
    }

    /// A photo on any other by the whole picture, whatever the hints say.
    std::optional<ShiftFit> fit_by_whole_picture(int photo, int other) {
        for (const int i : {photo, other})
            if (LogPyramid& made = by_all_[index(i)]; made.levels.empty())
                made = pyramid_of(i, all_);
        watch_.check();
        return fit_shift(by_all_[index(other)], by_all_[index(photo)], std::nullopt,
                         factor_of(all_));
    }

    std::optional<V2d> hint(int photo) const {
        if (options_.hints.empty()) return std::nullopt;
        return options_.hints[index(photo)];
    }

private:
    bool whole(int photo) const {
        return !options_.region || (!options_.whole.empty() && options_.whole[index(photo)]);
    }
    LogPyramid pyramid_of(int photo, const Window& window) const {
        return log_pyramid(
            log_raster(photos_[index(photo)], response_, window, factor_of(window), channel_));
    }

    std::span<const ExposedPhoto> photos_;
    const Response& response_;
    const AlignOptions& options_;
    const Watch& watch_;
    int channel_;
    Window all_, region_;
    std::vector<LogPyramid> by_region_, by_all_;  ///< a photo; empty where it was not needed yet
};

/// Photos of one thing are 0.8 and more alike, whatever their exposures; of different ones, such as
/// a ball and somebody before it, 0.1 and less.
constexpr double kSurelyAlike = 0.7, kAlike = 0.4;

/// Each photo, in the order, on its neighbour on the middle one's side.
std::vector<std::optional<ShiftFit>> fits_to_neighbours(Comparison& comparison,
                                                        std::span<const int> order, int middle,
                                                        const Watch& watch) {
    const auto count = static_cast<int>(order.size());
    const auto neighbour = [&](int i) { return order[index(i < middle ? i + 1 : i - 1)]; };
    std::vector<std::optional<ShiftFit>> fits(order.size());
    for_each_band(
        count, 1,
        [&](int i, int) {
            if (i != middle) fits[index(i)] = comparison.fit(order[index(i)], neighbour(i));
        },
        watch);
    // Something hides the region in one of them, or its outline was seen where it is not: what lies
    // around can tell.
    for (int i = 0; i < count; ++i) {
        auto& best = fits[index(i)];
        if (i == middle || (best && best->likeness >= kSurelyAlike)) continue;
        const auto around = comparison.fit_by_whole_picture(order[index(i)], neighbour(i));
        if (around && (!best || around->likeness > best->likeness)) best = around;
    }
    return fits;
}

/// From how a photo lies on a neighbour, and that one on the reference.
Alignment added(const Alignment& neighbour, const std::optional<ShiftFit>& fit,
                const std::optional<V2d>& hint) {
    constexpr double kUnsure = 0.5;
    const bool compared = fit && fit->deviation < kUnsure;
    if (compared && fit->likeness > kAlike)
        return {neighbour.shift + fit->shift, std::hypot(neighbour.deviation, fit->deviation),
                true};
    if (compared) return {neighbour.shift, 0, false, true};
    return {hint.value_or(neighbour.shift), 0, hint.has_value()};
}

}  // namespace

std::vector<Alignment> align(std::span<const ExposedPhoto> photos, std::span<const int> order,
                             int reference, const Response& response, const AlignOptions& options,
                             const Watch& watch) {
    assert(order.size() == photos.size());
    assert(options.hints.empty() || options.hints.size() == photos.size());
    assert(options.whole.empty() || options.whole.size() == photos.size());
    Comparison comparison(photos, order, response, options, watch);
    const auto count = static_cast<int>(order.size());
    const auto middle = static_cast<int>(std::ranges::find(order, reference) - order.begin());
    const auto fits = fits_to_neighbours(comparison, order, middle, watch);
    std::vector<Alignment> found(photos.size());
    found[index(reference)].measured = true;
    const auto follow = [&](int i, int step) {
        const int photo = order[index(i)];
        auto one = fits[index(i)];
        // What shows something else cannot tell where the next one lies.
        int trusted = i + step;
        while (found[index(order[index(trusted)])].unlike) trusted += step;
        if (trusted != i + step)
            one = comparison.fit_by_whole_picture(photo, order[index(trusted)]);
        found[index(photo)] =
            added(found[index(order[index(trusted)])], one, comparison.hint(photo));
    };
    for (int i = middle - 1; i >= 0; --i) follow(i, 1);
    for (int i = middle + 1; i < count; ++i) follow(i, -1);
    return found;
}

}  // namespace chromeball
