#include <fmt/format.h>

#include <array>
#include <csetjmp>
#include <cstdio>
// libjpeg's header needs <cstdio> before it.
#include <jpeglib.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "io/bytes.h"
#include "io/decoders.h"
#include "io/exif.h"
#include "io/input_file.h"
#include "io/messages.h"
#include "io/orient.h"

namespace chromeball::io {
namespace {

/// What libjpeg says before it gives up, and the way out of it.
struct Complaint {
    jpeg_error_mgr manager{};  // first: libjpeg hands out a pointer to it
    std::jmp_buf out{};
    std::array<char, JMSG_LENGTH_MAX> text{};
    std::array<char, JMSG_LENGTH_MAX> warning{};  ///< the first one
};

void on_error(j_common_ptr jpeg) {
    auto* complaint = reinterpret_cast<Complaint*>(jpeg->err);
    complaint->manager.format_message(jpeg, complaint->text.data());
    std::longjmp(complaint->out, 1);
}

/// level: below 0 of damaged data, which libjpeg guesses on from; else what only developers read.
void on_message(j_common_ptr jpeg, int level) {
    auto* complaint = reinterpret_cast<Complaint*>(jpeg->err);
    if (level < 0 && complaint->warning[0] == 0)
        complaint->manager.format_message(jpeg, complaint->warning.data());
}

/// A file being read; libjpeg's part of it.
class Reader {
public:
    explicit Reader(const std::string& path) : file_(open_input(path)) {
        jpeg_.err = jpeg_std_error(&complaint_.manager);
        complaint_.manager.error_exit = on_error;
        complaint_.manager.emit_message = on_message;
    }
    ~Reader() { jpeg_destroy_decompress(&jpeg_); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    /// Runs a step of libjpeg's; false when it gave up, and then complaint() says why. The step may
    /// be left by a jump: nothing in it may need destroying.
    template <class Step>
    bool run(Step step) {
        if (setjmp(complaint_.out)) return false;  // NOLINT(cert-err52-cpp): libjpeg's way
        step(jpeg_);
        return true;
    }
    bool read_header() {
        std::FILE* file = file_.get();
        return run([file](jpeg_decompress_struct& jpeg) {
            jpeg_create_decompress(&jpeg);
            jpeg_stdio_src(&jpeg, file);
            for (const int marker : {JPEG_COM, JPEG_APP0 + 1, JPEG_APP0 + 2, JPEG_APP0 + 13})
                jpeg_save_markers(&jpeg, marker, 0xffff);
            jpeg_read_header(&jpeg, TRUE);
        });
    }
    const char* complaint() const { return complaint_.text.data(); }
    const char* warning() const { return complaint_.warning.data(); }
    jpeg_decompress_struct& jpeg() { return jpeg_; }

private:
    InputFile file_;
    Complaint complaint_;
    jpeg_decompress_struct jpeg_{};
};

std::span<const std::byte> bytes_of(const jpeg_saved_marker_ptr marker) {
    return {reinterpret_cast<const std::byte*>(marker->data), marker->data_length};
}

constexpr std::string_view kExifHead("Exif\0\0", 6);

/// Whether there is more than EXIF to tell of: comments, XMP and IPTC, whose words OpenImageIO
/// knows; or colours that are not grey or RGB.
bool is_special(const jpeg_decompress_struct& jpeg) {
    if (jpeg.num_components != 1 && jpeg.num_components != 3) return true;
    if (jpeg.data_precision != 8) return true;
    for (auto* m = jpeg.marker_list; m; m = m->next) {
        if (m->marker == JPEG_COM || m->marker == JPEG_APP0 + 13) return true;
        if (m->marker == JPEG_APP0 + 1 && !starts_with(bytes_of(m), 0, kExifHead)) return true;
    }
    return false;
}

Exif exif_of(const jpeg_decompress_struct& jpeg) {
    for (auto* m = jpeg.marker_list; m; m = m->next)
        if (m->marker == JPEG_APP0 + 1 && starts_with(bytes_of(m), 0, kExifHead))
            return read_exif(bytes_of(m).subspan(kExifHead.size()));
    return {};
}

std::string profile_of(Reader& reader) {
    JOCTET* data = nullptr;
    unsigned length = 0;
    bool found = false;
    reader.run([&](jpeg_decompress_struct& jpeg) {
        found = jpeg_read_icc_profile(&jpeg, &data, &length) != 0;
    });
    const std::unique_ptr<JOCTET, decltype(&std::free)> owner(data, &std::free);
    if (!found) return {};
    return icc_description({reinterpret_cast<const std::byte*>(data), length});
}

Photo describe(const std::string& path, Reader& reader, Exif& exif) {
    const jpeg_decompress_struct& jpeg = reader.jpeg();
    Photo photo;
    photo.name = path;
    photo.display = {static_cast<int>(jpeg.image_width), static_cast<int>(jpeg.image_height)};
    photo.window = {0, 0, photo.display};
    photo.type = PixelType::u8;
    photo.channels = jpeg.num_components;
    photo.color.space = profile_of(reader);
    if (photo.color.space.empty() && exif.srgb) photo.color.space = "sRGB";
    photo.metadata = std::move(exif.metadata);
    return photo;
}

/// Decodes the photo's window; rows above it have to be decoded, too.
class Decoding {
public:
    Decoding(Reader& reader, const Photo& photo)
        : reader_(reader),
          photo_(photo),
          row_bytes_(static_cast<std::size_t>(photo.window.size.width) *
                     static_cast<std::size_t>(photo.channels)) {}

    void start() {
        const bool grey = photo_.channels == 1;
        checked(reader_.run([grey](jpeg_decompress_struct& jpeg) {
            jpeg.out_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
            jpeg_start_decompress(&jpeg);
        }));
        std::vector<std::byte> unwanted(row_bytes_);
        for (int y = 0; y < photo_.window.y; ++y) read(unwanted.data(), 1);
    }
    void read(std::byte* out, int rows) {
        const std::size_t length = row_bytes_;
        checked(reader_.run([=](jpeg_decompress_struct& jpeg) {
            for (int y = 0; y < rows; ++y) {
                auto* row = reinterpret_cast<JSAMPROW>(out + static_cast<std::size_t>(y) * length);
                jpeg_read_scanlines(&jpeg, &row, 1);
            }
        }));
    }
    /// What was wrong in the data, to its end: where one code was changed into another all that
    /// follows is shifted, which shows only there, when some is left over. Rows that are not wanted
    /// are not turned into pixels.
    std::string damage() {
        std::vector<std::byte> last(row_bytes_);
        checked(reader_.run([&last](jpeg_decompress_struct& jpeg) {
            const JDIMENSION left = jpeg.output_height - jpeg.output_scanline;
            if (left > 0) {
                // To skip all would not look at them.
                jpeg_skip_scanlines(&jpeg, left - 1);
                auto* row = reinterpret_cast<JSAMPROW>(last.data());
                jpeg_read_scanlines(&jpeg, &row, 1);
            }
            jpeg_finish_decompress(&jpeg);
        }));
        return reader_.warning();
    }

private:
    void checked(bool good) {
        if (!good)
            throw failure(photo_.name,
                          fmt::format("truncated or damaged: {}; copy or export it again",
                                      reader_.complaint()));
    }

    Reader& reader_;
    const Photo& photo_;
    std::size_t row_bytes_;
};

}  // namespace

std::optional<Photo> decode_jpeg(const std::string& path, const FileProbe& probe,
                                 const DecodeRequest& request) {
    if (const auto claimed = claimed_size(probe))
        check_size(path, claimed->first, claimed->second, request.max_pixels);
    if (!request.header_only) check_jpeg_is_whole(path, probe.size);
    Reader reader(path);
    if (!reader.read_header())
        throw failure(path, fmt::format("cannot be read as jpeg: {}; damaged or truncated: copy "
                                        "or export it again",
                                        reader.complaint()));
    if (is_special(reader.jpeg())) return std::nullopt;
    Exif exif = exif_of(reader.jpeg());
    Photo photo = describe(path, reader, exif);
    check_size(path, photo.display.width, photo.display.height, request.max_pixels);
    const auto rows = stored_rows(request.rows, exif.orientation, photo.display.height);
    const auto [first, last] = wanted_rows(photo.window, rows);
    photo.window.y = first;
    photo.window.size.height = last - first;
    if (!request.header_only && first < last) {
        Decoding decoding(reader, photo);
        decoding.start();
        if (request.bands && exif.orientation == 1) {
            for (int y = first; y < last; y += kBandRows) {
                Photo band = band_of(photo, y, std::min(last, y + kBandRows));
                decoding.read(band.pixels.data(), band.window.size.height);
                request.bands(band);
            }
            photo.damage = decoding.damage();
            return photo;
        }
        photo.pixels.resize(photo.window.size.pixels() * static_cast<std::size_t>(photo.channels));
        decoding.read(photo.pixels.data(), last - first);
        photo.damage = decoding.damage();
    }
    make_upright(photo, exif.orientation);
    return photo;
}

}  // namespace chromeball::io
