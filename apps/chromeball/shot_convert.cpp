#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>

#include "io/facts.h"
#include "io/lines.h"
#include "io/write.h"
#include "photo_job.h"
#include "resample/resample.h"
#include "shot.h"
#include "shot/workers.h"
#include "shot_frame.h"
#include "shot_insert.h"
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
        for (const SolvedFrame* one : averaged(frame)) words += words_of(shot_, *one);
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
            return chromeball::is_current(shot_, frame.frame, file, fingerprint, plan.format);
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

    FrameMap single_map(const SolvedFrame& frame) const {
        PhotoJob job = solved_job(shot_, solved_.head, frame);
        const MirrorBall ball = projection_of(job);
        BallLight light = ball_light(job, ball, frame.lens_blur, shot_.options.photo.cropped,
                                     shot_.options.color, shot_.options.map, *shot_.colors);
        FrameMap result;
        const ResampleOptions how = resampling(shot_.options.map, shot_.plan,
                                               frame_to_world(shot_, job.photo, frame.frame));
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
        if (shot.options.insert.mesh) insert_ = std::make_unique<Insert>(shot, solved.head);
        for (const auto& [frame, record] : convert_records(shot))
            if (record.written) written_.insert(frame);
    }

    const Conversion& conversion() const { return conversion_; }

    /// Makes what of a frame is not there yet. False where all of it was.
    bool convert(const SolvedFrame& frame) {
        const auto start = Clock::now();
        ConvertRecord record;
        record.frame = frame.frame;
        record.settings = shot_.convert_settings;
        bool made = true;
        try {
            made = make_map(frame, record);
            if (insert_ && record.written) made = put_object(frame, record) || made;
        } catch (const GivenUp&) {
            throw;
        } catch (const Error& e) {
            if (e.kind() == Error::Kind::interrupted) throw;
            record.written = false;
            record.message = e.what();
        } catch (const std::bad_alloc&) {
            record.written = false;
            record.message = "not enough memory; use fewer --jobs or a smaller --size";
        }
        if (record.written && !made) {
            skip(frame.frame);
            return false;
        }
        record.seconds = std::chrono::duration<double>(Clock::now() - start).count();
        note(record);
        return true;
    }

private:
    /// A frame that is there already; an earlier run may have been killed before it said so.
    void skip(int frame) {
        if (written_.contains(frame)) return;
        ConvertRecord record;
        record.frame = frame;
        record.settings = shot_.convert_settings;
        record.written = true;
        note(record);
    }

    void note(const ConvertRecord& record) {
        const std::lock_guard hold(lock_);
        append_line(file_, to_line(record));
    }

    /// Whether it had to.
    bool make_map(const SolvedFrame& frame, ConvertRecord& record) {
        const std::string fingerprint = conversion_.fingerprint(frame);
        record.written = !shot_.options.overwrite && conversion_.is_current(frame, fingerprint);
        if (record.written) return false;
        FrameMap map = conversion_.map_of(frame);
        write(frame, record, [&] { return conversion_.write(frame, std::move(map), fingerprint); });
        return true;
    }

    /// The same of the plate with an object in it; the frame counts as written with both.
    bool put_object(const SolvedFrame& frame, ConvertRecord& record) {
        record.written = false;
        const std::string fingerprint = insert_->fingerprint(frame);
        record.written = !shot_.options.overwrite && insert_->is_current(frame, fingerprint);
        if (record.written) return false;
        auto picture = insert_->picture(frame);
        write(frame, record,
              [&] { return insert_->write(frame, std::move(picture), fingerprint); });
        return true;
    }

    /// file: writes it and gives the warnings.
    template <class File>
    void write(const SolvedFrame& frame, ConvertRecord& record, const File& file) {
        const std::string name = shot_.plates->name(frame.frame);
        try {
            for (const std::string& one : file()) shot_.warnings.add(name, one);
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
    std::unique_ptr<Insert> insert_;  ///< none: no object is asked for
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
            if (!converter.convert(*todo[i])) ++skipped;
        },
        {&stop_requested(), nullptr}, progress);
    if (skipped > 0)
        shot.console.say(
            fmt::format("{} of {} frames were there already", skipped.load(), todo.size()));
}

}  // namespace chromeball
