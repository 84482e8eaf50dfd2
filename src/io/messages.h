#pragma once

#include <string>
#include <string_view>

#include "core/error.h"

namespace chromeball::io {

/// "path: text" as an Error of kind `failed`, in one line whatever a library's message holds.
Error failure(const std::string& path, std::string_view text);

/// The system's words for an errno value, in a thread-safe way.
std::string system_reason(int error_number);

}  // namespace chromeball::io
