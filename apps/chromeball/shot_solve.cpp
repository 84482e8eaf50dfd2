#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "io/lines.h"
#include "io/write.h"
#include "map/mirror_ball.h"
#include "shot.h"

namespace chromeball {
namespace {

/// Solid angle that a pixel of the ball shows in the mean.
double steradians_per_pixel(const Outline& outline, const TrackRecord& record) {
    Camera camera = record.camera;
    if (record.distance)
        camera.focal = focal_from_distance(outline, camera.principal, *record.distance);
    const double hidden = camera.orthographic() ? 0 : cone_of(outline, camera).hidden_half_angle();
    return 2 * std::numbers::pi * (1 + std::cos(hidden)) / area(outline);
}

/// The focal length that the outlines tell, for all frames.
void adopt_focal(const Shot& shot, std::vector<TrackRecord>& records, SolveHead& head) {
    const auto hint = focal_of_shot(records);
    if (!hint) return;
    head.focal = hint->focal;
    for (TrackRecord& record : records) record.camera.focal = hint->focal;
    shot.console.warn(fmt::format(
        "{}: the focal length is not known; the outlines' shapes say {:.0f} pixels, give or take "
        "{:.0f}, if the plates are not cropped: give --focal-mm and --sensor-mm, --hfov, "
        "--focal-px, --distance-radii or --cameras if you know better, or --orthographic",
        shot.plates->typed(), hint->focal, hint->deviation));
}

void warn_of_lost_keys(const Shot& shot) {
    for (const auto& [frame, outline] : shot.solving.keys)
        if (!std::binary_search(shot.frames.begin(), shot.frames.end(), frame))
            shot.console.warn(fmt::format("--key {}: the frame is none of the shot's, {}", frame,
                                          text_of(shot.frames)));
}

}  // namespace

void run_solve(const Shot& shot) {
    std::vector<TrackRecord> records = track_records(shot);
    SolveHead head;
    head.settings = shot.solve_settings;
    adopt_focal(shot, records, head);
    warn_of_lost_keys(shot);
    const std::vector<SolvedFrame> solved = solve(records, shot.solving);
    std::string text;
    for (std::size_t i = 0; i < solved.size(); ++i) {
        text += to_line(solved[i]);
        if (!solved[i].outline) continue;
        const double finest = steradians_per_pixel(*solved[i].outline, records[i]);
        if (head.steradians == 0 || finest < head.steradians) head.steradians = finest;
    }
    write_file(shot.solve_file(), to_line(head) + text);
}

SolvedShot solved_shot(const Shot& shot) {
    SolvedShot solved;
    bool matches = false;
    for_each_line(read_text(shot.solve_file()), [&](std::string_view line) {
        if (const auto head = solve_head_from(line)) {
            matches = head->settings == shot.solve_settings;
            solved.head = *head;
        } else if (auto frame = solved_frame_from(line)) {
            solved.frames[frame->frame] = std::move(*frame);
        }
    });
    if (!matches)
        throw Error(
            Error::Kind::failed,
            fmt::format("{}: {}; run --stage solve first, with the same options", shot.solve_file(),
                        solved.frames.empty() ? "the shot is not solved yet"
                                              : "was solved with other settings"));
    return solved;
}

}  // namespace chromeball
