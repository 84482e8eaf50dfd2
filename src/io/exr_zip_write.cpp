#include "io/exr_zip_write.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <numeric>

#include "core/parallel.h"

namespace chromeball::io {
namespace {

using Byte = std::uint8_t;

constexpr int kRows = 16;  // of a chunk, as the format has it

/// The fastest. Not ISA-L's, four times as fast for a tenth more bytes: of 5000 chunks one came out
/// otherwise than before, a shot's frames must not.
constexpr int kLevel = 1;

/// Chunks that a thread makes in the same memory.
constexpr int kTogether = 4;

void put_number(Bytes& bytes, std::uint64_t number, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::byte>(number >> (8 * i)));
}

/// Makes chunks, one after the other.
class ChunkMaker {
public:
    ChunkMaker(const Values& values, const std::vector<std::size_t>& order)
        : values_(values),
          order_(order),
          most_(values.row_bytes() * kRows),
          rows_(std::make_unique_for_overwrite<std::byte[]>(most_)),
          split_(std::make_unique_for_overwrite<Byte[]>(most_)),
          differences_(std::make_unique_for_overwrite<Byte[]>(most_)),
          words_(values.row_bytes() / 2),
          // Where deflating does not shrink it, it is not used.
          deflated_(std::make_unique_for_overwrite<Byte[]>(most_)),
          compressor_(::libdeflate_alloc_compressor(kLevel)) {
        if (!compressor_) throw std::bad_alloc();
    }

    /// The rows first to last: the first one's number, the length of what follows, and that.
    void make(int first, int last, Bytes& out, WriteReport& report) {
        const std::size_t length = values_.row_bytes() * static_cast<std::size_t>(last - first);
        add(report, values_.store(first, last, rows_.get()));
        split(last - first);
        differences_[0] = split_[0];
        for (std::size_t i = 1; i < length; ++i)
            differences_[i] = static_cast<Byte>(split_[i] - split_[i - 1] + 128);
        const std::size_t deflated = deflate(length);
        put_number(out, static_cast<std::uint32_t>(first), 4);
        if (deflated > 0) {
            put_number(out, deflated, 4);
            append(deflated_.get(), deflated, out);
        } else {
            put_number(out, length, 4);
            join(length);
            append(differences_.get(), length, out);
        }
    }

private:
    static void append(const Byte* from, std::size_t count, Bytes& out) {
        const auto* bytes = reinterpret_cast<const std::byte*>(from);
        out.insert(out.end(), bytes, bytes + count);
    }

    /// From interleaved rows, channel by channel in each row, to the bytes of even places in front
    /// of those of odd ones. All values have two or four bytes: words of two.
    void split(int rows) {
        const std::size_t value = bytes_per_value(values_.type), pixel = values_.pixel_bytes();
        const auto width = static_cast<std::size_t>(values_.size.width);
        Byte* even = split_.get();
        Byte* odd = even + values_.row_bytes() * static_cast<std::size_t>(rows) / 2;
        for (int y = 0; y < rows; ++y) {
            const std::byte* row = rows_.get() + values_.row_bytes() * static_cast<std::size_t>(y);
            std::uint16_t* to = words_.data();
            for (const std::size_t channel : order_) {
                const std::byte* from = row + channel * value;
                for (std::size_t x = 0; x < width; ++x, from += pixel) {
                    if (value == 2) {
                        std::memcpy(to++, from, 2);
                        continue;
                    }
                    std::uint32_t both;
                    std::memcpy(&both, from, 4);
                    *to++ = static_cast<std::uint16_t>(both);
                    *to++ = static_cast<std::uint16_t>(both >> 16);
                }
            }
            for (const std::uint16_t word : words_) {
                *even++ = static_cast<Byte>(word);
                *odd++ = static_cast<Byte>(word >> 8);
            }
        }
    }

    /// The bytes in their places again, into the memory for differences.
    void join(std::size_t length) {
        for (std::size_t i = 0; i < length; ++i)
            differences_[i] = split_[i % 2 * (length / 2) + i / 2];
    }

    /// Bytes of the zlib stream; 0 where it would not be shorter.
    std::size_t deflate(std::size_t length) {
        return ::libdeflate_zlib_compress(compressor_.get(), differences_.get(), length,
                                          deflated_.get(), length - 1);
    }

    struct Free {
        void operator()(libdeflate_compressor* compressor) const {
            ::libdeflate_free_compressor(compressor);
        }
    };

    const Values& values_;
    const std::vector<std::size_t>& order_;
    std::size_t most_;
    std::unique_ptr<std::byte[]> rows_;
    std::unique_ptr<Byte[]> split_, differences_;
    std::vector<std::uint16_t> words_;
    std::unique_ptr<Byte[]> deflated_;
    std::unique_ptr<libdeflate_compressor, Free> compressor_;
};

/// Places of the channels in the values, by their names.
std::vector<std::size_t> order_of(const std::vector<std::string>& names) {
    std::vector<std::size_t> order(names.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return names[i]; });
    return order;
}

}  // namespace

void append_zip(const Values& values, const std::vector<std::string>& names, Bytes& header,
                WriteReport& report) {
    if (values.row_bytes() * kRows > std::size_t{1} << 31)
        throw std::runtime_error("its rows are too long for the format");
    const auto order = order_of(names);
    const int height = values.size.height, count = (height + kRows - 1) / kRows;
    std::vector<Bytes> chunks(static_cast<std::size_t>(count));
    std::vector<WriteReport> reports(chunks.size());
    for_each_band(count, kTogether, [&](int first, int last) {
        ChunkMaker maker(values, order);
        for (int i = first; i < last; ++i)
            maker.make(i * kRows, std::min(height, (i + 1) * kRows),
                       chunks[static_cast<std::size_t>(i)], reports[static_cast<std::size_t>(i)]);
    });
    for (const WriteReport& one : reports) add(report, one);

    std::size_t place = header.size() + 8 * chunks.size();
    const auto whole =
        std::accumulate(chunks.begin(), chunks.end(), place,
                        [](std::size_t sum, const Bytes& chunk) { return sum + chunk.size(); });
    header.reserve(whole);
    for (const Bytes& chunk : chunks) {
        put_number(header, place, 8);
        place += chunk.size();
    }
    for (Bytes& chunk : chunks) {
        header.insert(header.end(), chunk.begin(), chunk.end());
        chunk = Bytes();
    }
}

}  // namespace chromeball::io
