#include "io/exr_chunks.h"

#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <vector>

#include "io/bytes.h"
#include "io/input_file.h"
#include "io/messages.h"

namespace chromeball::io {
namespace {

/// The byte behind the headers, where the tables of contents begin; nothing where `bytes` hold no
/// whole headers. A header is attributes (name 0, type 0, length, value) and an empty name; in a
/// file of several parts an empty header ends them.
std::optional<std::size_t> end_of_headers(std::span<const std::byte> bytes, int parts,
                                          bool multipart) {
    std::size_t at = 8;
    const auto skip_text = [&] {
        const auto end =
            std::find(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), std::byte{0});
        at = static_cast<std::size_t>(end - bytes.begin()) + 1;
        return end != bytes.end();
    };
    for (int part = 0; part < parts; ++part) {
        while (at < bytes.size() && bytes[at] != std::byte{0}) {
            if (!skip_text() || !skip_text() || at + 4 > bytes.size()) return std::nullopt;
            at += 4 + std::size_t{little_endian_32(bytes, at)};
        }
        ++at;
    }
    if (multipart) ++at;
    if (at > bytes.size()) return std::nullopt;
    return at;
}

/// Rows that are compressed together.
std::int64_t rows_of_chunk(Imf::Compression compression) {
    switch (compression) {
        case Imf::ZIP_COMPRESSION:
        case Imf::PXR24_COMPRESSION:
            return 16;
        case Imf::PIZ_COMPRESSION:
        case Imf::B44_COMPRESSION:
        case Imf::B44A_COMPRESSION:
        case Imf::DWAA_COMPRESSION:
            return 32;
        case Imf::DWAB_COMPRESSION:
            return 256;
        default:
            return 1;
    }
}

/// The sizes of a side's levels: each half of the one before, down to 1.
std::vector<std::int64_t> level_sizes(std::int64_t size, const Imf::TileDescription& tiles) {
    std::vector<std::int64_t> sizes{size};
    while (tiles.mode != Imf::ONE_LEVEL && sizes.back() > 1)
        sizes.push_back((sizes.back() + (tiles.roundingMode == Imf::ROUND_UP ? 1 : 0)) / 2);
    return sizes;
}

/// As many as the table of contents has entries. "Technical Introduction to OpenEXR"; the library
/// knows it, but keeps it to itself. Like the library this takes a header's own count, which may
/// say anything, only for kinds of parts that came later than all that are known.
std::uint64_t chunk_count(const Imf::Header& header) {
    if (header.hasType() && !Imf::isSupportedType(header.type()))
        return header.hasChunkCount() ? static_cast<std::uint32_t>(header.chunkCount()) : 0;
    const auto parts = [](std::int64_t size, std::int64_t part) {
        return (size + part - 1) / part;
    };
    const Imath::Box2i& box = header.dataWindow();
    const std::int64_t width = std::int64_t{box.max.x} - box.min.x + 1;
    const std::int64_t height = std::int64_t{box.max.y} - box.min.y + 1;
    if (!header.hasTileDescription())
        return static_cast<std::uint64_t>(parts(height, rows_of_chunk(header.compression())));
    const Imf::TileDescription& tiles = header.tileDescription();
    const auto count = [&](std::int64_t w, std::int64_t h) {
        return parts(w, tiles.xSize) * parts(h, tiles.ySize);
    };
    const auto widths = level_sizes(width, tiles), heights = level_sizes(height, tiles);
    std::int64_t all = 0;
    if (tiles.mode == Imf::RIPMAP_LEVELS) {
        for (const auto w : widths)
            for (const auto h : heights) all += count(w, h);
    } else {
        for (std::size_t level = 0; level < std::max(widths.size(), heights.size()); ++level)
            all += count(level < widths.size() ? widths[level] : 1,
                         level < heights.size() ? heights[level] : 1);
    }
    return static_cast<std::uint64_t>(all);
}

/// Bytes of a file from a place on; fewer where it ends.
std::vector<std::byte> bytes_at(std::FILE* file, std::uint64_t place, std::size_t count) {
    std::vector<std::byte> bytes(count);
    if (::fseeko(file, static_cast<off_t>(place), SEEK_SET) != 0) return {};
    bytes.resize(std::fread(bytes.data(), 1, count, file));
    return bytes;
}

/// The byte behind a chunk: its head says how long it is.
std::uint64_t end_of_chunk(std::FILE* file, std::uint64_t place, bool tiled, bool multipart) {
    // Row, or tile's column, row and levels; before that the part's number; then the length.
    const std::size_t before = (multipart ? 4U : 0U) + (tiled ? 16U : 4U);
    const auto head = bytes_at(file, place, before + 4);
    const std::uint64_t length = head.size() < before + 4 ? 0 : little_endian_32(head, before);
    return place + before + 4 + length;
}

}  // namespace

std::optional<ChunkTable> checked_chunks(const std::string& path, const FileProbe& probe,
                                         const Imf::MultiPartInputFile& file, int part) {
    ChunkTable table;
    table.multipart = Imf::isMultiPart(file.version());
    auto tables = end_of_headers(probe.head, file.parts(), table.multipart);
    constexpr std::size_t kMostHeaders = std::size_t{64} << 20;
    if (!tables && probe.size > probe.head.size())
        tables = end_of_headers(first_bytes(path, std::min(probe.size, kMostHeaders)), file.parts(),
                                table.multipart);
    if (!tables) return std::nullopt;
    const auto truncated = [&] {
        return failure(path,
                       "truncated: the file ends before its pixels do; copy or render it again");
    };
    std::uint64_t at = *tables;
    for (int i = 0; i < part; ++i) at += 8 * chunk_count(file.header(i));
    const std::uint64_t count = chunk_count(file.header(part));
    // The headers' word, so far: of a table there is not more than the file has room for.
    if (at > probe.size || count > (probe.size - at) / 8) throw truncated();
    const InputFile input = open_input(path);
    const auto bytes = bytes_at(input.get(), at, 8 * static_cast<std::size_t>(count));
    for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8)
        table.places.push_back(little_endian_64(bytes, i));
    const std::uint64_t last = table.places.empty() ? 0 : *std::ranges::max_element(table.places);
    const bool tiled = file.header(part).hasTileDescription();
    if (table.places.size() < count || last >= probe.size ||
        end_of_chunk(input.get(), last, tiled, table.multipart) > probe.size)
        throw truncated();
    return table;
}

}  // namespace chromeball::io
