#pragma once

#include <string>

#include "core/error.h"

namespace chromeball {

/// Ends a command that was asked for wrongly: status 2. `why` names the option or file and tells
/// the way out.
[[noreturn]] inline void refuse(const std::string& why) { throw Error(Error::Kind::usage, why); }

}  // namespace chromeball
