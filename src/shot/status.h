#pragma once

#include <map>
#include <string>
#include <string_view>

#include "shot/records.h"

namespace chromeball {

/// What the stages' values on disk say is done, whoever made them and whether they still run.
class ShotStatus {
public:
    /// Takes the text of one of the stages' files, of any stage; of two records of one frame the
    /// one that comes later counts. What is no record is passed over.
    void add(std::string_view text);

    /// Lines for eyes: what is tracked, solved and written, of how many frames where the solve
    /// tells that; then the frames that failed, each with its reason.
    std::string text() const;

private:
    struct Tracked {
        bool readable = true, found = false;
        std::string message;
    };
    struct Converted {
        bool written = false;
        std::string message;
    };
    struct Solved {
        FrameOutcome outcome = FrameOutcome::missing;
        bool flagged = false;
    };
    std::map<int, Tracked> tracked_;
    std::map<int, Solved> solved_;
    std::map<int, Converted> converted_;
};

}  // namespace chromeball
