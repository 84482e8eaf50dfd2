#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/photo.h"
#include "io/probe.h"

// The doors behind read.cpp: for OpenEXR, for PNG, for JPEG, and for everything else. What is
// declared here shows no third-party type, so that the last one (whose library is slow to load) is
// a module: oiio_module.h.

namespace chromeball::io {

/// What is wanted of a file.
struct DecodeRequest {
    std::int64_t max_pixels = 0;
    std::optional<std::pair<int, int>> rows;  ///< of the upright display window
    bool header_only = false;
    /// For decoders that can give bands; what they give no photo.pixels of.
    std::function<void(const Photo& band)> bands = nullptr;
    /// Of an OpenEXR file, or a TIFF that chromeball wrote: this channel alone, as grey; a photo
    /// without channels where it has none. Other decoders know none.
    std::string channel = {};
};

/// Decodes an OpenEXR file with OpenEXR alone.
Photo decode_exr(const std::string& path, const FileProbe& probe, const DecodeRequest& request);

/// Decodes a JPEG with libjpeg alone; nothing where it holds more than EXIF (XMP, IPTC, comments)
/// or colours other than grey and RGB, which OpenImageIO knows.
std::optional<Photo> decode_jpeg(const std::string& path, const FileProbe& probe,
                                 const DecodeRequest& request);

/// Decodes a PNG with libpng alone; nothing where it holds XMP, which OpenImageIO knows.
std::optional<Photo> decode_png(const std::string& path, const FileProbe& probe,
                                const DecodeRequest& request);

/// A film clip as OpenImageIO's ffmpeg reader has it: see Clip.
class ClipReader {
public:
    virtual ~ClipReader() = default;
    virtual int frames() const = 0;
    virtual Photo read(int index, bool header_only) = 0;
};
std::unique_ptr<ClipReader> open_clip_with_oiio(const std::string& path);

/// Decodes anything else with OpenImageIO.
Photo decode_with_oiio(const std::string& path, const FileProbe& probe,
                       const DecodeRequest& request);

/// Throws when a picture of that size is not allowed, before anything of its size is allocated.
void check_size(const std::string& path, std::int64_t width, std::int64_t height,
                std::int64_t max_pixels);

/// The rows first to one-past-last of `stored` that are wanted: all, or the part of `rows` that it
/// holds (possibly none), in the coordinates of `stored`.
std::pair<int, int> wanted_rows(const Window& stored,
                                const std::optional<std::pair<int, int>>& rows);

/// Rows first to last, in the display window's coordinates, of a photo, without its facts, to be
/// filled.
Photo band_of(const Photo& photo, int first, int last);
/// So many at a time, where files are decoded from the top.
constexpr int kBandRows = 64;

}  // namespace chromeball::io
