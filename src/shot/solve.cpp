#include "shot/solve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/statistics.h"
#include "shot/segments.h"
#include "shot/smooth.h"

namespace chromeball {
namespace {

using std::numbers::pi;

constexpr std::size_t kMostNumbers = 5;
using Numbers = std::array<double, kMostNumbers>;

constexpr double kKeyDeviation = 0.05;    // pixels: where nothing else is known
constexpr double kLeastDeviation = 0.05;  // pixels: no detection is better, whatever it thinks
constexpr double kUnsure = 3;             // times the deviation of a sighting that is not sure
constexpr double kWorthHearing = 0.1;     // confidence of a sighting that is not sure
constexpr double kTails = 4;              // degrees of freedom of Student's t

/// One sighting as numbers to be smoothed.
struct Measurement {
    std::size_t record = 0;
    Outline outline;
    Numbers value{};
    Numbers deviation{};
    double trust = 1;
    bool certain = false;
    double weight = 1;
};

/// Outlines as numbers that can be averaged, and back.
class Shape {
public:
    /// Cones, where every camera has a focal length.
    explicit Shape(bool cones) : cones_(cones) {}
    std::size_t numbers() const { return cones_ ? 3 : 5; }

    Numbers numbers_of(const Outline& outline, const Camera& camera) const {
        if (cones_) {
            const Cone cone = cone_of(outline, camera);
            const V2d axis(-cone.axis.x / cone.axis.z, cone.axis.y / cone.axis.z);
            const V2d seen = camera.principal + camera.distortion.distorted(axis) * *camera.focal;
            return {seen.x, seen.y, *camera.focal * std::tan(cone.half_angle), 0, 0};
        }
        const double flat = (outline.a - outline.b) / (outline.a + outline.b);
        const double twice = 2 * outline.angle * pi / 180;
        return {outline.cx, outline.cy, std::sqrt(outline.a * outline.b), flat * std::cos(twice),
                flat * std::sin(twice)};
    }

    /// Nothing where the numbers are no ball's.
    std::optional<Outline> outline_from(const Numbers& n, const Camera& camera) const {
        if (!(n[2] > 0)) return std::nullopt;
        if (cones_) {
            const V2d axis =
                camera.distortion.undistorted((V2d(n[0], n[1]) - camera.principal) / *camera.focal);
            return outline_of(
                {V3d(axis.x, -axis.y, -1).normalized(), std::atan(n[2] / *camera.focal)}, camera);
        }
        const double flat = std::min(std::hypot(n[3], n[4]), 0.5);
        const double stretch = std::sqrt((1 + flat) / (1 - flat));
        double angle = flat > 0 ? 0.5 * std::atan2(n[4], n[3]) * 180 / pi : 0;
        if (angle < 0) angle += 180;
        return Outline{n[0], n[1], n[2] * stretch, n[2] / stretch, angle};
    }

private:
    bool cones_;
};

Numbers deviations_of(const Sighting& ball) {
    const double scale = ball.sure ? 1 : kUnsure;
    const auto at_least = [&](double d) { return scale * std::max(d, kLeastDeviation); };
    const double radius = std::max(1.0, ball.outline.b);
    const double flatness = std::max(ball.radius_deviation, kLeastDeviation) / radius;
    return {at_least(ball.centre_deviation.x), at_least(ball.centre_deviation.y),
            at_least(ball.radius_deviation), scale * flatness, scale * flatness};
}

std::vector<Measurement> measurements_of(const std::vector<TrackRecord>& records,
                                         const SolveOptions& options, const Shape& shape) {
    std::vector<Measurement> all;
    for (std::size_t i = 0; i < records.size(); ++i) {
        const TrackRecord& record = records[i];
        if (!record.there || !record.readable) continue;
        if (const auto key = options.keys.find(record.frame); key != options.keys.end()) {
            Measurement m{i, key->second, shape.numbers_of(key->second, record.camera), {}, 1, true,
                          1};
            m.deviation.fill(kKeyDeviation);
            all.push_back(m);
        } else if (record.ball && (record.ball->sure || record.ball->confidence >= kWorthHearing)) {
            const Sighting& ball = *record.ball;
            all.push_back({i, ball.outline, shape.numbers_of(ball.outline, record.camera),
                           deviations_of(ball),
                           ball.sure ? std::clamp(ball.confidence, 0.3, 1.0) : 0.2, false, 1});
        }
    }
    return all;
}

/// A piece of the path: the measurements on it, and the frames that it spans.
struct Piece {
    std::vector<Measurement> seen;
    std::vector<int> frames;  ///< of the measurements
    int first = 0, last = 0;
    std::vector<Numbers> path;  ///< of the frames first to last
    double lens_blur = 0;
};

/// Where neighbours say that a measurement should be, robustly: the median of straight lines
/// through pairs of them. Nothing said where there are too few.
std::optional<Numbers> by_neighbours(const std::vector<Measurement>& seen, std::size_t at,
                                     const std::vector<int>& frames, std::size_t numbers) {
    constexpr std::ptrdiff_t kPairs[][2] = {{-1, 1},  {-2, 2}, {-1, 2}, {-2, 1},
                                            {-2, -1}, {1, 2},  {-3, 3}};
    std::array<std::vector<double>, kMostNumbers> said;
    for (const auto& pair : kPairs) {
        const std::ptrdiff_t i = std::ptrdiff_t(at) + pair[0], j = std::ptrdiff_t(at) + pair[1];
        if (i < 0 || j >= std::ssize(seen)) continue;
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        const double part = double(frames[at] - frames[a]) / (frames[b] - frames[a]);
        for (std::size_t n = 0; n < numbers; ++n)
            said[n].push_back(seen[a].value[n] + part * (seen[b].value[n] - seen[a].value[n]));
    }
    if (said[0].size() < 3) return std::nullopt;
    Numbers result{};
    for (std::size_t n = 0; n < numbers; ++n) result[n] = median(said[n]);
    return result;
}

/// Takes the weight of what stands out against its neighbours, so that the first fit is not drawn
/// to it.
void doubt_outliers(std::vector<Measurement>& seen, const std::vector<int>& frames) {
    std::vector<double> off(seen.size(), 0), per_frame(seen.size(), 0);
    // What a path bends away from a straight line grows with the square of the way along it: of
    // frames far from all others little is known.
    const auto far = [&](std::size_t i) {
        int nearest = 1 << 20;
        if (i > 0) nearest = std::min(nearest, frames[i] - frames[i - 1]);
        if (i + 1 < frames.size()) nearest = std::min(nearest, frames[i + 1] - frames[i]);
        return double(nearest) * nearest;
    };
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (const auto expected = by_neighbours(seen, i, frames, 3)) {
            off[i] =
                std::hypot(seen[i].value[0] - (*expected)[0], seen[i].value[1] - (*expected)[1],
                           seen[i].value[2] - (*expected)[2]);
            per_frame[i] = off[i] / far(i);
        }
    const double usual = median(per_frame);
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const double allowed =
            8 * usual * far(i) + 6 * seen[i].deviation[0] + 0.005 * seen[i].value[2];
        if (!seen[i].certain && off[i] > allowed) seen[i].weight = 1e-4;
    }
}

/// The same of a ball that stands still: all others are its neighbours.
void doubt_outliers_of_a_place(std::vector<Measurement>& seen) {
    Numbers middle{};
    for (std::size_t n = 0; n < 3; ++n) {
        std::vector<double> values;
        for (const Measurement& m : seen) values.push_back(m.value[n]);
        middle[n] = median(values);
    }
    std::vector<double> off;
    for (const Measurement& m : seen)
        off.push_back(
            std::hypot(m.value[0] - middle[0], m.value[1] - middle[1], m.value[2] - middle[2]));
    const double usual = median(off);
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (!seen[i].certain && off[i] > 6 * usual + 6 * seen[i].deviation[0])
            seen[i].weight = 1e-4;
}

bool is_circle(const Outline& outline) { return outline.a == outline.b; }

/// One number of all measurements of a piece, at the times from its first frame on.
Samples samples_of(const Piece& piece, std::size_t number) {
    Samples samples;
    samples.count = piece.last - piece.first + 1;
    for (std::size_t i = 0; i < piece.seen.size(); ++i) {
        samples.at.push_back(piece.frames[i] - piece.first);
        samples.value.push_back(piece.seen[i].value[number]);
        samples.deviation.push_back(piece.seen[i].deviation[number]);
        samples.weight.push_back(piece.seen[i].weight);
        samples.told.push_back(piece.seen[i].certain &&
                               (number < 3 || !is_circle(piece.seen[i].outline)));
        // A circle by hand says nothing of the shape.
        if (number >= 3 && piece.seen[i].certain && is_circle(piece.seen[i].outline))
            samples.deviation.back() = 1;
    }
    return samples;
}

/// The weighted mean at all times; of those that are told, where some are.
Smoothed constant(Samples samples) {
    if (std::find(samples.told.begin(), samples.told.end(), true) != samples.told.end())
        for (std::size_t i = 0; i < samples.told.size(); ++i)
            samples.weight[i] = samples.told[i] ? 1 : 0;
    double sum = 0, weights = 0, scatter = 0;
    for (std::size_t i = 0; i < samples.at.size(); ++i) {
        const double w = samples.weight[i] / (samples.deviation[i] * samples.deviation[i]);
        weights += w;
        sum += w * samples.value[i];
    }
    for (std::size_t i = 0; i < samples.at.size(); ++i)
        scatter += samples.weight[i] *
                   std::pow((samples.value[i] - sum / weights) / samples.deviation[i], 2);
    return {std::vector<double>(static_cast<std::size_t>(samples.count), sum / weights),
            std::sqrt(std::max(1.0, scatter / static_cast<double>(samples.at.size())))};
}

Smoothed smoothed(const Samples& samples, std::size_t number, bool lock) {
    // The shape of an ellipse without a camera changes as slowly as perspective does: waves of less
    // than about 60 frames (2 pi / 1e-6^(1/6)) are noise.
    constexpr double kStiffShape = 1e-6;
    if (lock) return constant(samples);
    return smooth(samples, number < 3 ? Stiffness{4, 0} : Stiffness{3, kStiffShape});
}

/// Fits the path, then weighs each measurement anew by how well it fits in all its numbers, and
/// again.
void smooth_path(Piece& piece, std::size_t numbers, bool lock) {
    constexpr int kRounds = 6;
    if (lock)
        doubt_outliers_of_a_place(piece.seen);
    else
        doubt_outliers(piece.seen, piece.frames);
    piece.path.assign(static_cast<std::size_t>(piece.last - piece.first + 1), {});
    for (int round = 0; round < kRounds; ++round) {
        std::vector<double> misfit(piece.seen.size(), 0);
        for (std::size_t n = 0; n < numbers; ++n) {
            const Samples samples = samples_of(piece, n);
            const Smoothed curve = smoothed(samples, n, lock);
            for (std::size_t i = 0; i < piece.path.size(); ++i) piece.path[i][n] = curve.value[i];
            for (std::size_t i = 0; i < misfit.size() && n < 3; ++i) {
                const double at = curve.value[static_cast<std::size_t>(samples.at[i])];
                const double sigmas =
                    (samples.value[i] - at) / (curve.noise * samples.deviation[i]);
                misfit[i] += sigmas * sigmas;
            }
        }
        for (std::size_t i = 0; i < misfit.size(); ++i)
            if (!piece.seen[i].certain)
                piece.seen[i].weight = std::min(1.0, (kTails + 3) / (kTails + misfit[i]));
    }
}

/// From 1 to 0 while x goes from 0 to 1, level at both ends.
double fading(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return 1 - x * x * (3 - 2 * x);
}

/// Moves the path so that it goes through the keys: by what each is off, smoothly from key to key
/// where they are near, else fading within some frames, so that far from keys nothing changes.
void bend_to_keys(Piece& piece, std::size_t numbers) {
    constexpr int kReach = 8;  // frames
    std::vector<std::pair<int, Numbers>> keys;
    for (std::size_t i = 0; i < piece.seen.size(); ++i) {
        if (!piece.seen[i].certain) continue;
        const int frame = piece.frames[i] - piece.first;
        Numbers off = piece.seen[i].value;
        for (std::size_t n = 0; n < numbers; ++n)
            off[n] -= piece.path[static_cast<std::size_t>(frame)][n];
        if (is_circle(piece.seen[i].outline)) off[3] = off[4] = 0;  // of its shape nothing is said
        keys.emplace_back(frame, off);
    }
    if (keys.empty()) return;
    for (int frame = 0; frame < std::ssize(piece.path); ++frame) {
        const auto after = std::find_if(keys.begin(), keys.end(),
                                        [&](const auto& key) { return key.first >= frame; });
        const bool has_after = after != keys.end(), has_before = after != keys.begin();
        const auto before = has_before ? std::prev(after) : after;
        const int gap = has_before && has_after ? after->first - before->first : kReach;
        const double reach = std::min(gap, kReach);
        Numbers& path = piece.path[static_cast<std::size_t>(frame)];
        for (std::size_t n = 0; n < numbers; ++n) {
            if (has_before) path[n] += before->second[n] * fading((frame - before->first) / reach);
            if (has_after) path[n] += after->second[n] * fading((after->first - frame) / reach);
        }
    }
}

double median_blur(const Piece& piece, const std::vector<TrackRecord>& records) {
    std::vector<double> blurs;
    for (const Measurement& m : piece.seen)
        if (records[m.record].ball && records[m.record].ball->sure)
            blurs.push_back(records[m.record].ball->lens_blur);
    return median(blurs);
}

/// The pieces of the path, in order; what lies on none is overruled. A locked ball has one.
std::vector<Piece> pieces_from(const std::vector<Measurement>& all,
                               const std::vector<TrackRecord>& records, bool lock) {
    std::vector<Waypoint> waypoints;
    for (const Measurement& m : all)
        waypoints.push_back(
            {records[m.record].frame, m.value[0], m.value[1], m.value[2], m.trust, m.certain});
    const std::vector<int> piece_of = lock ? std::vector<int>(all.size(), 0) : pieces_of(waypoints);
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (piece_of[i] < 0) continue;
        if (piece_of[i] >= std::ssize(pieces)) pieces.emplace_back();
        pieces.back().seen.push_back(all[i]);
        pieces.back().frames.push_back(records[all[i].record].frame);
    }
    for (Piece& piece : pieces) {
        piece.first = piece.frames.front();
        piece.last = piece.frames.back();
    }
    return pieces;
}

/// The piece that spans a frame, or the nearest one, the earlier of two.
const Piece* piece_near(const std::vector<Piece>& pieces, int frame, bool& within) {
    const Piece* nearest = nullptr;
    int least = 0;
    for (const Piece& piece : pieces) {
        const int off = std::max({0, piece.first - frame, frame - piece.last});
        if (nearest && off >= least) continue;
        nearest = &piece;
        least = off;
    }
    within = nearest && least == 0;
    return nearest;
}

/// What happened to one frame, given the path.
class Judge {
public:
    Judge(const SolveOptions& options, const Shape& shape, const std::vector<Piece>& pieces)
        : options_(options), shape_(shape), pieces_(pieces) {}

    SolvedFrame solved(const TrackRecord& record) const {
        SolvedFrame frame;
        frame.frame = record.frame;
        if (record.ball) {
            frame.tracked = record.ball->outline;
            frame.confidence = record.ball->confidence;
        }
        frame.message = record.message;
        if (!record.there || !record.readable) {
            frame.outcome = record.there ? FrameOutcome::failed : FrameOutcome::missing;
            frame.flagged = true;
            return frame;
        }
        bool within = false;
        const Piece* piece = piece_near(pieces_, record.frame, within);
        const std::optional<Outline> path = piece ? path_at(*piece, record) : std::nullopt;
        if (!path) return without_ball(frame);
        frame.piece = static_cast<int>(piece - pieces_.data());
        frame.lens_blur = piece->lens_blur;
        frame.outline = path;
        if (options_.keys.contains(record.frame)) {
            frame.outcome = FrameOutcome::filled;
            add_message(frame, "placed by hand with --key");
        } else if (record.ball && agrees(*record.ball, *path)) {
            frame.outcome = FrameOutcome::found;
            judge_view(*record.ball, frame);
        } else if (options_.lock || (within && record.ball && hidden_there(*record.ball, *path))) {
            frame.outcome = FrameOutcome::filled;
            tell_overruled(record, *path, frame);
        } else {
            without_sighting(record, within, frame);
        }
        return frame;
    }

private:
    static void add_message(SolvedFrame& frame, const std::string& text) {
        frame.message += (frame.message.empty() ? "" : "; ") + text;
    }

    std::optional<Outline> path_at(const Piece& piece, const TrackRecord& record) const {
        const int at = std::clamp(record.frame, piece.first, piece.last) - piece.first;
        return shape_.outline_from(piece.path[static_cast<std::size_t>(at)], record.camera);
    }

    /// Off by no more than the path's smoothing explains; of a weak sighting too.
    static bool agrees(const Sighting& ball, const Outline& path) {
        const double noise =
            std::max({ball.centre_deviation.x, ball.centre_deviation.y, ball.radius_deviation});
        const double allowed = std::max({1.5, 0.015 * path.a, 6 * noise});
        return rim_deviation(ball.outline, path) <= allowed;
    }

    /// Seen wrongly, but so that it must be there: surely, or weakly where it should be.
    static bool hidden_there(const Sighting& ball, const Outline& path) {
        const double off = std::hypot(ball.outline.cx - path.cx, ball.outline.cy - path.cy,
                                      ball.outline.a - path.a);
        return ball.sure || off < 0.3 * path.a;
    }

    static void judge_view(const Sighting& ball, SolvedFrame& frame) {
        constexpr double kHidden = 0.6;
        if (ball.visible_rim < kHidden)
            add_message(frame,
                        fmt::format("only {:.0f} % of the rim is seen", 100 * ball.visible_rim));
        frame.flagged = ball.visible_rim < kHidden;
    }

    static void tell_overruled(const TrackRecord& record, const Outline& path, SolvedFrame& frame) {
        frame.flagged = true;
        if (!record.ball) return add_message(frame, "not seen in this frame");
        const double off =
            std::hypot(record.ball->outline.cx - path.cx, record.ball->outline.cy - path.cy,
                       record.ball->outline.a - path.a);
        add_message(frame, fmt::format("seen {:.1f} pixels off the path; overruled", off));
    }

    void without_sighting(const TrackRecord& record, bool within, SolvedFrame& frame) const {
        frame.flagged = true;
        switch (options_.missing) {
            case MissingFrames::skip:
                frame.outline.reset();
                frame.outcome = FrameOutcome::missing;
                return add_message(frame, "no ball seen; skipped");
            case MissingFrames::interpolate:
                frame.outcome = within ? FrameOutcome::filled : FrameOutcome::held;
                return add_message(
                    frame, within ? "no ball seen; interpolated" : "no ball seen; outline held");
            case MissingFrames::hold:
                frame.outcome = FrameOutcome::held;
                frame.outline = held(record);
                return add_message(frame, "no ball seen; outline held");
        }
    }

    SolvedFrame without_ball(SolvedFrame frame) const {
        frame.outcome = FrameOutcome::missing;
        frame.flagged = true;
        add_message(frame, "no ball seen in any frame");
        return frame;
    }

    /// The outline of the nearest frame in which the ball was seen, the earlier of two.
    std::optional<Outline> held(const TrackRecord& record) const {
        std::optional<Outline> nearest;
        int least = 0;
        const auto consider = [&](const Piece& piece, int frame) {
            const int off = std::abs(frame - record.frame);
            if (nearest && off >= least) return;
            least = off;
            const auto at = static_cast<std::size_t>(frame - piece.first);
            nearest = shape_.outline_from(piece.path[at], record.camera);
        };
        for (const Piece& piece : pieces_) {
            const auto after =
                std::lower_bound(piece.frames.begin(), piece.frames.end(), record.frame);
            if (after != piece.frames.begin()) consider(piece, *std::prev(after));
            if (after != piece.frames.end()) consider(piece, *after);
        }
        return nearest;
    }

    const SolveOptions& options_;
    const Shape& shape_;
    const std::vector<Piece>& pieces_;
};

std::vector<SolvedFrame> as_told(const std::vector<TrackRecord>& records) {
    std::vector<SolvedFrame> frames;
    for (const TrackRecord& record : records) {
        SolvedFrame frame;
        frame.frame = record.frame;
        frame.message = record.message;
        frame.outcome = !record.there      ? FrameOutcome::missing
                        : !record.readable ? FrameOutcome::failed
                        : record.ball      ? FrameOutcome::found
                                           : FrameOutcome::missing;
        frame.flagged = frame.outcome != FrameOutcome::found;
        if (!frame.flagged) {
            frame.outline = frame.tracked = record.ball->outline;
            frame.confidence = record.ball->confidence;
            frame.piece = 0;
        }
        frames.push_back(frame);
    }
    return frames;
}

bool all_have_focal(const std::vector<TrackRecord>& records) {
    return std::all_of(records.begin(), records.end(), [](const TrackRecord& r) {
        return !r.there || !r.readable || !r.camera.orthographic();
    });
}

/// The robust mean of logarithms, each with its deviation, and the sum of their weights.
std::pair<double, double> robust_mean(const std::vector<double>& logs,
                                      const std::vector<double>& deviations) {
    constexpr int kRounds = 20;
    double mean = median(logs), weights = 0;
    for (int round = 0; round < kRounds; ++round) {
        double sum = 0;
        weights = 0;
        for (std::size_t i = 0; i < logs.size(); ++i) {
            const double off = (logs[i] - mean) / deviations[i];
            const double w = std::min(1.0, (kTails + 1) / (kTails + off * off)) /
                             (deviations[i] * deviations[i]);
            weights += w;
            sum += w * logs[i];
        }
        mean = sum / weights;
    }
    return {mean, weights};
}

}  // namespace

std::optional<FocalHint> focal_of_shot(const std::vector<TrackRecord>& records) {
    constexpr double kLeastDeviation = 0.02;  // of a focal length: no shape tells more
    constexpr double kOfOne = 12;             // frames that share their errors
    std::vector<double> logs, deviations;
    std::size_t sightings = 0;
    for (const TrackRecord& record : records) {
        if (!record.there || !record.readable) continue;
        if (!record.camera.orthographic() || record.distance) return std::nullopt;
        if (!record.ball || !record.ball->sure) continue;
        ++sightings;
        if (!record.ball->focal) continue;
        const auto& [focal, deviation] = *record.ball->focal;
        logs.push_back(std::log(focal));
        deviations.push_back(std::max(deviation / focal, kLeastDeviation));
    }
    if (logs.empty() || logs.size() * 5 < sightings) return std::nullopt;
    const auto [mean, weights] = robust_mean(logs, deviations);
    const double alike = std::min(kOfOne, static_cast<double>(logs.size()));
    return FocalHint{std::exp(mean), std::exp(mean) * std::sqrt(alike / weights)};
}

std::vector<SolvedFrame> solve(const std::vector<TrackRecord>& records,
                               const SolveOptions& options) {
    if (options.told) return as_told(records);
    const Shape shape(all_have_focal(records));
    std::vector<Piece> pieces =
        pieces_from(measurements_of(records, options, shape), records, options.lock);
    for (Piece& piece : pieces) {
        smooth_path(piece, shape.numbers(), options.lock);
        if (!options.lock) bend_to_keys(piece, shape.numbers());
        piece.lens_blur = median_blur(piece, records);
    }
    const Judge judge(options, shape, pieces);
    std::vector<SolvedFrame> frames;
    frames.reserve(records.size());
    for (const TrackRecord& record : records) frames.push_back(judge.solved(record));
    return frames;
}

}  // namespace chromeball
