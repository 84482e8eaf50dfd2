#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "detect/contact_sheet.h"
#include "detect/detect.h"
#include "io/lines.h"
#include "io/write.h"
#include "photo_job.h"
#include "shot.h"
#include "shot/workers.h"
#include "stop.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

/// The options that made the shot, for the reports.
std::string settings_of(const Shot& shot) {
    const ShotOptions& o = shot.options;
    std::vector<std::pair<std::string, std::string>> settings{
        {"plates", o.input},
        {"frames", text_of(shot.frames)},
        {"output", shot.output->text()},
        {"layout", std::string(shot.plan.layout->name)},
        {"missing", o.missing},
        {"smooth_frames", fmt::format("{}", o.smooth_frames)},
        {"track_hash", shot.track_settings},
        {"solve_hash", shot.solve_settings},
        {"map_hash", shot.map_settings}};
    if (shot.plan.preset) settings.emplace_back("preset", shot.plan.preset->name);
    if (o.map.size) settings.emplace_back("size", fmt::format("{}", *o.map.size));
    if (o.lock) settings.emplace_back("lock", "true");
    for (const std::string& key : o.keys) settings.emplace_back("key " + key, "by hand");
    return json_object(settings);
}

FrameReport report_of_frame(int frame, const SolvedShot& solved,
                            const std::map<int, ConvertRecord>& converted) {
    FrameReport report;
    report.frame = frame;
    report.flagged = true;
    const auto one = solved.frames.find(frame);
    if (one == solved.frames.end()) {
        report.outcome = FrameOutcome::failed;
        report.message = "not solved yet: run --stage solve with this frame";
        return report;
    }
    const SolvedFrame& f = one->second;
    report.outcome = f.outcome;
    report.outline = f.outline;
    report.tracked = f.tracked;
    report.confidence = f.confidence;
    report.message = f.message;
    report.flagged = f.flagged;
    if (f.outcome == FrameOutcome::missing || f.outcome == FrameOutcome::failed) return report;
    const auto record = converted.find(frame);
    if (record == converted.end() || !record->second.written) {
        report.outcome = FrameOutcome::failed;
        report.flagged = true;
        report.message = record == converted.end() ? "not converted yet: run --stage convert"
                                                   : record->second.message;
    } else {
        report.seconds = record->second.seconds;
    }
    return report;
}

std::string png_of(const Photo& picture) {
    WriteOptions write;
    write.format = FileFormat::png;
    write.bits = 8;
    const auto bytes = encode_image(drawn_image(picture).view(), write);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Small pictures of a frame's plate, with its outline, and of its map.
void add_pictures(const Shot& shot, FrameReport& frame, bool plate) {
    try {
        if (plate && shot.plates->has(frame.frame)) {
            const Photo photo =
                shot.plates->read(frame.frame, {shot.options.photo.max_pixels, std::nullopt});
            std::vector<Candidate> shown;
            if (frame.outline) shown.push_back({*frame.outline, {}, frame.confidence, 1, 0});
            frame.thumbnail = png_of(thumbnail(overlay(photo, shown, 0)));
        }
        const OutputPlan plan = shot.plan_of(frame.frame);
        const std::string map = plan.layout->separate_faces ? plan.face_files()[0] : plan.path;
        if (fs::exists(map)) frame.probe = png_of(thumbnail(overlay(read_photo(map), {}, 0)));
    } catch (const Error& e) {
        // A picture that cannot be made is only not shown.
        if (e.kind() == Error::Kind::interrupted) throw;
    }
}

/// Every frame that is flagged, and others evenly, at most so many.
std::vector<std::size_t> shown_frames(const std::vector<FrameReport>& frames, std::size_t most,
                                      bool flagged) {
    std::vector<std::size_t> wanted, others;
    for (std::size_t i = 0; i < frames.size(); ++i)
        (flagged && frames[i].flagged ? wanted : others).push_back(i);
    if (wanted.size() > most) wanted.resize(most);
    const std::size_t room = std::min(most - wanted.size(), others.size());
    for (std::size_t i = 0; i < room; ++i) wanted.push_back(others[i * others.size() / room]);
    std::sort(wanted.begin(), wanted.end());
    return wanted;
}

void add_all_pictures(const Shot& shot, ShotReport& report) {
    constexpr std::size_t kMostPlates = 48, kMostProbes = 96;
    const auto plates = shown_frames(report.frames, kMostPlates, true);
    auto shown = shown_frames(report.frames, kMostProbes, false);
    shown.insert(shown.end(), plates.begin(), plates.end());
    std::sort(shown.begin(), shown.end());
    shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
    for_each_frame(
        shown.size(), shot.jobs,
        [&](std::size_t i) {
            const bool plate = std::binary_search(plates.begin(), plates.end(), shown[i]);
            add_pictures(shot, report.frames[shown[i]], plate);
        },
        {&stop_requested(), nullptr}, shot.console.frames("report's pictures", shown.size()));
}

}  // namespace

std::map<int, ConvertRecord> convert_records(const Shot& shot) {
    std::map<int, ConvertRecord> records;
    for_each_line(shot.stage_text("convert"), [&](std::string_view line) {
        auto record = convert_record_from(line);
        if (record && record->settings == shot.convert_settings)
            records[record->frame] = std::move(*record);
    });
    return records;
}

ShotReport report_of(const Shot& shot, const SolvedShot& solved, double wall_seconds) {
    ShotReport report;
    report.title = shot.plates->typed();
    report.settings_json = settings_of(shot);
    report.wall_seconds = wall_seconds;
    report.jobs = shot.jobs;
    const auto converted = convert_records(shot);
    const auto tracked = track_records(shot);
    for (std::size_t i = 0; i < shot.frames.size(); ++i) {
        report.frames.push_back(report_of_frame(shot.frames[i], solved, converted));
        report.frames.back().seconds += tracked[i].seconds;
    }
    return report;
}

void write_reports(const Shot& shot, ShotReport report) {
    for (const std::string& file : shot.options.reports)
        if (fs::path(file).extension() == ".json") write_file(file, to_json(report));
    const auto page = [](const std::string& file) { return fs::path(file).extension() == ".html"; };
    if (std::none_of(shot.options.reports.begin(), shot.options.reports.end(), page)) return;
    add_all_pictures(shot, report);
    for (const std::string& file : shot.options.reports)
        if (page(file)) write_file(file, to_html(report));
}

}  // namespace chromeball
