#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shot/frames.h"

namespace chromeball {

/// The name of a shot's files, with a place for the frame's number: `plate.####.exr`,
/// `plate.%04d.exr`, `plate.$F4.exr`, `plate.@.exr`, also within folders' names. Where several
/// kinds of places occur the first of %04d, $F4, #, @ counts and the others are ordinary letters;
/// where one occurs more than once, all get the same number.
class FramePattern {
public:
    /// Nothing where the text has no place for a number.
    static std::optional<FramePattern> parse(std::string_view text);

    /// The file of a frame; its number has at least as many digits as the pattern asks for.
    std::string path(int frame) const;
    /// The number in a path that the pattern could have made; nothing for others.
    std::optional<int> frame_of(std::string_view path) const;
    const std::string& text() const { return text_; }

    /// The folder that holds all of it: what stands before the part with the first place.
    std::string folder() const;
    /// What stands behind the folder, without the places and what sets them apart: "sh010.exr" of
    /// "probes/sh010.####.exr".
    std::string name() const;

    /// The frames whose files are there. Reads the folder once; throws Error where it cannot.
    Frames on_disk() const;

private:
    struct Place {
        std::size_t at;  ///< in literal_: before which letter
        int digits;
    };
    std::string text_;
    std::string literal_;
    std::vector<Place> places_;
};

}  // namespace chromeball
