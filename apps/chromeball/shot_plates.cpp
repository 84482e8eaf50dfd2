#include "shot_plates.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <numeric>

#include "core/error.h"
#include "io/input_file.h"
#include "photo_job.h"
#include "shot/records.h"
#include "shot/track.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

/// Much more than any header.
constexpr std::size_t kDigested = 64 * 1024;

void check_whole(const Photo& photo) {
    if (!photo.damage.empty()) throw Error(Error::Kind::failed, damage_warning(photo));
}

}  // namespace

Plates::Plates(const std::string& typed) : typed_(typed) {
    // A clip's name has no place for a number; what has one is a sequence whatever its extension.
    pattern_ = FramePattern::parse(typed);
    if (pattern_ && !(is_clip_name(typed) && fs::exists(typed))) return;
    pattern_.reset();
    if (!is_clip_name(typed))
        throw Error(Error::Kind::usage,
                    fmt::format("{}: the name of a shot's plates needs a place for the frame's "
                                "number: plate.####.exr, plate.%04d.exr, plate.$F4.exr or "
                                "plate.@.exr (or give a film clip: .mov, .mp4, ...); of a single "
                                "photo use convert",
                                typed));
    clip_ = std::make_unique<Clip>(typed);
}

Frames Plates::there() const {
    if (pattern_) return pattern_->on_disk();
    Frames frames(static_cast<std::size_t>(clip_->frames()));
    std::iota(frames.begin(), frames.end(), 1);
    return frames;
}

bool Plates::has(int frame) const {
    if (clip_) return frame >= 1 && frame <= clip_->frames();
    std::error_code error;
    return fs::exists(pattern_->path(frame), error);
}

std::string Plates::name(int frame) const {
    return pattern_ ? pattern_->path(frame) : fmt::format("{}[{}]", typed_, frame);
}

std::string Plates::file(int frame) const { return pattern_ ? pattern_->path(frame) : typed_; }

std::string Plates::stamp(int frame) const {
    std::error_code error;
    const auto size = fs::file_size(file(frame), error);
    if (error) return "none";
    const auto date = fs::last_write_time(file(frame), error);
    return fmt::format("{}-{}", size, date.time_since_epoch().count());
}

std::string Plates::digest(int frame) const {
    const std::string path = file(frame);
    std::error_code error;
    const auto size = fs::file_size(path, error);
    if (error) return "none";
    const auto head = io::first_bytes(path, std::min<std::size_t>(size, kDigested));
    return fmt::format("{}-{}", size,
                       hash_of({reinterpret_cast<const char*>(head.data()), head.size()}));
}

Photo Plates::header(int frame, const ReadOptions& options) const {
    return pattern_ ? read_header(pattern_->path(frame), options) : clip_->read(frame - 1, true);
}

Photo Plates::read(int frame, const ReadOptions& options) const {
    if (!pattern_) return clip_->read(frame - 1);
    Photo photo = read_photo(pattern_->path(frame), options);
    check_whole(photo);
    return photo;
}

Photo Plates::part(int frame, const Window& window, std::int64_t max_pixels) const {
    ReadOptions options{max_pixels, std::pair(window.y, window.y + window.size.height)};
    Photo part = empty_part(header(frame, options), window);
    const auto take = [&](const Photo& band) { copy_shared(band, part); };
    if (pattern_) {
        options.bands = take;
        check_whole(read_photo(pattern_->path(frame), options));
    } else {
        take(clip_->read(frame - 1));
    }
    return part;
}

}  // namespace chromeball
