#include "core/metadata.h"

#include <algorithm>
#include <utility>

namespace chromeball {

const Attribute* Metadata::find(std::string_view name) const {
    const auto found = std::find_if(attributes_.begin(), attributes_.end(),
                                    [&](const Attribute& a) { return a.name == name; });
    return found == attributes_.end() ? nullptr : &*found;
}

std::optional<double> Metadata::number(std::string_view name) const {
    const Attribute* attribute = find(name);
    if (!attribute || attribute->numbers.empty()) return std::nullopt;
    return attribute->numbers.front();
}

std::optional<std::string> Metadata::text(std::string_view name) const {
    const Attribute* attribute = find(name);
    if (!attribute || attribute->type != "string") return std::nullopt;
    return attribute->text;
}

void Metadata::set(Attribute attribute) {
    const auto found = std::find_if(attributes_.begin(), attributes_.end(),
                                    [&](const Attribute& a) { return a.name == attribute.name; });
    if (found != attributes_.end())
        *found = std::move(attribute);
    else
        attributes_.push_back(std::move(attribute));
}

void Metadata::set(std::string name, std::string text) {
    set(Attribute{std::move(name), "string", {}, std::move(text)});
}

void Metadata::set(std::string name, double number) {
    set(Attribute{std::move(name), "double", {number}, {}});
}

}  // namespace chromeball
