#include "shot/html_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace chromeball::html {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// How many bytes of well-formed UTF-8 the text begins with, as one character; 0: none.
/// The table is that of the Unicode standard, 3.9, table 3-7: no surrogates, no overlong forms.
std::size_t character_length(std::string_view text) {
    struct Form {
        unsigned char first_low, first_high, second_low, second_high;
        std::size_t length;
    };
    static constexpr Form kForms[] = {
        {0xC2, 0xDF, 0x80, 0xBF, 2}, {0xE0, 0xE0, 0xA0, 0xBF, 3}, {0xE1, 0xEC, 0x80, 0xBF, 3},
        {0xED, 0xED, 0x80, 0x9F, 3}, {0xEE, 0xEF, 0x80, 0xBF, 3}, {0xF0, 0xF0, 0x90, 0xBF, 4},
        {0xF1, 0xF3, 0x80, 0xBF, 4}, {0xF4, 0xF4, 0x80, 0x8F, 4},
    };
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(0) < 0x80) return 1;
    for (const Form& form : kForms) {
        if (byte(0) < form.first_low || byte(0) > form.first_high) continue;
        if (text.size() < form.length || byte(1) < form.second_low || byte(1) > form.second_high)
            return 0;
        for (std::size_t i = 2; i < form.length; ++i)
            if ((byte(i) & 0xC0) != 0x80) return 0;
        return form.length;
    }
    return 0;
}

std::string_view entity(char c) {
    switch (c) {
        case '&':
            return "&amp;";
        case '<':
            return "&lt;";
        case '>':
            return "&gt;";
        case '"':
            return "&quot;";
        case '\'':
            return "&#39;";
        default:
            return {};
    }
}

bool is_control(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7F;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

}  // namespace

std::string escaped(std::string_view bytes) {
    std::string text;
    text.reserve(bytes.size() + 16);
    while (!bytes.empty()) {
        const std::size_t length = character_length(bytes);
        if (length == 0 || is_control(bytes[0]))
            text += kReplacement;
        else if (const std::string_view known = entity(bytes[0]); !known.empty())
            text += known;
        else
            text += bytes.substr(0, length);
        bytes.remove_prefix(length == 0 ? 1 : length);
    }
    return text;
}

std::string number(double value, int decimals) {
    if (!std::isfinite(value)) return "\xE2\x80\x93";  // en dash
    return fmt::format("{:.{}f}", value, decimals);
}

std::string data_uri(std::string_view file) {
    if (file.starts_with("\x89PNG\r\n\x1A\n")) return "data:image/png;base64," + base64(file);
    if (file.starts_with("\xFF\xD8\xFF")) return "data:image/jpeg;base64," + base64(file);
    return {};
}

std::string indented_json(std::string_view json) {
    std::string text;
    std::string open;  // the brackets that are, "{[{"
    bool quoted = false;
    const auto line = [&] {
        text += '\n';
        for (const char bracket : open)
            if (bracket == '{') text += "  ";
    };
    const auto next = [&](std::size_t i) {
        const std::size_t at = json.find_first_not_of(" \n\r\t", i + 1);
        return at == std::string_view::npos ? '\0' : json[at];
    };
    char before = 0;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (quoted) {
            text += c;
            if (c == '\\' && i + 1 < json.size()) text += json[++i];
            quoted = c != '"';
            continue;
        }
        if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
        if ((c == '}' || c == ']') && !open.empty()) open.pop_back();
        if (c == '}' && before != '{') line();
        text += c;
        before = c;
        quoted = c == '"';
        if (c == '{' || c == '[') open += c;
        if (c == '{' && next(i) != '}') line();
        if (c == ':') text += ' ';
        // Lists stay on their line: they are short rows of numbers.
        if (c == ',' && open.ends_with('[')) text += ' ';
        if (c == ',' && !open.ends_with('[')) line();
    }
    return text;
}

double radius(const Outline& outline) { return std::sqrt(outline.a * outline.b); }

}  // namespace chromeball::html
