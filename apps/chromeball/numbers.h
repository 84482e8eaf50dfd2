#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace chromeball {

/// The numbers of an option's value, separated by commas. Throws Error (usage) that names the
/// option unless there are as many as one of `counts` and all are finite. `form` shows how it is
/// meant: "CX,CY,R".
std::vector<double> parse_numbers(std::string_view option, std::string_view value,
                                  std::initializer_list<std::size_t> counts, std::string_view form);

}  // namespace chromeball
