#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string_view>

#include "core/parallel.h"
#include "io/encoders.h"
#include "io/fact_names.h"
#include "io/png_rows.h"

namespace chromeball::io {
namespace {

void put_32(Bytes& bytes, std::size_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes.push_back(static_cast<std::byte>(value >> shift));
}

void put_text(Bytes& bytes, std::string_view text) {
    const auto data = std::as_bytes(std::span(text));
    bytes.insert(bytes.end(), data.begin(), data.end());
}

/// Length, name, content, and the checksum of the last two.
void put_chunk(Bytes& file, std::string_view name, std::span<const std::byte> content) {
    put_32(file, content.size());
    const std::size_t summed = file.size();
    put_text(file, name);
    file.insert(file.end(), content.begin(), content.end());
    put_32(file, ::crc32_z(0, reinterpret_cast<const Bytef*>(file.data()) + summed,
                           file.size() - summed));
}

Bytes header_of(const Values& values) {
    Bytes header;
    put_32(header, static_cast<std::size_t>(values.size.width));
    put_32(header, static_cast<std::size_t>(values.size.height));
    const int kind = (values.colors == 3 ? 2 : 0) + (values.alpha ? 4 : 0);
    for (const int number : {values.type == PixelType::u16 ? 16 : 8, kind, 0, 0, 0})
        header.push_back(static_cast<std::byte>(number));
    return header;
}

/// The three chunks that say sRGB, as the specification wants it for readers that know only the
/// older ones.
void put_srgb(Bytes& file) {
    Bytes gamma, primaries;
    put_32(gamma, 45455);
    for (const std::size_t xy : {31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000})
        put_32(primaries, xy);
    put_chunk(file, "gAMA", gamma);
    put_chunk(file, "sRGB", Bytes{std::byte{0}});  // perceptual
    put_chunk(file, "cHRM", primaries);
}

/// ASCII in the older kind of chunk, that everything reads; else UTF-8.
void put_words(Bytes& file, std::string_view key, std::string_view text) {
    const bool ascii = std::ranges::all_of(text, [](unsigned char c) { return c < 128; });
    Bytes content;
    put_text(content, key);
    // Of iTXt: not compressed, no language, no translated key.
    content.resize(content.size() + (ascii ? 1 : 5));
    put_text(content, text);
    put_chunk(file, ascii ? "tEXt" : "iTXt", content);
}

/// Texts under the names by which OpenImageIO, and so decode_png, knows them.
void put_facts(Bytes& file, const Metadata& metadata) {
    std::vector<std::string_view> known;
    for (const FactName& fact : fact_names()) {
        const Attribute* attribute = metadata.find(fact.exr);
        // DPX names have no place here; a date is the photo's, not the file's.
        if (!attribute || attribute->type != "string" || fact.other.empty() ||
            fact.other.starts_with("dpx:") || fact.other == "DateTime" ||
            std::ranges::find(known, fact.other) != known.end())
            continue;
        known.push_back(fact.other);
        put_words(file, fact.other, attribute->text);
    }
    if (const auto own = metadata.text("chromeball"))
        put_words(file, "Description", "chromeball " + *own);
}

/// Of 16 bits the higher byte first.
void swap_bytes(const Values& values, std::span<std::byte> rows) {
    if (values.type != PixelType::u16 || std::endian::native == std::endian::big) return;
    for (std::size_t i = 0; i + 1 < rows.size(); i += 2) std::swap(rows[i], rows[i + 1]);
}

DeflatedPart deflate_rows(const Values& values, int first, int last, WriteReport& report) {
    const std::size_t length = values.row_bytes();
    Bytes rows(static_cast<std::size_t>(last - first + 1) * length);  // and the one above, or zeros
    if (first > 0) values.store(first - 1, first, rows.data());
    report = values.store(first, last, rows.data() + length);
    swap_bytes(values, rows);
    Bytes filtered(static_cast<std::size_t>(last - first) * (length + 1));
    const std::span all = rows;
    for (std::size_t i = 0; i < static_cast<std::size_t>(last - first); ++i)
        filter_row(all.subspan((i + 1) * length, length), all.subspan(i * length, length),
                   values.pixel_bytes(), std::span(filtered).subspan(i * (length + 1), length + 1));
    return deflate_part(filtered, last == values.size.height);
}

/// Bands of some 512 KB, whatever the number of threads, as the bytes depend on them.
int band_rows(const Values& values) {
    return static_cast<int>(
        std::clamp<std::size_t>((std::size_t{512} << 10) / values.row_bytes(), 1, 4096));
}

}  // namespace

Bytes encode_png(const Values& values, const WriteOptions& options, WriteReport& report) {
    const int rows = band_rows(values);
    const auto count = static_cast<std::size_t>((values.size.height + rows - 1) / rows);
    std::vector<DeflatedPart> parts(count);
    std::vector<WriteReport> reports(count);
    for_each_band(values.size.height, rows, [&](int first, int last) {
        const auto at = static_cast<std::size_t>(first / rows);
        parts[at] = deflate_rows(values, first, last, reports[at]);
    });
    for (const WriteReport& one : reports) add(report, one);
    Bytes& head = parts.front().bytes;
    const Bytes start = zlib_head(), end = zlib_tail(parts);
    head.insert(head.begin(), start.begin(), start.end());
    parts.back().bytes.insert(parts.back().bytes.end(), end.begin(), end.end());

    Bytes file;
    std::size_t length = std::size_t{64} << 10;  // more than what is not pixels
    for (const DeflatedPart& part : parts) length += part.bytes.size() + 12;
    file.reserve(length);
    put_text(file, "\x89PNG\r\n\x1a\n");
    put_chunk(file, "IHDR", header_of(values));
    if (is_encoded_srgb(options.color)) put_srgb(file);
    put_facts(file, options.metadata);
    for (DeflatedPart& part : parts) {
        put_chunk(file, "IDAT", part.bytes);
        part.bytes = Bytes();  // of `= {}` the memory would stay
    }
    put_chunk(file, "IEND", {});
    return file;
}

}  // namespace chromeball::io
