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
    ball.sure = sure;
    return ball;
}

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
        const Photo photo = read(std::nullopt);
        const auto balls = find_balls(photo, search_, watch_);
        if (balls.empty()) return std::nullopt;
        return sighting_of(balls.front(), balls.front().confidence >= options_.threshold);
    }

    /// Near where the key frame has it: in a window around that, then in a wider one, then
    /// everywhere. Near it half the confidence is enough, for a ball is expected there.
    std::optional<Sighting> near(const Outline& key) const {
        std::optional<Sighting> weak;
        for (const double margin : {1.0, 2.5}) {
            const Window window = search_window(key, margin, picture_);
            if (window.size.pixels() * 2 > picture_.size.pixels()) break;  // whole costs no more
            const auto ball = in_window(window, key);
            if (!ball) continue;
            const bool moved = std::hypot(ball->outline.cx - key.cx, ball->outline.cy - key.cy) >
                               0.5 * margin * key.a;
            if (ball->confidence >= options_.threshold * (moved ? 1.0 : 0.5)) return certain(*ball);
            if (!weak || ball->confidence > weak->confidence) weak = ball;
        }
        const auto ball = whole();
        if (ball && (ball->sure || !weak || ball->confidence > weak->confidence)) weak = ball;
        if (weak && weak->confidence >= 0.5 * options_.threshold && resembles(weak->outline, key))
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

    Photo read(std::optional<std::pair<int, int>> rows) const {
        Photo photo = shot_.plates->read(frame_, {options_.max_pixels, rows});
        watch_.check();
        return photo;
    }

    std::optional<Sighting> in_window(const Window& window, const Outline& key) const {
        if (window.size.width < 16 || window.size.height < 16) return std::nullopt;
        const Photo rows = read(std::pair(window.y, window.y + window.size.height));
        Window there = window;
        there.y = std::max(window.y, rows.window.y);
        there.size.height =
            std::min(window.y + window.size.height, rows.window.y + rows.window.size.height) -
            there.y;
        DetectOptions search = search_;
        search.near.reset();
        search.expected = true;
        search.radius_range = {kLeast * key.a, kMost * key.a};
        for (const Candidate& ball : find_balls(part_of(rows, there), search, watch_))
            if (well_inside(ball.outline, window, picture_)) return sighting_of(ball, false);
        return std::nullopt;
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

/// Fills in what the frame's plate shows. key: where the search starts, if it does.
void look(const Shot& shot, TrackRecord& record, const std::optional<Outline>& key) {
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
    record.ball = key ? search.near(*key) : search.whole();
}

/// One frame's record. A frame that cannot be read is an answer; an interruption is not.
TrackRecord tracked(const Shot& shot, int frame, const std::optional<Outline>& key) {
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
            look(shot, record, key);
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

    bool knows(int frame) const { return records_.contains(frame); }
    bool there(int frame) const { return shot_.plates->has(frame); }

    void search(const Frames& frames, const std::string& what) {
        const Progress progress = shot_.console.frames(what, frames.size());
        for_each_frame(
            frames.size(), shot_.jobs, [&](std::size_t i) { add(tracked(frames[i])); },
            {&stop_requested(), nullptr}, progress);
    }

private:
    TrackRecord tracked(int frame) const {
        const int key = key_frame(frame, [&](int n) { return there(n); });
        std::optional<Outline> outline;
        if (key != frame) {
            const std::lock_guard hold(lock_);
            const auto record = records_.find(key);
            if (record != records_.end() && record->second.ball && record->second.ball->sure)
                outline = record->second.ball->outline;
        }
        return chromeball::tracked(shot_, frame, outline);
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
    for (const int frame : shot.frames) {
        if (track.knows(frame)) continue;
        const int key = key_frame(frame, [&](int n) { return track.there(n); });
        if (key == frame) {
            keys.insert(frame);
            continue;
        }
        todo.push_back(frame);
        // Of a frame that is not there nothing is searched, and of a told ball no key is needed.
        if (!shot.solving.told && track.there(frame) && !track.knows(key)) keys.insert(key);
    }
    track.search({keys.begin(), keys.end()}, "searching key frames");
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
