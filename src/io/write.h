#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "core/metadata.h"
#include "core/photo.h"

namespace chromeball {

/// The file formats written. One row each in write.cpp: extension, whether floats, half, alpha,
/// extra channels are possible.
enum class FileFormat { exr, hdr, tif, png, jpg };

/// From an extension, with or without a dot, any case: "exr", ".TIFF", "jpeg"...; nothing when
/// unknown.
std::optional<FileFormat> format_from_extension(std::string_view extension);
/// The usual extension, without a dot.
std::string_view extension_of(FileFormat format);

/// What the OpenEXR envmap attribute can say.
enum class EnvmapKind { none, latlong, cube };

struct WriteOptions {
    FileFormat format = FileFormat::exr;
    bool full_float = false;  ///< 32-bit EXR or TIFF instead of half or integers
    int bits = 16;            ///< of integer PNG and TIFF: 8 or 16
    EnvmapKind envmap = EnvmapKind::none;
    Size display;             ///< display window; {0,0}: that of the image
    ColorTag color;           ///< chromaticities and space name, written where the format can
    Metadata metadata;        ///< provenance and pass-through facts
    bool confidence = false;  ///< the image's last channel is confidence, not colour
};

/// What was done to the values so that they fit.
struct WriteReport {
    std::size_t clamped =
        0;  ///< values above what the format holds (65504 in half, 1 in integers), set to that
    std::size_t repaired = 0;  ///< NaN and infinities, set to 0 (NaN, -inf) or the maximum (+inf)
};

/// Writes an image whole or not at all: beside the target (dot in front, `.part` behind), then
/// renamed.
///
/// image: 1 (grey), 3 (RGB) or 4 channels (RGBA, colour multiplied by alpha), plus one if
/// options.confidence. Values are already in the output colour space (encoded for PNG/JPEG: 0 to
/// 1). EXR keeps colour multiplied by alpha, TIFF and PNG get it unassociated, HDR and JPEG have no
/// alpha (as does grey, which HDR gets three times); channels a format cannot hold are left out.
/// The attribute "chromeball" of the metadata finds its place in every format, the other facts
/// where the format has one. The same words give the same bytes: no time of day, no machine. Throws
/// Error naming the target: a folder, unwritable, disk full.
WriteReport write_image(const std::string& path, ImageView<const float> image,
                        const WriteOptions& options);

/// The bytes of the file that write_image would write, which none is written of: a picture inside a
/// page, or one that another program is given. Throws Error where there are no pixels, or not
/// enough memory.
std::vector<std::byte> encode_image(ImageView<const float> image, const WriteOptions& options);

/// Writes text or other bytes whole or not at all, as write_image does: overlays, JSON, reports.
void write_file(const std::string& path, std::string_view content);

/// Throws Error when nothing can be written there: a folder, a missing folder, no permission; to be
/// asked before hours of work.
void check_target(const std::string& path);

/// Removes the half-written file that a killed run left beside a target, if there is one and no
/// one is writing it.
void remove_leftover(const std::string& path);

/// Makes a folder unless there is one; its parent must exist. Throws Error naming it.
void make_folder(const std::string& path);

}  // namespace chromeball
