#include "io/exr_zip.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <isa-l/igzip_lib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>

#include "core/parallel.h"
#include "io/messages.h"

namespace chromeball::io {
namespace {

using Byte = std::uint8_t;

std::size_t value_bytes(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

/// How the rows of a part lie in a chunk: row by row the channels' values, in the order of names.
struct Rows {
    int top = 0;                      ///< of the data window
    int bottom = 0;                   ///< one past the last
    int together = 1;                 ///< rows a chunk, but for the last
    std::size_t length = 0;           ///< bytes of a row
    std::vector<std::size_t> planes;  ///< where the photo's channels begin in a row
};

Rows rows_of(const Imf::Header& header, const std::vector<std::string>& channels) {
    Rows rows;
    rows.top = header.dataWindow().min.y;
    rows.bottom = header.dataWindow().max.y + 1;
    rows.together = header.compression() == Imf::ZIP_COMPRESSION ? 16 : 1;
    rows.planes.resize(channels.size());
    const auto width = static_cast<std::size_t>(header.dataWindow().max.x) -
                       static_cast<std::size_t>(header.dataWindow().min.x) + 1;
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
        for (std::size_t c = 0; c < channels.size(); ++c)
            if (channels[c] == i.name()) rows.planes[c] = rows.length;
        rows.length += width * value_bytes(i.channel().type);
    }
    return rows;
}

/// A chunk as it is in the file. The library gives it out of its own memory, one at a time.
std::vector<Byte> stored_chunk(Imf::InputPart& part, int row) {
    const char* data = nullptr;
    int length = 0;
    part.rawPixelData(row, data, length);
    const auto* bytes = reinterpret_cast<const Byte*>(data);
    return {bytes, bytes + length};
}

/// Inflates a chunk of that many bytes and undoes the differences between them; false when it is
/// damaged. The bytes of even places then come first, those of odd ones behind them.
bool inflate(std::vector<Byte>& chunk, std::size_t length, std::vector<Byte>& out) {
    out.resize(length);
    const auto state = std::make_unique<inflate_state>();
    ::isal_inflate_init(state.get());
    state->crc_flag = ISAL_ZLIB;
    state->next_in = chunk.data();
    state->avail_in = static_cast<std::uint32_t>(chunk.size());
    state->next_out = out.data();
    state->avail_out = static_cast<std::uint32_t>(out.size());
    if (::isal_inflate_stateless(state.get()) != ISAL_DECOMP_OK || state->avail_out != 0)
        return false;
    unsigned sum = 128;  // in a register, not from what was just stored
    for (Byte& byte : out) {
        sum += byte - 128U;
        byte = static_cast<Byte>(sum);
    }
    return true;
}

/// Values of a row and channel, from the bytes of even and of odd places, to every stride-th place.
void join(const Byte* even, const Byte* odd, std::size_t count, std::size_t words,
          std::vector<std::uint16_t>& row, std::byte* out, std::size_t stride) {
    row.resize(count * words);
    for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = static_cast<std::uint16_t>(even[i] | odd[i] << 8);
    const std::uint16_t* from = row.data();
    if (words == 1)
        for (std::size_t i = 0; i < count; ++i, out += stride) std::memcpy(out, from + i, 2);
    else
        for (std::size_t i = 0; i < count; ++i, out += stride) std::memcpy(out, from + 2 * i, 4);
}

/// The rows first to last of a chunk that begins at the row `top`, into the photo's pixels at
/// `out`.
bool unpack(std::vector<Byte>& chunk, const Rows& rows, int top, int first, int last,
            const Photo& photo, std::byte* out) {
    const auto count = static_cast<std::size_t>(std::min(rows.bottom, top + rows.together) - top);
    const std::size_t length = count * rows.length;
    const std::size_t half = (length + 1) / 2;
    std::vector<Byte> bytes;
    if (chunk.size() < length) {
        if (!inflate(chunk, length, bytes)) return false;
    } else {  // what would not shrink is stored as it is
        bytes.resize(length);
        for (std::size_t i = 0; i < length; ++i) bytes[i % 2 * half + i / 2] = chunk[i];
    }
    const auto width = static_cast<std::size_t>(photo.window.size.width);
    const std::size_t value = bytes_per_value(photo.type);
    const std::size_t pixel = value * rows.planes.size();
    std::vector<std::uint16_t> row;
    for (int y = first; y < last; ++y, out += pixel * width)
        for (std::size_t c = 0; c < rows.planes.size(); ++c) {
            // All values have two or four bytes, so that they begin at even places.
            const std::size_t at =
                (static_cast<std::size_t>(y - top) * rows.length + rows.planes[c]) / 2;
            join(bytes.data() + at, bytes.data() + half + at, width, value / 2, row,
                 out + c * value, pixel);
        }
    return true;
}

}  // namespace

bool can_decode_zip(const Imf::Header& header, const std::vector<std::string>& channels,
                    PixelType type) {
    if constexpr (std::endian::native != std::endian::little) return false;
    const auto compression = header.compression();
    if (header.hasTileDescription() || channels.empty() ||
        (compression != Imf::ZIP_COMPRESSION && compression != Imf::ZIPS_COMPRESSION))
        return false;
    const Rows rows = rows_of(header, channels);
    constexpr std::size_t kMostBytes = std::size_t{1} << 31;  // of a chunk: the library's limit
    if (rows.length >= kMostBytes / static_cast<std::size_t>(rows.together)) return false;
    const Imf::PixelType wanted = type == PixelType::f16 ? Imf::HALF : Imf::FLOAT;
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
        if (i.channel().xSampling != 1 || i.channel().ySampling != 1) return false;
    return std::ranges::all_of(
        channels, [&](const std::string& name) { return header.channels()[name].type == wanted; });
}

void decode_zip(Imf::InputPart& part, const std::vector<std::string>& channels, int first,
                Photo& photo) {
    const Rows rows = rows_of(part.header(), channels);
    const int last = first + photo.window.size.height;
    const auto chunk_of = [&](int y) { return (y - rows.top) / rows.together; };
    const std::size_t row_bytes = bytes_per_value(photo.type) * channels.size() *
                                  static_cast<std::size_t>(photo.window.size.width);
    // Some chunks at a time: read one after the other, unpacked side by side.
    constexpr int kBatch = 32;
    for (int batch = chunk_of(first); batch <= chunk_of(last - 1); batch += kBatch) {
        const int count = std::min(kBatch, chunk_of(last - 1) + 1 - batch);
        const auto top_of = [&](int i) { return rows.top + (batch + i) * rows.together; };
        std::vector<std::vector<Byte>> chunks;
        for (int i = 0; i < count; ++i) chunks.push_back(stored_chunk(part, top_of(i)));
        for_each_band(count, 1, [&](int i, int) {
            const int from = std::max(first, top_of(i));
            const int to = std::min(last, top_of(i) + rows.together);
            if (!unpack(chunks[static_cast<std::size_t>(i)], rows, top_of(i), from, to, photo,
                        photo.pixels.data() + static_cast<std::size_t>(from - first) * row_bytes))
                throw failure(
                    photo.name,
                    "damaged: rows of pixels cannot be inflated; copy or render it again");
        });
    }
}

}  // namespace chromeball::io
