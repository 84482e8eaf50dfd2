#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chromeball {

/// Up to `most` of the names nearest to a mistyped one, best first: by edit distance, ignoring
/// case; none that is nothing like it.
std::vector<std::string> nearest_names(std::string_view wanted,
                                       const std::vector<std::string>& names, int most = 3);

/// The names in quotation marks, with commas and an "or": `"a", "b" or "c"`.
std::string quoted_list(const std::vector<std::string>& names);

/// The way out for a mistyped name: `did you mean "a"?`, or where nothing is like it `otherwise`
/// and all names there are.
std::string did_you_mean(std::string_view wanted, const std::vector<std::string>& names,
                         std::string_view otherwise = "choose");

/// The beginning of a text out of a file, fit for a message: at most 60 characters, and whatever a
/// terminal might take amiss shown as "?".
std::string excerpt(std::string_view text);

}  // namespace chromeball
