#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

// Numbers in file headers. The caller has checked that they lie within.

namespace chromeball::io {

inline std::uint32_t byte_at(std::span<const std::byte> bytes, std::size_t at) {
    return std::to_integer<std::uint32_t>(bytes[at]);
}
inline std::uint32_t big_endian_16(std::span<const std::byte> bytes, std::size_t at) {
    return byte_at(bytes, at) << 8 | byte_at(bytes, at + 1);
}
inline std::uint32_t big_endian_32(std::span<const std::byte> bytes, std::size_t at) {
    return big_endian_16(bytes, at) << 16 | big_endian_16(bytes, at + 2);
}
inline std::uint32_t little_endian_16(std::span<const std::byte> bytes, std::size_t at) {
    return byte_at(bytes, at) | byte_at(bytes, at + 1) << 8;
}
inline std::uint32_t little_endian_32(std::span<const std::byte> bytes, std::size_t at) {
    return little_endian_16(bytes, at) | little_endian_16(bytes, at + 2) << 16;
}
inline std::uint64_t little_endian_64(std::span<const std::byte> bytes, std::size_t at) {
    return little_endian_32(bytes, at) | std::uint64_t{little_endian_32(bytes, at + 4)} << 32;
}

/// Whether the text stands there; this one looks itself whether there is enough.
inline bool starts_with(std::span<const std::byte> bytes, std::size_t offset,
                        std::string_view wanted) {
    return bytes.size() >= offset + wanted.size() &&
           std::memcmp(bytes.data() + offset, wanted.data(), wanted.size()) == 0;
}

}  // namespace chromeball::io
