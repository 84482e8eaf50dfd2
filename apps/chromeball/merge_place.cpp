#include "merge_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/statistics.h"
#include "detect/detect.h"
#include "numbers.h"
#include "refuse.h"
#include "resample/source.h"

namespace chromeball {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Stops on Ctrl-C, tells nothing.
Watch quietly(const Console& console) { return {console.watch("").stop, nullptr}; }

/// The ball in each photo, where it was found or told.
std::vector<std::optional<Outline>> balls_of(const std::optional<std::string>& told,
                                             const Bracket& bracket, int reference,
                                             const Console& console) {
    std::vector<std::optional<Outline>> balls(bracket.photos.size());
    if (told) {
        const auto n = parse_numbers("--ball", *told, {3}, "CX,CY,R");
        if (!(n[2] > 0)) refuse(fmt::format("--ball {}: the radius must be above 0", *told));
        balls[at(reference)] = Outline{n[0], n[1], n[2], n[2], 0};
        return balls;
    }
    for (std::size_t k = 0; k < balls.size(); ++k) {
        const auto found = find_balls(*bracket.photos[k], {}, quietly(console));
        if (!found.empty() && found.front().confidence >= DetectOptions().threshold)
            balls[k] = found.front().outline;
    }
    return balls;
}

double radius(const Outline& e) { return std::sqrt(e.a * e.b); }

/// The ball that most photos agree on, near the one of the reference, decides; others are none.
void keep_alike(std::vector<std::optional<Outline>>& balls) {
    std::vector<double> radii;
    for (const auto& ball : balls)
        if (ball) radii.push_back(radius(*ball));
    if (radii.empty()) return;
    const double usual = median(std::move(radii));
    for (auto& ball : balls)
        if (ball && std::abs(radius(*ball) / usual - 1) > 0.05) ball.reset();
}

AlignOptions align_options(const std::vector<std::optional<Outline>>& balls, bool searched,
                           int reference, Size size) {
    AlignOptions options;
    const auto& here = balls[at(reference)];
    if (!here) return options;
    const Outline wide{here->cx, here->cy, 1.1 * here->a, 1.1 * here->b, here->angle};
    options.region = needed_window(wide, {0, 0, size});
    // Told for one it is about there in all; not found in one, the ball is not well shown there.
    for (const auto& ball : balls) options.whole.push_back(searched && !ball);
    for (const auto& ball : balls)
        options.hints.push_back(ball ? std::optional(V2d(ball->cx - here->cx, ball->cy - here->cy))
                                     : std::nullopt);
    return options;
}

void take_moves(Placed& placed) {
    placed.moves.clear();
    for (const Alignment& a : placed.shifts) placed.moves.push_back(a.shift);
}

}  // namespace

std::vector<int> order_of(const Bracket& bracket) {
    std::vector<double> key;
    const bool told = std::ranges::all_of(bracket.told, [](const auto& t) { return !!t; });
    for (std::size_t k = 0; k < bracket.exposed.size(); ++k) {
        if (told) {
            key.push_back(*bracket.told[k]);
            continue;
        }
        const ExposedPhoto& photo = bracket.exposed[k];
        Image row({photo.size.width, 1}, 3);
        double sum = 0;
        for (int y = 0; y < photo.size.height; y += 1 + photo.size.height / 256) {
            photo.read(y, y + 1, row.view());
            for (int x = 0; x < photo.size.width; ++x)
                if (const float z = row.pixel(x, 0)[1]; std::isfinite(z))
                    sum += static_cast<double>(z);
        }
        key.push_back(sum);
    }
    std::vector<int> order(key.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](int k) { return key[static_cast<std::size_t>(k)]; });
    return order;
}

std::vector<std::optional<Outline>> alike_balls(const std::optional<std::string>& told,
                                                const Bracket& bracket, int reference,
                                                const Console& console) {
    auto balls = balls_of(told, bracket, reference, console);
    keep_alike(balls);
    return balls;
}

Placed placed_photos(const std::optional<std::string>& told, const Bracket& bracket,
                     const std::vector<int>& order, int reference, const Console& console) {
    Placed placed;
    placed.balls = alike_balls(told, bracket, reference, console);
    for (std::size_t k = 0; k < placed.balls.size() && placed.balls[at(reference)]; ++k)
        if (!placed.balls[k] && !told)
            console.say(
                fmt::format("{}: its ball is lost; it is laid on the others by the whole picture",
                            bracket.exposed[k].name));
    placed.options = align_options(placed.balls, !told, reference, bracket.size());
    placed.shifts = align(bracket.exposed, order, reference, bracket.response, placed.options,
                          console.watch("aligning"));
    take_moves(placed);
    return placed;
}

std::vector<std::string> leave_out_unlike(Bracket& bracket, const Placed& placed,
                                          const Console& console) {
    std::vector<std::string> names;
    Bracket kept = bracket;
    kept.photos.clear(), kept.exposed.clear(), kept.tags.clear(), kept.told.clear();
    for (std::size_t k = 0; k < placed.shifts.size(); ++k) {
        if (placed.shifts[k].unlike) {
            names.push_back(bracket.exposed[k].name);
            continue;
        }
        kept.photos.push_back(bracket.photos[k]);
        kept.exposed.push_back(bracket.exposed[k]);
        kept.tags.push_back(bracket.tags[k]);
        kept.told.push_back(bracket.told[k]);
    }
    if (kept.photos.size() < 2)
        throw Error(Error::Kind::failed,
                    fmt::format("{}: shows something else than the other photos; name exposures of "
                                "one view",
                                names.front()));
    for (const std::string& name : names)
        console.warn(
            fmt::format("{}: shows something else than the others; it is left out (--no-align "
                        "takes it as it lies)",
                        name));
    if (!names.empty()) bracket = std::move(kept);
    return names;
}

void place_again(Placed& placed, const Bracket& bracket, const std::vector<int>& order,
                 int reference, const Response& response, const Console& console) {
    AlignOptions options = placed.options;
    options.hints.clear();
    for (const Alignment& a : placed.shifts) options.hints.emplace_back(a.shift);
    placed.shifts = align(bracket.exposed, order, reference, response, options,
                          console.watch("aligning again"));
    take_moves(placed);
}

std::optional<Outline> merged_ball(const Placed& placed, int reference) {
    const auto& balls = placed.balls;
    if (balls.empty()) return std::nullopt;
    if (balls[at(reference)]) return balls[at(reference)];
    for (std::size_t k = 0; k < balls.size(); ++k) {
        if (!balls[k]) continue;
        Outline moved = *balls[k];
        moved.cx -= placed.moves[k].x;
        moved.cy -= placed.moves[k].y;
        return moved;
    }
    return std::nullopt;
}

void tell_shifts(const Bracket& bracket, const std::vector<Alignment>& shifts, int reference,
                 const Console& console) {
    for (std::size_t k = 0; k < shifts.size(); ++k) {
        const Alignment& a = shifts[k];
        if (!a.measured)
            console.warn(
                fmt::format("{}: could not be laid on the others (too little that both "
                            "show well); taken as it lies",
                            bracket.exposed[k].name));
        else if (static_cast<int>(k) != reference && a.shift.length() > 0.05)
            console.say(fmt::format("{}: shifted by {:.2f},{:.2f} pixels", bracket.exposed[k].name,
                                    a.shift.x, a.shift.y));
    }
}

}  // namespace chromeball
