#include <algorithm>

#include "io/bytes.h"
#include "io/probe.h"

namespace chromeball::io {

std::string icc_description(std::span<const std::byte> profile) {
    if (profile.size() < 132) return {};
    const std::size_t count = std::min<std::size_t>(big_endian_32(profile, 128), 100);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t entry = 132 + 12 * i;
        if (entry + 12 > profile.size()) return {};
        if (!starts_with(profile, entry, "desc")) continue;
        const std::size_t at = big_endian_32(profile, entry + 4);
        if (at > profile.size() || profile.size() - at < 28) return {};
        const auto tag = profile.subspan(at);
        std::string text;
        if (starts_with(tag, 0, "desc")) {  // version 2: counted ASCII
            const std::size_t length =
                std::min<std::size_t>(big_endian_32(tag, 8), tag.size() - 12);
            text.assign(reinterpret_cast<const char*>(tag.data()) + 12, length);
        } else if (starts_with(tag, 0, "mluc")) {  // version 4: UTF-16, its ASCII part
            const std::size_t length = big_endian_32(tag, 20);
            const std::size_t offset = big_endian_32(tag, 24);
            for (std::size_t k = 0; k + 1 < length && offset + k + 1 < tag.size(); k += 2) {
                const auto c = big_endian_16(tag, offset + k);
                text += c < 128 ? static_cast<char>(c) : '?';
            }
        }
        return text.substr(0, text.find('\0'));
    }
    return {};
}

}  // namespace chromeball::io
