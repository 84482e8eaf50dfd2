#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chromeball {

/// One named fact of a file. `type` is an OpenEXR attribute type name ("string", "int", "float",
/// "double", "v2f", "v3f", "m33f", "m44f", "timecode", "keycode", "rational", "box2i", ...);
/// numbers hold its components in file order, text a string's value.
struct Attribute {
    std::string name;
    std::string type;
    std::vector<double> numbers;
    std::string text;

    bool operator==(const Attribute&) const = default;
};

/// The facts that a file holds besides its pixels, in the file's order, each name once.
class Metadata {
public:
    /// nullptr where there is none of that name (exact case).
    const Attribute* find(std::string_view name) const;
    /// The first component of a numeric attribute.
    std::optional<double> number(std::string_view name) const;
    std::optional<std::string> text(std::string_view name) const;

    /// Replaces an attribute of the same name, else appends.
    void set(Attribute attribute);
    void set(std::string name, std::string text);
    void set(std::string name, double number);

    const std::vector<Attribute>& all() const { return attributes_; }

private:
    std::vector<Attribute> attributes_;
};

}  // namespace chromeball
