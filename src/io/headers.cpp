#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "io/bytes.h"
#include "io/input_file.h"
#include "io/messages.h"
#include "io/probe.h"

// What our own eyes read in the headers of files, before a library opens them.

namespace chromeball::io {
namespace {

/// Walks a JPEG's segments. Calls segment(marker, payload) for each; returns whether the
/// end-of-image marker was met.
template <class OnSegment>
bool walk_jpeg(std::span<const std::byte> file, OnSegment segment) {
    std::size_t at = 2;
    while (at + 2 <= file.size()) {
        if (file[at] != std::byte{0xff}) {  // entropy-coded data up to the next marker
            const void* next = std::memchr(file.data() + at, 0xff, file.size() - at);
            if (!next) return false;
            at = static_cast<std::size_t>(static_cast<const std::byte*>(next) - file.data());
            continue;
        }
        const int marker = std::to_integer<int>(file[at + 1]);
        if (marker == 0xff) {  // fill byte
            ++at;
            continue;
        }
        if (marker == 0xd9) return true;
        if (marker == 0 || marker == 1 || (marker >= 0xd0 && marker <= 0xd8)) {
            at += 2;  // stuffing, restart markers: no payload
            continue;
        }
        if (at + 4 > file.size()) return false;
        const std::size_t length = big_endian_16(file, at + 2);
        if (length < 2 || at + 2 + length > file.size()) return false;
        segment(marker, file.subspan(at + 4, length - 2));
        at += 2 + length;
    }
    return false;
}

bool is_start_of_frame(int marker) {
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

using Extent = std::pair<std::int64_t, std::int64_t>;

std::optional<Extent> jpeg_size(std::span<const std::byte> head) {
    std::optional<Extent> size;
    walk_jpeg(head, [&](int marker, std::span<const std::byte> payload) {
        if (!size && is_start_of_frame(marker) && payload.size() >= 5)
            size = Extent{big_endian_16(payload, 3), big_endian_16(payload, 1)};
    });
    return size;
}

/// From the first directory of a classic TIFF, where it lies in the head.
std::optional<Extent> tiff_size(std::span<const std::byte> head) {
    if (head.size() < 8) return std::nullopt;
    const bool big = head[0] == std::byte{'M'};
    const auto u16 = [&](std::size_t at) {
        return big ? big_endian_16(head, at) : little_endian_16(head, at);
    };
    const auto u32 = [&](std::size_t at) {
        return big ? big_endian_32(head, at) : little_endian_32(head, at);
    };
    if (u16(2) != 42) return std::nullopt;
    const std::size_t directory = u32(4);
    if (directory + 2 > head.size()) return std::nullopt;
    std::int64_t width = 0;
    std::int64_t height = 0;
    for (std::size_t i = 0; i < u16(directory); ++i) {
        const std::size_t entry = directory + 2 + 12 * i;
        if (entry + 12 > head.size()) break;
        const bool is_short = u16(entry + 2) == 3;
        const std::int64_t value = is_short ? u16(entry + 8) : u32(entry + 8);
        if (u16(entry) == 256) width = value;
        if (u16(entry) == 257) height = value;
    }
    if (width == 0 || height == 0) return std::nullopt;
    return Extent{width, height};
}

/// From the data window among an EXR's attributes: name 0, type 0, length, value; an empty name
/// ends them.
std::optional<Extent> exr_size(std::span<const std::byte> head) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    std::size_t at = 8;
    while (at < text.size() && text[at] != '\0') {
        const auto name_end = text.find('\0', at);
        if (name_end == std::string_view::npos) break;
        const auto type_end = text.find('\0', name_end + 1);
        if (type_end == std::string_view::npos || type_end + 5 > text.size()) break;
        const std::size_t value = type_end + 5;
        if (text.substr(at, name_end - at) == "dataWindow" && value + 16 <= text.size()) {
            const auto edge = [&](std::size_t i) {
                return std::int64_t{
                    static_cast<std::int32_t>(little_endian_32(head, value + 4 * i))};
            };
            return Extent{edge(2) - edge(0) + 1, edge(3) - edge(1) + 1};
        }
        at = value + little_endian_32(head, type_end + 1);
    }
    return std::nullopt;
}

}  // namespace

std::optional<Extent> claimed_size(const FileProbe& probe) {
    const std::span<const std::byte> head = probe.head;
    if (probe.plugin == "png" && head.size() >= 24)
        return Extent{big_endian_32(head, 16), big_endian_32(head, 20)};
    if (probe.plugin == "jpeg") return jpeg_size(head);
    if (probe.plugin == "tiff") return tiff_size(head);
    if (probe.exr) return exr_size(head);
    return std::nullopt;
}

void check_jpeg_is_whole(const std::string& path, std::size_t size) {
    const std::vector<std::byte> file = first_bytes(path, size);
    if (!walk_jpeg(file, [](int, std::span<const std::byte>) {}))
        throw failure(path, "truncated: the JPEG data ends early; copy or export it again");
}

void check_png_is_whole(const std::string& path) {
    const InputFile file = open_input(path);
    std::array<std::byte, 8> chunk{};  // length and name; the value and a checksum follow
    if (std::fseek(file.get(), 8, SEEK_SET) != 0) return;
    while (std::fread(chunk.data(), 1, chunk.size(), file.get()) == chunk.size()) {
        if (starts_with(chunk, 4, "IEND")) return;
        if (std::fseek(file.get(), long{big_endian_32(chunk, 0)} + 4, SEEK_CUR) != 0) break;
    }
    throw failure(path, "truncated: the PNG data ends early; copy or export it again");
}

bool png_says_srgb(std::span<const std::byte> head) {
    std::size_t at = 8;
    while (at + 8 <= head.size()) {
        if (starts_with(head, at + 4, "sRGB")) return true;
        if (starts_with(head, at + 4, "IDAT")) return false;
        at += 12 + std::size_t{big_endian_32(head, at)};
    }
    return false;
}

RadianceHeader radiance_header(std::span<const std::byte> head) {
    RadianceHeader header;
    std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    constexpr std::string_view kOwn = "# chromeball: ";
    constexpr std::string_view kPrimaries = "PRIMARIES=";
    for (auto end = text.find('\n'); end != std::string_view::npos && end > 0;
         end = text.find('\n')) {
        const std::string line(text.substr(0, end));
        text.remove_prefix(end + 1);
        if (line.starts_with(kOwn)) header.provenance += line.substr(kOwn.size());
        std::array<double, 8> p{};
        if (line.starts_with(kPrimaries) &&
            std::sscanf(line.c_str() + kPrimaries.size(), "%lf %lf %lf %lf %lf %lf %lf %lf", &p[0],
                        &p[1], &p[2], &p[3], &p[4], &p[5], &p[6], &p[7]) == 8)
            header.primaries = p;
    }
    return header;
}

}  // namespace chromeball::io
