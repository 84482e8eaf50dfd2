#include "io/png_rows.h"

#include <isa-l/igzip_lib.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "io/isal.h"

namespace chromeball::io {
namespace {

using Byte = std::uint8_t;

enum class Filter : Byte { sub = 1, up = 2, paeth = 4 };

/// The neighbour (left, above, above left) that is nearest to left + above - above left. In words
/// of 16 bits, without branches, so that the compiler does many at a time.
Byte paeth(Byte left, Byte above, Byte corner) {
    const auto a = static_cast<std::int16_t>(left), b = static_cast<std::int16_t>(above),
               c = static_cast<std::int16_t>(corner);
    const auto distance = [](int d) { return static_cast<std::int16_t>(d < 0 ? -d : d); };
    const std::int16_t to_a = distance(b - c), to_b = distance(a - c),
                       to_c = distance(a + b - 2 * c);
    const std::int16_t b_or_c = to_b <= to_c ? b : c;
    return static_cast<Byte>((to_a <= to_b) & (to_a <= to_c) ? a : b_or_c);
}

/// The sum of differences taken as signed bytes.
std::size_t filtered(Filter filter, const Byte* row, const Byte* above, std::size_t pixel,
                     std::size_t length, Byte* out) {
    *out++ = static_cast<Byte>(filter);
    const std::size_t head = std::min(pixel, length);  // there is nothing on the left
    for (std::size_t i = 0; i < head; ++i)
        out[i] = static_cast<Byte>(filter == Filter::sub ? row[i] : row[i] - above[i]);
    switch (filter) {
        case Filter::sub:
            for (std::size_t i = head; i < length; ++i)
                out[i] = static_cast<Byte>(row[i] - row[i - pixel]);
            break;
        case Filter::up:
            for (std::size_t i = head; i < length; ++i)
                out[i] = static_cast<Byte>(row[i] - above[i]);
            break;
        case Filter::paeth:
            for (std::size_t i = head; i < length; ++i)
                out[i] =
                    static_cast<Byte>(row[i] - paeth(row[i - pixel], above[i], above[i - pixel]));
            break;
    }
    std::size_t sum = 0;
    for (std::size_t i = 0; i < length; ++i) sum += std::min<unsigned>(out[i], 256U - out[i]);
    return sum;
}

}  // namespace

void filter_row(std::span<const std::byte> row, std::span<const std::byte> above, std::size_t pixel,
                std::span<std::byte> out) {
    assert(above.size() == row.size() && out.size() == row.size() + 1);
    const auto* in = reinterpret_cast<const Byte*>(row.data());
    const auto* up = reinterpret_cast<const Byte*>(above.data());
    std::array<std::vector<Byte>, 3> tries;
    constexpr std::array kFilters = {Filter::sub, Filter::up, Filter::paeth};
    std::size_t best = 0, least = SIZE_MAX;
    for (std::size_t i = 0; i < kFilters.size(); ++i) {
        tries[i].resize(out.size());
        const std::size_t sum = filtered(kFilters[i], in, up, pixel, row.size(), tries[i].data());
        if (sum >= least) continue;
        least = sum;
        best = i;
    }
    std::memcpy(out.data(), tries[best].data(), out.size());
}

DeflatedPart deflate_part(std::span<const std::byte> bytes, bool last) {
    const auto* data = reinterpret_cast<const Byte*>(bytes.data());
    DeflatedPart part;
    part.length = bytes.size();
    part.sum = static_cast<std::uint32_t>(::adler32_z(1, data, bytes.size()));
    isal_zstream stream;
    ::isal_deflate_init(&stream);
    stream.level = 1;
    std::vector<Byte> memory(ISAL_DEF_LVL1_DEFAULT);
    stream.level_buf = memory.data();
    stream.level_buf_size = static_cast<std::uint32_t>(memory.size());
    stream.end_of_stream = last;
    stream.flush = FULL_FLUSH;                 // to a whole byte; what follows does not look back
    stream.next_in = const_cast<Byte*>(data);  // only read
    stream.avail_in = static_cast<std::uint32_t>(bytes.size());
    // What cannot be compressed is stored, with a few bytes for each block.
    part.bytes.resize(bytes.size() + bytes.size() / 64 + 1024);
    std::size_t used = 0;
    do {
        if (used == part.bytes.size()) part.bytes.resize(2 * used);
        stream.next_out = reinterpret_cast<Byte*>(part.bytes.data()) + used;
        stream.avail_out = static_cast<std::uint32_t>(part.bytes.size() - used);
        const int result = ::isal_deflate(&stream);
        clear_upper_halves();
        if (result != COMP_OK) throw std::runtime_error("deflate failed");
        used = part.bytes.size() - stream.avail_out;
    } while (stream.avail_out == 0);
    part.bytes.resize(used);
    return part;
}

Bytes zlib_head() { return {std::byte{0x78}, std::byte{0x01}}; }  // a window of 32 KB, fastest

Bytes zlib_tail(std::span<const DeflatedPart> parts) {
    uLong sum = 1;
    for (const DeflatedPart& part : parts)
        sum = ::adler32_combine(sum, part.sum, static_cast<z_off_t>(part.length));
    Bytes tail;
    for (int shift = 24; shift >= 0; shift -= 8)
        tail.push_back(static_cast<std::byte>(sum >> shift));
    return tail;
}

}  // namespace chromeball::io
