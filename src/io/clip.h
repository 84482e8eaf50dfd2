#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/photo.h"

namespace chromeball {

/// Whether a file's name is that of a film clip: .mov, .mp4, .mkv, ...
bool is_clip_name(std::string_view path);

/// A film clip, read frame by frame through OpenImageIO's ffmpeg reader. May be used from several
/// threads; frames are decoded one at a time, fastest in order. What a frame holds does not depend
/// on what was read before.
class Clip {
public:
    /// Throws Error for a file that is missing or no clip.
    explicit Clip(const std::string& path);
    ~Clip();
    Clip(const Clip&) = delete;
    Clip& operator=(const Clip&) = delete;

    int frames() const;
    /// The frame, counted from 0, whole; only its description where `header_only`. Throws Error.
    Photo read(int index, bool header_only = false);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace chromeball
