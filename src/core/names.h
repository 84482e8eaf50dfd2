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

}  // namespace chromeball
