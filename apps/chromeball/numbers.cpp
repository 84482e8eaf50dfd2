#include "numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/error.h"

namespace chromeball {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<double> number(std::string_view text) {
    text = trimmed(text);
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

}  // namespace

std::vector<double> parse_numbers(std::string_view option, std::string_view value,
                                  std::initializer_list<std::size_t> counts,
                                  std::string_view form) {
    std::vector<double> numbers;
    const auto fail = [&](const std::string& why) {
        throw Error(Error::Kind::usage,
                    fmt::format("{} {}: {}; expected {}", option, value, why, form));
    };
    for (std::string_view rest = value;;) {
        const auto comma = rest.find(',');
        const auto n = number(rest.substr(0, comma));
        if (!n) fail(fmt::format("\"{}\" is no number", trimmed(rest.substr(0, comma))));
        numbers.push_back(*n);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    if (std::find(counts.begin(), counts.end(), numbers.size()) == counts.end())
        fail(fmt::format("{} number{}", numbers.size(), numbers.size() == 1 ? "" : "s"));
    return numbers;
}

}  // namespace chromeball
