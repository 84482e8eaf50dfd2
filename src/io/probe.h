#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace chromeball::io {

/// What a file is, by its first bytes; by its name only where a format has no signature.
struct FileProbe {
    std::string plugin;           ///< OpenImageIO's name of the format: "png", "tiff", "raw", ...
    bool exr = false;             ///< read by OpenEXR itself
    bool raw = false;             ///< camera RAW
    std::vector<std::byte> head;  ///< the first bytes, at most 64 KB
    std::size_t size = 0;         ///< of the file, bytes
};

/// Throws Error for a file that is missing, a folder, empty or no regular file; gives its size.
std::size_t check_file(const std::string& path);

/// Throws Error for a file that is missing, a folder, empty, unreadable or of an unknown type.
FileProbe probe_file(const std::string& path);

/// Width and height as a header claims them, where a few lines suffice to read them (EXR, PNG,
/// JPEG, TIFF): libraries may allocate while they open a file, so this is asked first.
std::optional<std::pair<std::int64_t, std::int64_t>> claimed_size(const FileProbe& probe);

/// Throws Error when a JPEG ends before its end-of-image marker: the decoder would fill the rest
/// with grey and only warn. `size` is the file's.
void check_jpeg_is_whole(const std::string& path, std::size_t size);

/// The same for a PNG without its end: the decoder stops at the last pixel, or before it.
void check_png_is_whole(const std::string& path);

/// The same for a TIFF whose strips or tiles lie beyond its end. `size` is the file's.
void check_tiff_is_whole(const std::string& path, std::size_t size);

/// Whether a PNG says outright that it is sRGB (its sRGB chunk).
bool png_says_srgb(std::span<const std::byte> head);

/// What the text header of a Radiance file tells beyond its size.
struct RadianceHeader {
    std::string provenance;  ///< chromeball's own comment lines, joined
    std::optional<std::array<double, 8>> primaries;
};
RadianceHeader radiance_header(std::span<const std::byte> head);

/// The description inside an ICC profile, empty where there is none.
std::string icc_description(std::span<const std::byte> profile);

}  // namespace chromeball::io
