#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/encoders.h"

// The two steps that make PNG's data of pixels: filters that turn a row into differences, and
// deflate. Of both is done what costs little: on a photo's noise more effort gains nothing.

namespace chromeball::io {

/// A row as differences to its neighbours, by the filter (sub, up or Paeth) whose differences are
/// smallest in the sum; that is the usual guess of what deflates best. PNG specification, 9.
///
/// row, above  the bytes of the row and of the one above it, zeros for the first
/// pixel       bytes of a pixel
/// out         one byte longer than the row: the filter's number, then the differences
void filter_row(std::span<const std::byte> row, std::span<const std::byte> above, std::size_t pixel,
                std::span<std::byte> out);

/// A part of a zlib stream (RFC 1950) that was made without the others: the parts of all bytes,
/// one behind the other, between zlib_head() and zlib_tail() of the sums, are the stream.
struct DeflatedPart {
    Bytes bytes;
    std::uint32_t sum = 1;   ///< Adler-32
    std::size_t length = 0;  ///< of what was deflated
};
DeflatedPart deflate_part(std::span<const std::byte> bytes, bool last);

/// The two bytes in front.
Bytes zlib_head();
/// The four bytes behind.
Bytes zlib_tail(std::span<const DeflatedPart> parts);

}  // namespace chromeball::io
