#include "io/exr_zip.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfHeader.h>
#include <isa-l/igzip_lib.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "core/parallel.h"
#include "io/bytes.h"
#include "io/decoders.h"
#include "io/input_file.h"
#include "io/isal.h"
#include "io/messages.h"

namespace chromeball::io {
namespace {

using Byte = std::uint8_t;

std::size_t value_bytes(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

/// How the rows of a part lie in a chunk: row by row the channels' values, in the order of names.
struct Rows {
    int top = 0;     ///< of the data window
    int bottom = 0;  ///< one past the last
    static constexpr int kMostTogether = 16;
    int together = 1;                 ///< rows a chunk, but for the last
    std::size_t length = 0;           ///< bytes of a row
    std::vector<std::size_t> planes;  ///< where the photo's channels begin in a row
};

Rows rows_of(const Imf::Header& header, const std::vector<std::string>& channels) {
    Rows rows;
    rows.top = header.dataWindow().min.y;
    rows.bottom = header.dataWindow().max.y + 1;
    rows.together = header.compression() == Imf::ZIP_COMPRESSION ? Rows::kMostTogether : 1;
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

/// Undoes the differences between bytes: each is what its sum with the one before exceeds 128 by.
void sum_up(Byte* bytes, std::size_t count) {
    std::size_t i = 0;
    unsigned sum = 128;
#if defined(__SSE2__)
    const __m128i middle = _mm_set1_epi8(-128);
    __m128i before = _mm_set1_epi8(-128);
    for (; i + 16 <= count; i += 16) {
        auto* place = reinterpret_cast<__m128i*>(bytes + i);
        __m128i x = _mm_xor_si128(_mm_loadu_si128(place), middle);  // less 128
        // Sums of two neighbours, of four, of eight, of all.
        x = _mm_add_epi8(x, _mm_slli_si128(x, 1));
        x = _mm_add_epi8(x, _mm_slli_si128(x, 2));
        x = _mm_add_epi8(x, _mm_slli_si128(x, 4));
        x = _mm_add_epi8(x, _mm_slli_si128(x, 8));
        x = _mm_add_epi8(x, before);
        _mm_storeu_si128(place, x);
        // The last one everywhere.
        x = _mm_unpackhi_epi8(x, x);
        before = _mm_shuffle_epi32(_mm_shufflehi_epi16(x, 0xff), 0xff);
    }
    if (i > 0) sum = bytes[i - 1];
#endif
    for (; i < count; ++i) {
        sum += bytes[i] - 128U;
        bytes[i] = static_cast<Byte>(sum);
    }
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

/// Reads and unpacks chunks, one after the other.
class ChunkReader {
public:
    ChunkReader(const std::string& path, int file, const ChunkTable& table, const Rows& rows)
        : path_(path),
          file_(file),
          table_(table),
          rows_(rows),
          most_(rows.length * static_cast<std::size_t>(rows.together)),
          stored_(std::make_unique_for_overwrite<Byte[]>(most_)),
          bytes_(std::make_unique_for_overwrite<Byte[]>(most_)),
          state_(std::make_unique_for_overwrite<inflate_state>()) {}

    /// The chunk's rows of which the photo, whose first row is that one of the file, has room;
    /// false where they are damaged.
    bool read(int chunk, int first_row, Photo& photo) {
        const int top = rows_.top + chunk * rows_.together;
        const int bottom = std::min(rows_.bottom, top + rows_.together);
        const std::size_t length = static_cast<std::size_t>(bottom - top) * rows_.length;
        const auto stored = load(top, table_.places[static_cast<std::size_t>(chunk)], length);
        if (!stored) return false;
        if (*stored < length) {
            if (!inflate(*stored, length)) return false;
            sum_up(bytes_.get(), length);
        } else {  // what would not shrink is stored as it is
            for (std::size_t i = 0; i < length; ++i)
                bytes_[i % 2 * half(length) + i / 2] = stored_[i];
        }
        const int last = std::min(bottom, first_row + photo.window.size.height);
        const std::size_t row_bytes = bytes_per_value(photo.type) * rows_.planes.size() *
                                      static_cast<std::size_t>(photo.window.size.width);
        for (int y = std::max(first_row, top); y < last; ++y)
            unpack(static_cast<std::size_t>(y - top), length, photo,
                   photo.pixels.data() + static_cast<std::size_t>(y - first_row) * row_bytes);
        return true;
    }

private:
    static std::size_t half(std::size_t length) { return (length + 1) / 2; }

    /// Bytes of a chunk as they are in the file, into stored_: at most `length`.
    std::optional<std::size_t> load(int top, std::uint64_t place, std::size_t length) {
        // In a file of several parts the part's number; then the first row's, and the length.
        std::array<std::byte, 12> head;
        const std::size_t heads = table_.multipart ? 12 : 8;
        if (!read_at(head.data(), heads, place)) return std::nullopt;
        const auto row = static_cast<std::int32_t>(little_endian_32(head, heads - 8));
        const std::size_t stored = little_endian_32(head, heads - 4);
        if (row != top || stored > length) return std::nullopt;
        if (!read_at(stored_.get(), stored, place + heads)) return std::nullopt;
        return stored;
    }

    bool read_at(void* to, std::size_t count, std::uint64_t place) const {
        auto* bytes = static_cast<Byte*>(to);
        while (count > 0) {
            const ssize_t got = ::pread(file_, bytes, count, static_cast<off_t>(place));
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) throw failure(path_, "cannot be read: " + system_reason(errno));
            if (got == 0) return false;
            bytes += got;
            place += static_cast<std::uint64_t>(got);
            count -= static_cast<std::size_t>(got);
        }
        return true;
    }

    /// The bytes of even places come first, those of odd ones behind them.
    bool inflate(std::size_t stored, std::size_t length) {
        ::isal_inflate_init(state_.get());
        state_->crc_flag = ISAL_ZLIB;
        state_->next_in = stored_.get();
        state_->avail_in = static_cast<std::uint32_t>(stored);
        state_->next_out = bytes_.get();
        state_->avail_out = static_cast<std::uint32_t>(length);
        const int result = ::isal_inflate_stateless(state_.get());
        clear_upper_halves();
        return result == ISAL_DECOMP_OK && state_->avail_out == 0;
    }

    /// A row of a photo from that row of the chunk.
    void unpack(std::size_t row, std::size_t length, const Photo& photo, std::byte* out) {
        const auto width = static_cast<std::size_t>(photo.window.size.width);
        const std::size_t value = bytes_per_value(photo.type);
        for (std::size_t c = 0; c < rows_.planes.size(); ++c) {
            // All values have two or four bytes, so that they begin at even places.
            const std::size_t at = (row * rows_.length + rows_.planes[c]) / 2;
            join(bytes_.get() + at, bytes_.get() + half(length) + at, width, value / 2, words_,
                 out + c * value, value * rows_.planes.size());
        }
    }

    const std::string& path_;
    int file_;
    const ChunkTable& table_;
    const Rows& rows_;
    std::size_t most_;
    std::unique_ptr<Byte[]> stored_, bytes_;
    std::unique_ptr<inflate_state> state_;
    std::vector<std::uint16_t> words_;
};

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

void decode_zip(const Imf::Header& header, const ChunkTable& chunks,
                const std::vector<std::string>& channels, int first,
                const std::function<void(const Photo& band)>& bands, Photo& photo) {
    const Rows rows = rows_of(header, channels);
    const int last = first + photo.window.size.height;
    const auto chunk_of = [&](int y) { return (y - rows.top) / rows.together; };
    const int begin = chunk_of(first), count = chunk_of(last - 1) + 1 - begin;
    const InputFile file = open_input(photo.name);
    // As many rows of single-row chunks as of others.
    const int grain = 2 * Rows::kMostTogether / rows.together;
    for_each_band(count, grain, [&](int from, int to) {
        Photo band;
        int band_first = first;
        if (bands) {
            band_first = std::max(first, rows.top + (begin + from) * rows.together);
            const int band_last = std::min(last, rows.top + (begin + to) * rows.together);
            band = band_of(photo, photo.window.y + band_first - first,
                           photo.window.y + band_last - first);
        }
        ChunkReader reader(photo.name, ::fileno(file.get()), chunks, rows);
        for (int i = from; i < to; ++i)
            if (!reader.read(begin + i, band_first, bands ? band : photo))
                throw failure(
                    photo.name,
                    "damaged: rows of pixels cannot be inflated; copy or render it again");
        if (bands) bands(band);
    });
}

}  // namespace chromeball::io
