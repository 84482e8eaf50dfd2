#pragma once

#include <memory>
#include <optional>
#include <string>

#include "io/clip.h"
#include "io/read.h"
#include "shot/frames.h"
#include "shot/pattern.h"

namespace chromeball {

/// The pictures of a shot: files of a pattern, or a clip whose frames count from 1. May be used
/// from several threads.
class Plates {
public:
    /// Throws Error (usage) for a name that is neither.
    explicit Plates(const std::string& typed);

    const std::string& typed() const { return typed_; }
    bool is_clip() const { return clip_ != nullptr; }
    /// The frames that there are.
    Frames there() const;
    bool has(int frame) const;
    /// The frame's file, or the clip's name with the frame in brackets.
    std::string name(int frame) const;
    /// The file that the frame is in.
    std::string file(int frame) const;
    /// Size and date of the file: another stamp, another picture.
    std::string stamp(int frame) const;
    /// What the file says about itself: its size and a hash of its beginning. Does not depend on
    /// where and when it was copied.
    std::string digest(int frame) const;

    Photo header(int frame, const ReadOptions& options) const;
    /// Of a clip all rows are read whatever the options say.
    Photo read(int frame, const ReadOptions& options) const;
    /// What a window shows, cut to what there is. Of a file little more than that is in memory.
    Photo part(int frame, const Window& window, std::int64_t max_pixels) const;

private:
    std::string typed_;
    std::optional<FramePattern> pattern_;
    std::unique_ptr<Clip> clip_;
};

}  // namespace chromeball
