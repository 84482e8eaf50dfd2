#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <set>

#include "io/facts.h"
#include "io/lines.h"
#include "io/write.h"
#include "photo_job.h"
#include "resample/resample.h"
#include "shot.h"
#include "shot/workers.h"
#include "stop.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

bool has_pixels(const SolvedFrame& frame) {
    return frame.outline && frame.outcome != FrameOutcome::missing &&
           frame.outcome != FrameOutcome::failed;
}

/// The frames whose maps are averaged for one, itself among them: those around it on the same piece
/// of the path, where light may change but the ball does not jump.
std::vector<const SolvedFrame*> averaged_for(const SolvedFrame& frame, const SolvedShot& solved,
                                             int smooth_frames) {
    std::vector<const SolvedFrame*> all;
    const int reach = smooth_frames / 2;
    for (int n = frame.frame - reach; n <= frame.frame + reach; ++n) {
        const auto one = solved.frames.find(n);
        if (one != solved.frames.end() && has_pixels(one->second) &&
            one->second.piece == frame.piece)
            all.push_back(&one->second);
    }
    return all;
}

/// A map in the working space, with what its file will tell of it.
struct FrameMap {
    Image map;
    Rotation rotation;
    Provenance origin;
    Metadata metadata;
    std::vector<std::string> warnings;
};

class Conversion {
public:
    Conversion(const Shot& shot, const SolvedShot& solved) : shot_(shot), solved_(solved) {
        Source finest;
        finest.mean_solid_angle = solved.head.steradians;
        size_ = shot.options.map.size.value_or(
            solved.head.steradians > 0 ? natural_size(finest, *shot.plan.layout) : 64);
    }

    int size() const { return size_; }

    /// A hash of all that the frame's files depend on.
    std::string fingerprint(const SolvedFrame& frame) const {
        std::string words = fmt::format("{} {}\n", shot_.map_settings, size_);
        if (solved_.head.focal) words += fmt::format("focal {}\n", *solved_.head.focal);
        for (const SolvedFrame* one : averaged(frame)) {
            const Outline& o = *one->outline;
            words += fmt::format("{} {} {} {} {} {} {} {}\n", one->frame,
                                 shot_.plates->digest(one->frame), o.cx, o.cy, o.a, o.b, o.angle,
                                 one->lens_blur);
        }
        return hash_of(words);
    }

    /// Whether the frame's files are there, whole, and made of this.
    bool is_current(const SolvedFrame& frame, const std::string& fingerprint) const {
        const OutputPlan plan = shot_.plan_of(frame.frame);
        std::vector<std::string> files{plan.path};
        if (plan.layout->separate_faces) {
            const auto faces = plan.face_files();
            files.assign(faces.begin(), faces.end());
        }
        return std::all_of(files.begin(), files.end(), [&](const std::string& file) {
            remove_leftover(file);
            return newer_than_plate(file, frame.frame) && is_whole(file, fingerprint, plan.format);
        });
    }

    /// The map; reads only the ball's rows.
    FrameMap map_of(const SolvedFrame& frame) const {
        const auto frames = averaged(frame);
        FrameMap result = single_map(frame);
        if (frames.size() < 2) return result;
        std::vector<double> sum(result.map.size().pixels() *
                                static_cast<std::size_t>(result.map.channels()));
        int count = 0;
        for (const SolvedFrame* one : frames) {
            if (one == &frame) {
                add(sum, result.map);
                ++count;
                continue;
            }
            try {
                add(sum, single_map(*one).map);
                ++count;
            } catch (const Error& e) {
                // A neighbour that cannot be read is only missing from the mean.
                if (e.kind() == Error::Kind::interrupted) throw;
            }
        }
        float* values = result.map.row(0);
        for (std::size_t i = 0; i < sum.size(); ++i) values[i] = static_cast<float>(sum[i] / count);
        return result;
    }

    /// Writes it; tells what the user should know.
    std::vector<std::string> write(const SolvedFrame& frame, FrameMap map,
                                   const std::string& fingerprint) const {
        const OutputPlan plan = shot_.plan_of(frame.frame);
        const fs::path folder = fs::path(plan.path).parent_path();
        if (!folder.empty() && !fs::exists(folder)) make_folder(folder.string());
        map.origin.fingerprint = fingerprint;
        const WrittenMap written =
            write_finished(std::move(map.map), plan, shot_.options.map, map.rotation,
                           std::move(map.origin), std::move(map.metadata), *shot_.colors);
        std::vector<std::string> warnings = std::move(map.warnings);
        for (const std::string& one : warnings_of(written, plan, shot_.options.map))
            shot_.warnings.add(plan.path, one);
        return warnings;
    }

private:
    static void add(std::vector<double>& sum, const Image& map) {
        const float* values = map.row(0);
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += static_cast<double>(values[i]);
    }

    std::vector<const SolvedFrame*> averaged(const SolvedFrame& frame) const {
        return averaged_for(frame, solved_, shot_.options.smooth_frames);
    }

    bool newer_than_plate(const std::string& file, int frame) const {
        std::error_code error;
        const auto made = fs::last_write_time(file, error);
        if (error) return false;
        const auto plate = fs::last_write_time(shot_.plates->file(frame), error);
        return error || made >= plate;
    }

    bool is_whole(const std::string& file, const std::string& fingerprint,
                  FileFormat format) const {
        try {
            const Photo header = read_header(file);
            const auto past = provenance_from(header.metadata);
            if (!past || past->fingerprint != fingerprint) return false;
            // The reader holds an EXR against its table of contents; others show it by being read.
            if (format != FileFormat::exr) read_photo(file);
            return true;
        } catch (const Error&) {
            return false;
        }
    }

    /// The frame's photo, as far as it is needed, with the solved outline as its ball.
    PhotoJob job_of(const SolvedFrame& frame) const {
        const PhotoOptions options = shot_.photo_options(frame.frame);
        if (options.cropped)
            return open_photo(shot_.plates->file(frame.frame), options,
                              {&stop_requested(), nullptr});
        // The reader cuts the rows to those that there are.
        constexpr Window kAnywhere{-(1 << 28), -(1 << 28), {1 << 29, 1 << 29}};
        const Window needed = needed_window(*frame.outline, kAnywhere);
        PhotoJob job;
        job.photo = shot_.plates->read(
            frame.frame, {options.max_pixels, std::pair(needed.y, needed.y + needed.size.height)});
        job.camera = choose_camera(options, job.photo);
        if (!job.camera.told && solved_.head.focal) {
            job.camera.camera.focal = solved_.head.focal;
            job.camera.source = "estimated from the outlines";
            job.camera.told = true;
        }
        job.ball.found = true;
        job.ball.outline = *frame.outline;
        job.ball.how = "solved";
        if (!job.camera.note.empty()) job.warnings.push_back(job.camera.note);
        if (!job.camera.told)
            job.warnings.push_back(unknown_lens_warning(job.photo.name, ", --cameras"));
        return job;
    }

    Rotation to_world(const Photo& photo, int frame) const {
        if (const auto told = told_rotation(shot_.options.map)) return *told;
        const auto camera = shot_.cameras.find(frame);
        if (camera != shot_.cameras.end() && camera->second.to_world)
            return *camera->second.to_world;
        if (!photo.metadata.find("worldToCamera")) return {};
        const auto rotation = rotation_from_metadata(photo, shot_.options.photo.camera_axes);
        if (!rotation)
            shot_.warnings.add(photo.name,
                               "its worldToCamera is no rotation and is not used; give "
                               "--camera-to-world or --cameras");
        return rotation.value_or(Rotation());
    }

    FrameMap single_map(const SolvedFrame& frame) const {
        PhotoJob job = job_of(frame);
        const MirrorBall ball = projection_of(job);
        BallLight light = ball_light(job, ball, frame.lens_blur, shot_.options.photo.cropped,
                                     shot_.options.color, shot_.options.map, *shot_.colors);
        FrameMap result;
        const ResampleOptions how =
            resampling(shot_.options.map, shot_.plan, to_world(job.photo, frame.frame));
        result.map =
            resample(light.source, *shot_.plan.layout, size_, how, {&stop_requested(), nullptr});
        result.rotation = how.rotation;
        result.origin.source = job.photo.name;
        result.origin.outline = ball.outline();
        result.origin.camera = job.camera.camera;
        result.metadata = pass_through(job.photo.metadata);
        result.warnings = std::move(job.warnings);
        for (const std::string& warning : light.warnings) result.warnings.push_back(warning);
        return result;
    }

    const Shot& shot_;
    const SolvedShot& solved_;
    int size_ = 64;
};

/// How many frames in a row may fail to be written before the target is given up: where nothing can
/// be written hundreds of messages help nobody.
constexpr int kMostUnwritten = 3;

class GivenUp : public Error {
public:
    explicit GivenUp(const std::string& why)
        : Error(Kind::failed,
                fmt::format("{} ({} frames in a row could not be written; what is done stays done: "
                            "the same words again continue)",
                            why, kMostUnwritten)) {}
};

/// Converts frames one by one and keeps the book.
class Converter {
public:
    Converter(const Shot& shot, const SolvedShot& solved)
        : shot_(shot), conversion_(shot, solved), file_(shot.stage_file("convert")) {
        for (const auto& [frame, record] : convert_records(shot))
            if (record.written) written_.insert(frame);
    }

    const Conversion& conversion() const { return conversion_; }

    void convert(const SolvedFrame& frame, const std::string& fingerprint) {
        const auto start = Clock::now();
        ConvertRecord record;
        record.frame = frame.frame;
        record.settings = shot_.map_settings;
        try {
            FrameMap map = conversion_.map_of(frame);
            write(frame, std::move(map), fingerprint, record);
        } catch (const GivenUp&) {
            throw;
        } catch (const Error& e) {
            if (e.kind() == Error::Kind::interrupted) throw;
            record.message = e.what();
        } catch (const std::bad_alloc&) {
            record.message = "not enough memory; use fewer --jobs or a smaller --size";
        }
        record.seconds = std::chrono::duration<double>(Clock::now() - start).count();
        note(record);
    }

    /// A frame that is there already; an earlier run may have been killed before it said so.
    void skip(int frame) {
        if (written_.contains(frame)) return;
        ConvertRecord record;
        record.frame = frame;
        record.settings = shot_.map_settings;
        record.written = true;
        note(record);
    }

    void note(const ConvertRecord& record) {
        const std::lock_guard hold(lock_);
        append_line(file_, to_line(record));
    }

private:
    void write(const SolvedFrame& frame, FrameMap map, const std::string& fingerprint,
               ConvertRecord& record) {
        const std::string name = shot_.plates->name(frame.frame);
        try {
            for (const std::string& one : conversion_.write(frame, std::move(map), fingerprint))
                shot_.warnings.add(name, one);
            record.written = true;
            unwritten_ = 0;
        } catch (const Error& e) {
            if (e.kind() == Error::Kind::interrupted) throw;
            record.message = e.what();
            if (++unwritten_ < kMostUnwritten) return;
            throw GivenUp(e.what());
        }
    }

    const Shot& shot_;
    Conversion conversion_;
    std::string file_;
    std::set<int> written_;  ///< by earlier runs, as their records say
    std::mutex lock_;
    std::atomic<int> unwritten_{0};
};

}  // namespace

void run_convert(const Shot& shot, const SolvedShot& solved) {
    std::vector<const SolvedFrame*> todo;
    for (const int frame : shot.frames) {
        const auto one = solved.frames.find(frame);
        if (one != solved.frames.end() && has_pixels(one->second)) todo.push_back(&one->second);
    }
    Converter converter(shot, solved);
    shot.console.say(fmt::format("{}: {} --size {}", shot.output->text(), shot.plan.layout->name,
                                 converter.conversion().size()));
    std::atomic<std::size_t> skipped{0};
    const Progress progress = shot.console.frames("converting", todo.size());
    for_each_frame(
        todo.size(), shot.jobs,
        [&](std::size_t i) {
            const std::string fingerprint = converter.conversion().fingerprint(*todo[i]);
            if (!shot.options.overwrite &&
                converter.conversion().is_current(*todo[i], fingerprint)) {
                converter.skip(todo[i]->frame);
                ++skipped;
            } else {
                converter.convert(*todo[i], fingerprint);
            }
        },
        {&stop_requested(), nullptr}, progress);
    if (skipped > 0)
        shot.console.say(
            fmt::format("{} of {} frames were there already", skipped.load(), todo.size()));
}

}  // namespace chromeball
