#pragma once

#include <stdexcept>
#include <string>

namespace chromeball {

/// A job that cannot be done, told so that the user can act on it: the thing, what was found, what
/// was wanted, the way out.
class Error : public std::runtime_error {
public:
    /// The kinds are also the program's exit statuses.
    enum class Kind { failed = 1, usage = 2, partial = 3, no_ball = 4, interrupted = 130 };

    Error(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
    Kind kind() const { return kind_; }

private:
    Kind kind_;
};

}  // namespace chromeball
