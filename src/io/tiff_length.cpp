#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <span>
#include <vector>

#include "io/bytes.h"
#include "io/input_file.h"
#include "io/messages.h"
#include "io/probe.h"

// Where a TIFF's directory says that its pixels lie, against where the file ends. The library
// notices only when it comes to the rows that are missing.
//
// Adobe: TIFF, revision 6.0, 1992, section 2; the BigTIFF design of 2004.

namespace chromeball::io {
namespace {

enum Tag : std::uint32_t {
    kStripOffsets = 273,
    kStripByteCounts = 279,
    kTileOffsets = 324,
    kTileByteCounts = 325,
};

/// Not as the format has it, or beyond the file's end.
struct NotThere {};

/// The numbers of a TIFF's first directory.
class Directory {
public:
    Directory(const std::string& path, std::uint64_t size) : file_(open_input(path)), size_(size) {
        const auto head = bytes(0, 16);
        big_endian_ = head[0] == std::byte{'M'};
        wide_ = number(head, 2, 2) == 43;
        const std::uint64_t at = wide_ ? number(head, 8, 8) : number(head, 4, 4);
        const std::size_t counter = wide_ ? 8 : 2, entry = wide_ ? 20 : 12;
        const std::uint64_t count = number(bytes(at, counter), 0, counter);
        if (count > size_ / entry) throw NotThere();
        const auto entries = bytes(at + counter, static_cast<std::size_t>(count) * entry);
        for (std::size_t i = 0; i < count; ++i) {
            const auto one = std::span(entries).subspan(i * entry, entry);
            entries_[static_cast<std::uint32_t>(number(one, 0, 2))] = {one.begin(), one.end()};
        }
    }

    /// A tag's whole numbers; none where it is not there.
    std::vector<std::uint64_t> numbers(Tag tag) const {
        const auto found = entries_.find(tag);
        if (found == entries_.end()) return {};
        const std::span<const std::byte> entry = found->second;
        const std::size_t pointer = wide_ ? 8 : 4, value = 4 + pointer;
        const std::size_t each = bytes_of_type(number(entry, 2, 2));
        const std::uint64_t count = number(entry, 4, pointer);
        if (each == 0 || count > size_ / each) throw NotThere();
        const std::size_t all = static_cast<std::size_t>(count) * each;
        const auto data =
            all <= pointer
                ? std::vector(entry.begin() + static_cast<std::ptrdiff_t>(value), entry.end())
                : bytes(number(entry, value, pointer), all);
        std::vector<std::uint64_t> result;
        for (std::size_t i = 0; i < count; ++i) result.push_back(number(data, i * each, each));
        return result;
    }

private:
    static std::size_t bytes_of_type(std::uint64_t type) {
        switch (type) {
            case 3:
                return 2;
            case 4:
            case 13:
                return 4;
            case 16:
            case 18:
                return 8;
            default:
                return 0;
        }
    }

    std::vector<std::byte> bytes(std::uint64_t at, std::size_t count) const {
        if (at > size_ || count > size_ - at) throw NotThere();
        std::vector<std::byte> all(count);
        if (::fseeko(file_.get(), static_cast<off_t>(at), SEEK_SET) != 0 ||
            std::fread(all.data(), 1, count, file_.get()) != count)
            throw NotThere();
        return all;
    }

    std::uint64_t number(std::span<const std::byte> from, std::size_t at, std::size_t count) const {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < count; ++i)
            value = value << 8 | byte_at(from, big_endian_ ? at + i : at + count - 1 - i);
        return value;
    }

    InputFile file_;
    std::uint64_t size_;
    bool big_endian_ = false;
    bool wide_ = false;  ///< BigTIFF
    std::map<std::uint32_t, std::vector<std::byte>> entries_;
};

/// Whether all strips or tiles end within the file.
bool ends_within(const Directory& directory, std::uint64_t size) {
    const bool tiled = !directory.numbers(kTileOffsets).empty();
    const auto offsets = directory.numbers(tiled ? kTileOffsets : kStripOffsets);
    const auto counts = directory.numbers(tiled ? kTileByteCounts : kStripByteCounts);
    for (std::size_t i = 0; i < std::min(offsets.size(), counts.size()); ++i)
        if (counts[i] > size - std::min(offsets[i], size)) return false;
    return true;
}

}  // namespace

void check_tiff_is_whole(const std::string& path, std::size_t size) {
    bool whole = false;
    try {
        whole = ends_within(Directory(path, size), size);
    } catch (const NotThere&) {
        whole = false;
    }
    if (!whole)
        throw failure(path,
                      "truncated: the file ends before the pixels that its directory names; copy "
                      "or export it again");
}

}  // namespace chromeball::io
