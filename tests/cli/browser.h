#pragma once

#include <set>
#include <string>

#include "cli/program.h"
#include "core/image.h"

// Pages as a browser shows them: headless Chromium, where it is installed.

namespace chromeball::test {

/// What a browser made of a page.
struct Visit {
    std::string console;             ///< what it said on the console
    std::set<std::string> requests;  ///< what the page asked the network for
    Image picture;
};

/// The browser's program; nullptr where there is none.
const char* browser(const TempFolder& folder);

/// Shows a page (its text) in a window of 1300x2400, unless further words for the browser say
/// otherwise. fragment: what stands behind the address, as "#here".
Visit visit(const TempFolder& folder, const char* program, const std::string& page,
            const Words& more = {}, const std::string& fragment = "");

}  // namespace chromeball::test
