#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "detect/detect.h"
#include "io/lines.h"
#include "photo_job.h"
#include "shot.h"
#include "shot/workers.h"
#include "stop.h"

namespace chromeball {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Sighting sighting_of(const Candidate& candidate, bool sure) {
    Sighting ball;
    ball.outline = candidate.outline;
    ball.centre_deviation = V2d(candidate.deviation.cx, candidate.deviation.cy);
    ball.radius_deviation = std::hypot(candidate.deviation.a, candidate.deviation.b) / std::sqrt(2);
    ball.confidence = candidate.confidence;
    ball.visible_rim = candidate.visible_rim;
    ball.lens_blur = lens_blur(candidate);
    ball.motion = candidate.motion;
    ball.sure = sure;
    if (candidate.focal) ball.focal = FocalHint{candidate.focal->focal, candidate.focal->deviation};
    return ball;
}

/// Where a ball is expected, as key frames showed it.
struct Expected {
    Outline outline;
    std::optional<V2d> motion;  ///< while the shutter is open; none: cannot be told
};

/// Looks for the ball of one frame.
class Search {
public:
    Search(const Shot& shot, int frame, const Photo& header, const CameraChoice& camera)
        : shot_(shot),
          frame_(frame),
          options_(shot.photo_options(frame)),
          picture_(header.window),
          search_(search_options(options_, camera)) {}

    /// In the whole picture.
    std::optional<Sighting> whole() const {
        const Photo photo = shot_.plates->read(frame_, {options_.max_pixels, std::nullopt});
        watch_.check();
        const auto balls = find_balls(photo, search_, watch_);
        if (balls.empty()) return std::nullopt;
        return sighting_of(balls.front(), balls.front().confidence >= options_.threshold);
    }

    /// Near where it must be: at first only around that, then in wider windows, then everywhere.
    /// Near it half the confidence is enough, for a ball is expected there.
    std::optional<Sighting> near(const Expected& expected) const {
        std::optional<Sighting> weak;
        for (const Way& way : kWays) {
            auto ball = looked_for(expected, way, weak);
            if (ball) return ball;
        }
        const auto ball = whole();
        if (ball && (ball->sure || !weak || ball->confidence > weak->confidence)) weak = ball;
        if (weak && weak->confidence >= 0.5 * options_.threshold &&
            resembles(weak->outline, expected.outline))
            return certain(*weak);
        return weak;
    }

private:
    static Sighting certain(Sighting ball) {
        ball.sure = true;
        return ball;
    }

    /// Not much larger or smaller than a few frames before.
    static bool resembles(const Outline& outline, const Outline& key) {
        return outline.a > kLeast * key.a && outline.a < kMost * key.a;
    }

    /// How the ball is looked for: in a window so many radii wider than it on all sides, all over
    /// that or only from where it must be.
    struct Way {
        double margin;
        bool followed;
    };

    static constexpr Way kWays[] = {{0.5, true}, {1.0, false}, {2.5, false}};

    /// Looks one way; where what is seen is cut off by the window, once more around that. Keeps the
    /// best that is not enough.
    std::optional<Sighting> looked_for(const Expected& expected, const Way& way,
                                       std::optional<Sighting>& weak) const {
        Expected around = expected;
        Way now = way;
        for (int again = 0; again < 2; ++again) {
            const Window window = search_window(around.outline, now.margin, picture_);
            // Of so large a window the whole costs no more.
            if (!now.followed && window.size.pixels() * 2 > picture_.size.pixels())
                return std::nullopt;
            const auto ball = in_window(window, around, now.followed);
            if (!ball) return std::nullopt;
            const double off = std::hypot(ball->outline.cx - expected.outline.cx,
                                          ball->outline.cy - expected.outline.cy) /
                               expected.outline.a;
            // What was followed far from where it must be was drawn away by something else.
            if (way.followed && off > 0.3) return std::nullopt;
            const bool enough = ball->confidence >= options_.threshold * (off > 0.5 ? 1.0 : 0.5);
            if (well_inside(ball->outline, window, picture_)) {
                if (enough) return certain(*ball);
                if (!weak || ball->confidence > weak->confidence) weak = ball;
                return std::nullopt;
            }
            if (!enough) return std::nullopt;
            around = {ball->outline, ball->motion};
            now = {0.5, true};
        }
        return std::nullopt;
    }

    /// The best that a window shows, even if the window cuts it off.
    std::optional<Sighting> in_window(const Window& window, const Expected& around,
                                      bool followed) const {
        if (window.size.width < 16 || window.size.height < 16) return std::nullopt;
        const Photo part = shot_.plates->part(frame_, window, options_.max_pixels);
        watch_.check();
        DetectOptions search = search_;
        search.near.reset();
        search.expected = true;
        if (followed) {
            search.start = around.outline;
            search.motion = around.motion;
        }
        search.radius_range = {kLeast * around.outline.a, kMost * around.outline.a};
        const auto balls = find_balls(part, search, watch_);
        for (const Candidate& ball : balls)
            if (well_inside(ball.outline, window, picture_)) return sighting_of(ball, false);
        if (balls.empty()) return std::nullopt;
        return sighting_of(balls.front(), false);
    }

    static constexpr double kLeast = 0.6, kMost = 1.6;  // of the key frame's radius

    const Shot& shot_;
    int frame_;
    PhotoOptions options_;
    Window picture_;
    DetectOptions search_;
    Watch watch_{&stop_requested(), nullptr};
};

/// The outline that --ball, --ellipse or --cropped tell.
Sighting told_sighting(const Shot& shot, int frame, const Photo& header) {
    Sighting ball;
    ball.confidence = ball.visible_rim = 1;
    ball.sure = true;
    const PhotoOptions options = shot.photo_options(frame);
    if (options.cropped) {
        ball.outline = open_photo(shot.plates->file(frame), options, {&stop_requested(), nullptr})
                           .ball.outline;
    } else {
        ball.outline = told_outline(header, options);
    }
    return ball;
}

/// Fills in what the frame's plate shows. expected: where the search starts, if it does.
void look(const Shot& shot, TrackRecord& record, const std::optional<Expected>& expected) {
    const PhotoOptions options = shot.photo_options(record.frame);
    const Photo header = shot.plates->header(record.frame, {options.max_pixels, std::nullopt});
    const CameraChoice camera = choose_camera(options, header);
    record.display = header.display;
    record.camera = camera.camera;
    record.distance = camera.distance;
    if (shot.solving.told) {
        record.ball = told_sighting(shot, record.frame, header);
        return;
    }
    const Search search(shot, record.frame, header, camera);
    record.ball = expected ? search.near(*expected) : search.whole();
    // What was cropped since has its optical axis anywhere.
    if (record.ball && (camera.told || !camera.note.empty())) record.ball->focal.reset();
}

/// One frame's record. A frame that cannot be read is an answer; an interruption is not.
TrackRecord tracked(const Shot& shot, int frame, const std::optional<Expected>& expected) {
    const auto start = Clock::now();
    TrackRecord record;
    record.frame = frame;
    record.settings = shot.track_settings;
    record.plate = shot.plates->stamp(frame);
    record.there = shot.plates->has(frame);
    if (!record.there) {
        record.message = "no such file";
    } else {
        try {
            look(shot, record, expected);
        } catch (const Error& e) {
            if (e.kind() == Error::Kind::interrupted) throw;
            record.readable = false;
            record.message = e.what();
        } catch (const std::bad_alloc&) {
            record.readable = false;
            record.message = "not enough memory";
        }
    }
    record.seconds = seconds_since(start);
    return record;
}

/// Whether a record is of this search and of the plate as it is now. Which of two files holds the
/// newer record their names do not tell, so each is asked before it takes the other's place.
bool is_current(const Shot& shot, const TrackRecord& record) {
    return record.settings == shot.track_settings &&
           record.plate == shot.plates->stamp(record.frame);
}

/// The records of a run, as they grow: in memory and in the run's file.
class Track {
public:
    explicit Track(const Shot& shot) : shot_(shot), file_(shot.stage_file("track")) {
        if (shot.options.overwrite) return;
        for_each_line(shot.stage_text("track"), [&](std::string_view line) {
            auto record = track_record_from(line);
            if (record && is_current(shot_, *record)) records_[record->frame] = std::move(*record);
        });
    }

    bool knows(int frame) const {
        const std::lock_guard hold(lock_);
        return records_.contains(frame);
    }
    bool there(int frame) const { return shot_.plates->has(frame); }

    /// The key frames that are still to be searched before these frames are.
    std::set<int> unknown_keys(const Frames& frames) const {
        std::set<int> keys;
        const auto add_unknown = [&](const std::vector<int>& some) {
            if (!some.empty() && !knows(some.back())) keys.insert(some.back());
        };
        for (const int frame : frames) {
            if (!there(frame)) continue;
            const int key = key_frame(frame, [&](int n) { return there(n); });
            add_unknown(keys_from(key, false));
            add_unknown(keys_from(frame, true));
            const auto before = nearest_sighting(key, false);
            if (!before || nearest_sighting(frame, true)) continue;
            if (const auto previous = key_after(before->first, false))
                add_unknown(keys_from(*previous, false));
        }
        return keys;
    }

    void search(const Frames& frames, const std::string& what) {
        const Progress progress = shot_.console.frames(what, frames.size());
        for_each_frame(
            frames.size(), shot_.jobs, [&](std::size_t i) { add(tracked(frames[i])); },
            {&stop_requested(), nullptr}, progress);
    }

private:
    TrackRecord tracked(int frame) const {
        const auto key = key_frame(frame, [&](int n) { return there(n); });
        return chromeball::tracked(shot_, frame,
                                   key == frame ? std::nullopt : expected(frame, key));
    }

    /// By the frame's own key frame and the next one, or such further ones as show the ball surely:
    /// wherever the run ends and whatever it had. Behind the last one as it moved before.
    std::optional<Expected> expected(int frame, int key) const {
        const auto before = nearest_sighting(key, false);
        if (!before) return std::nullopt;
        const auto after = nearest_sighting(frame, true);
        const auto other = after ? after : nearest_sighting_before(before->first);
        const Expected held{before->second.outline, before->second.motion};
        if (!other) return held;
        const auto& [first, one] = other->first < before->first ? *other : *before;
        const auto& [last, two] = other->first < before->first ? *before : *other;
        const double part = double(frame - first) / (last - first);
        const auto outline = outline_between(one.outline, two.outline, part);
        if (!outline) return held;
        return Expected{*outline, motion_between(one.motion, two.motion, std::min(part, 1.0))};
    }

    std::optional<int> key_after(int frame, bool forward) const {
        const auto there = [&](int n) { return this->there(n); };
        return forward ? next_key_frame(frame, there) : previous_key_frame(frame, there);
    }

    /// The key frames that may tell where the ball is, nearest first, up to one that does, or to
    /// one that is not known yet and must be: backward from a key frame, forward from behind any
    /// frame.
    std::vector<int> keys_from(int frame, bool forward) const {
        constexpr std::size_t kMostKeys = 3;
        std::vector<int> keys;
        std::optional<int> key = forward ? key_after(frame, true) : frame;
        while (key && keys.size() < kMostKeys) {
            keys.push_back(*key);
            if (!knows(*key)) break;
            if (const auto other = unknown_beside(*key)) {
                keys.push_back(*other);
                break;
            }
            if (telling_at(*key)) break;
            key = key_after(*key, forward);
        }
        return keys;
    }

    std::optional<Sighting> weakly_at(int frame) const {
        const std::lock_guard hold(lock_);
        const auto record = records_.find(frame);
        if (record == records_.end() || !record->second.ball ||
            record->second.ball->confidence < 0.5 * shot_.options.photo.threshold)
            return std::nullopt;
        return record->second.ball;
    }

    /// Of a key frame that shows the ball but weakly, a neighbour that is to be asked first.
    std::optional<int> unknown_beside(int key) const {
        if (surely_at(key) || !weakly_at(key)) return std::nullopt;
        for (const bool forward : {false, true})
            if (const auto other = key_after(key, forward); other && !knows(*other)) return other;
        return std::nullopt;
    }

    /// What a key frame shows surely, or weakly where a neighbour surely does.
    std::optional<Sighting> telling_at(int key) const {
        if (const auto ball = surely_at(key)) return ball;
        const auto ball = weakly_at(key);
        if (!ball) return std::nullopt;
        for (const bool forward : {false, true}) {
            const auto beside = key_after(key, forward);
            const auto other = beside ? surely_at(*beside) : std::nullopt;
            if (other && may_be_same(ball->outline, other->outline)) return ball;
        }
        return std::nullopt;
    }

    std::optional<std::pair<int, Sighting>> nearest_sighting_before(int key) const {
        const auto previous = key_after(key, false);
        return previous ? nearest_sighting(*previous, false) : std::nullopt;
    }

    std::optional<std::pair<int, Sighting>> nearest_sighting(int frame, bool forward) const {
        const auto keys = keys_from(frame, forward);
        if (keys.empty()) return std::nullopt;
        const auto ball = telling_at(keys.back());
        if (!ball) return std::nullopt;
        return std::pair{keys.back(), *ball};
    }

    std::optional<Sighting> surely_at(int frame) const {
        const std::lock_guard hold(lock_);
        const auto record = records_.find(frame);
        if (record == records_.end() || !record->second.ball || !record->second.ball->sure)
            return std::nullopt;
        return record->second.ball;
    }

    void add(TrackRecord record) {
        const std::lock_guard hold(lock_);
        append_line(file_, to_line(record));
        records_[record.frame] = std::move(record);
    }

    const Shot& shot_;
    std::string file_;
    mutable std::mutex lock_;
    std::map<int, TrackRecord> records_;
};

}  // namespace

void run_track(const Shot& shot) {
    Track track(shot);
    Frames todo;
    std::set<int> keys;
    const auto there = [&](int n) { return track.there(n); };
    for (const int frame : shot.frames) {
        if (track.knows(frame)) continue;
        if (key_frame(frame, there) == frame)
            keys.insert(frame);
        else
            todo.push_back(frame);
    }
    // Of a told ball no key is needed. Of others further ones may be, where these do not show it.
    while (!keys.empty() || !shot.solving.told) {
        if (!shot.solving.told) keys.merge(track.unknown_keys(todo));
        if (keys.empty()) break;
        track.search({keys.begin(), keys.end()}, "searching key frames");
        keys.clear();
    }
    track.search(todo, "tracking");
}

std::vector<TrackRecord> track_records(const Shot& shot) {
    std::map<int, TrackRecord> known;
    for_each_line(shot.stage_text("track"), [&](std::string_view line) {
        auto record = track_record_from(line);
        if (record && is_current(shot, *record)) known[record->frame] = std::move(*record);
    });
    std::vector<TrackRecord> records;
    for (const int frame : shot.frames) {
        const auto record = known.find(frame);
        if (record != known.end()) {
            records.push_back(record->second);
            continue;
        }
        TrackRecord unknown;
        unknown.frame = frame;
        unknown.there = shot.plates->has(frame);
        unknown.readable = false;
        unknown.message = unknown.there ? "not tracked yet: run --stage track" : "no such file";
        records.push_back(unknown);
    }
    return records;
}

}  // namespace chromeball
