#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "core/photo.h"

namespace chromeball {

struct ReadOptions {
    /// Larger pictures are refused before anything is allocated.
    std::int64_t max_pixels = 400'000'000;
    /// First and one-past-last row wanted, of the upright display window. Formats that can decode
    /// only those; the photo's window tells which rows came: the part of these that the file has
    /// (possibly none), or all where the picture is stored on its side. Absent: all.
    std::optional<std::pair<int, int>> rows = std::nullopt;
    /// Takes the pixels in bands of rows, each a photo without metadata whose window says which,
    /// from several threads at a time and in any order; read_photo() then gives no pixels. A large
    /// picture need not be in memory then: formats that can decode parts give them one by one, the
    /// others one band with all.
    std::function<void(const Photo& band)> bands = nullptr;
};

/// What a file says of itself, without its pixels (photo.pixels is empty, all else is filled in).
///
/// Metadata has EXR attributes under their own names ("envmap" with the text "latlong" or "cube")
/// and those of other formats under OpenImageIO's ("Exif:FocalLength", "Make", ...).
Photo read_header(const std::string& path, const ReadOptions& options = {});

/// A picture of any format that OpenEXR or OpenImageIO reads, upright. Throws Error naming the
/// file: missing, a folder, empty, truncated, of an unknown type, too large.
Photo read_photo(const std::string& path, const ReadOptions& options = {});

/// One channel of an OpenEXR file that is neither colour nor alpha, such as "confidence", as a grey
/// photo; nothing where the file has none of that name, or is of another type. TIFF names no
/// channels: there it is found where chromeball wrote the file, which then says so in its
/// description, and the number of channels is still the same. Throws Error as read_photo.
std::optional<Photo> read_channel(const std::string& path, const std::string& channel,
                                  const ReadOptions& options = {});

}  // namespace chromeball
