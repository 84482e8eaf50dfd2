#include "core/names.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

namespace chromeball {
namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

/// Levenshtein distance, ignoring case.
int edit_distance(std::string_view a, std::string_view b) {
    std::vector<int> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 0; i < a.size(); ++i) {
        int diagonal = std::exchange(row[0], static_cast<int>(i) + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const int replaced = diagonal + (lower(a[i]) != lower(b[j]));
            diagonal = std::exchange(row[j + 1], std::min({row[j] + 1, row[j + 1] + 1, replaced}));
        }
    }
    return row.back();
}

bool contains(std::string_view text, std::string_view part) {
    return std::search(text.begin(), text.end(), part.begin(), part.end(),
                       [](char a, char b) { return lower(a) == lower(b); }) != text.end();
}

}  // namespace

std::vector<std::string> nearest_names(std::string_view wanted,
                                       const std::vector<std::string>& names, int most) {
    std::vector<std::pair<int, std::string>> near;
    for (const std::string& name : names) {
        int distance = edit_distance(wanted, name);
        // A part of the name, as "logc" of "ARRI LogC EI800", is near whatever its length.
        if (wanted.size() >= 3 && (contains(name, wanted) || contains(wanted, name)))
            distance = std::min(distance, 1);
        const auto longest = static_cast<int>(std::max(wanted.size(), name.size()));
        if (distance * 2 <= longest) near.emplace_back(distance, name);
    }
    std::stable_sort(near.begin(), near.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> best;
    for (auto& [distance, name] : near)
        if (static_cast<int>(best.size()) < most) best.push_back(std::move(name));
    return best;
}

std::string quoted_list(const std::vector<std::string>& names) {
    std::string list;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i > 0) list += i + 1 == names.size() ? " or " : ", ";
        list += '"' + names[i] + '"';
    }
    return list;
}

std::string did_you_mean(std::string_view wanted, const std::vector<std::string>& names,
                         std::string_view otherwise) {
    const auto near = nearest_names(wanted, names);
    if (near.empty()) return std::string(otherwise) + " " + quoted_list(names);
    return "did you mean " + quoted_list(near) + "?";
}

std::string excerpt(std::string_view text) {
    constexpr std::size_t kMost = 60;
    std::string shown(text.substr(0, kMost));
    for (char& c : shown)
        if (c < 0x20 || c > 0x7e) c = '?';
    if (text.size() > kMost) shown += "...";
    return shown;
}

}  // namespace chromeball
