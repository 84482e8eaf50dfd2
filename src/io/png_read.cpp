#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <csetjmp>
#include <cstring>

#include "io/bytes.h"
#include "io/decoders.h"
#include "io/exif.h"
#include "io/input_file.h"
#include "io/messages.h"
#include "io/orient.h"

namespace chromeball::io {
namespace {

/// What libpng says before it gives up.
struct Complaint {
    std::array<char, 256> text{};
};

void on_error(png_structp png, png_const_charp words) {
    auto* complaint = static_cast<Complaint*>(png_get_error_ptr(png));
    std::strncpy(complaint->text.data(), words, complaint->text.size() - 1);
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// A file being read; libpng's part of it.
class Reader {
public:
    explicit Reader(const std::string& path) : file_(open_input(path)) {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &complaint_, on_error, on_warning);
        info_ = png_ ? png_create_info_struct(png_) : nullptr;
        if (!info_) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw std::bad_alloc();
        }
        png_init_io(png_, file_.get());
        png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // check_size() is ours
    }
    ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    /// Runs a step of libpng's; false when it gave up, and then complaint() says why. The step may
    /// be left by a jump: nothing in it may need destroying.
    template <class Step>
    bool run(Step step) {
        if (setjmp(png_jmpbuf(png_))) return false;  // NOLINT(cert-err52-cpp): libpng's way
        step(png_, info_);
        return true;
    }
    const char* complaint() const { return complaint_.text.data(); }
    png_structp png() const { return png_; }
    png_infop info() const { return info_; }

private:
    InputFile file_;
    Complaint complaint_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

struct Texts {
    png_textp first = nullptr;
    int count = 0;
};

Texts texts_of(const Reader& reader) {
    Texts texts;
    texts.count = png_get_text(reader.png(), reader.info(), &texts.first, nullptr);
    return texts;
}

/// Whether there is XMP, or EXIF as a text: OpenImageIO knows their tags.
bool is_special(const Reader& reader) {
    const Texts texts = texts_of(reader);
    for (int i = 0; i < texts.count; ++i) {
        const std::string_view key = texts.first[i].key;
        if (key == "XML:com.adobe.xmp" || key == "Raw profile type exif") return true;
    }
    return false;
}

Exif exif_of(const Reader& reader) {
    png_bytep data = nullptr;
    png_uint_32 length = 0;
    if (!png_get_eXIf_1(reader.png(), reader.info(), &length, &data)) return {};
    return read_exif({reinterpret_cast<const std::byte*>(data), length});
}

/// Texts under the names that OpenImageIO gives them.
Metadata metadata_of(const Reader& reader) {
    constexpr std::size_t kMostText = 64 * 1024;  // larger ones are profiles and the like
    Metadata metadata;
    png_timep time = nullptr;
    if (png_get_tIME(reader.png(), reader.info(), &time))
        metadata.set("DateTime",
                     fmt::format("{:4d}:{:02d}:{:02d} {:02d}:{:02d}:{:02d}", time->year,
                                 time->month, time->day, time->hour, time->minute, time->second));
    const Texts texts = texts_of(reader);
    for (int i = 0; i < texts.count; ++i) {
        const std::string_view key = texts.first[i].key;
        std::string text = texts.first[i].text;
        if (key == "Orientation" || text.size() > kMostText) continue;
        const std::string_view name = key == "Description" ? "ImageDescription"
                                      : key == "Author"    ? "Artist"
                                      : key == "Title"     ? "DocumentName"
                                                           : key;
        metadata.set(std::string(name), std::move(text));
    }
    return metadata;
}

ColorTag color_tag_of(const Reader& reader, const FileProbe& probe) {
    ColorTag tag;
    png_charp name = nullptr;
    int compression = 0;
    png_bytep profile = nullptr;
    png_uint_32 length = 0;
    if (png_get_iCCP(reader.png(), reader.info(), &name, &compression, &profile, &length))
        tag.space = icc_description({reinterpret_cast<const std::byte*>(profile), length});
    if (tag.space.empty() && png_says_srgb(probe.head)) tag.space = "sRGB";
    return tag;
}

/// The header, and how rows shall come: 8 or 16 bits in our byte order, palettes and fewer bits
/// expanded, a transparent colour as alpha.
bool read_info(Reader& reader) {
    return reader.run([](png_structp png, png_infop info) {
        png_read_info(png, info);
        png_set_expand(png);
        if constexpr (std::endian::native == std::endian::little) png_set_swap(png);
        png_set_interlace_handling(png);
        png_read_update_info(png, info);
    });
}

Photo describe(const std::string& path, const FileProbe& probe, const Reader& reader,
               const Exif& exif) {
    Photo photo;
    photo.name = path;
    photo.display = {static_cast<int>(png_get_image_width(reader.png(), reader.info())),
                     static_cast<int>(png_get_image_height(reader.png(), reader.info()))};
    photo.window = {0, 0, photo.display};
    photo.type =
        png_get_bit_depth(reader.png(), reader.info()) == 16 ? PixelType::u16 : PixelType::u8;
    photo.channels = png_get_channels(reader.png(), reader.info());
    photo.associated_alpha = false;
    photo.color = color_tag_of(reader, probe);
    if (photo.color.space.empty() && exif.srgb) photo.color.space = "sRGB";
    photo.metadata = exif.metadata;
    const Metadata texts = metadata_of(reader);
    for (const Attribute& text : texts.all()) photo.metadata.set(text);
    return photo;
}

bool interlaced(const Reader& reader) {
    return png_get_interlace_type(reader.png(), reader.info()) != PNG_INTERLACE_NONE;
}

/// The next rows.
bool read_rows(Reader& reader, int count, std::size_t row_bytes, std::byte* out) {
    return reader.run([=](png_structp png, png_infop) {
        for (int y = 0; y < count; ++y)
            png_read_row(png,
                         reinterpret_cast<png_bytep>(out + static_cast<std::size_t>(y) * row_bytes),
                         nullptr);
    });
}

/// Rows above the wanted ones have to be decoded, too, those below have not.
bool skip_rows(Reader& reader, int count, std::size_t row_bytes) {
    std::vector<std::byte> unwanted(row_bytes);
    for (int y = 0; y < count; ++y)
        if (!read_rows(reader, 1, row_bytes, unwanted.data())) return false;
    return true;
}

/// The same where rows come in several passes over the whole picture.
bool read_interlaced(Reader& reader, int height, int first, int last, std::size_t row_bytes,
                     PixelBytes& out) {
    std::vector<std::byte> whole(static_cast<std::size_t>(height) * row_bytes);
    std::vector<png_bytep> rows;
    for (int y = 0; y < height; ++y)
        rows.push_back(
            reinterpret_cast<png_bytep>(whole.data() + static_cast<std::size_t>(y) * row_bytes));
    png_bytepp pointers = rows.data();
    const bool good =
        reader.run([=](png_structp png, png_infop) { png_read_image(png, pointers); });
    const auto at = [&](int y) { return whole.begin() + std::ssize(whole) / height * y; };
    out.assign(at(first), at(last));
    return good;
}

Error damaged(const Reader& reader, const Photo& photo) {
    return failure(photo.name, fmt::format("truncated or damaged: {}; copy or export it again",
                                           reader.complaint()));
}

void read_pixels(Reader& reader, Photo& photo) {
    const int first = photo.window.y, last = first + photo.window.size.height;
    const std::size_t row_bytes = png_get_rowbytes(reader.png(), reader.info());
    photo.pixels.resize(static_cast<std::size_t>(last - first) * row_bytes);
    const bool good =
        interlaced(reader)
            ? read_interlaced(reader, photo.display.height, first, last, row_bytes, photo.pixels)
            : skip_rows(reader, first, row_bytes) &&
                  read_rows(reader, last - first, row_bytes, photo.pixels.data());
    if (!good) throw damaged(reader, photo);
}

void read_bands(Reader& reader, const Photo& photo,
                const std::function<void(const Photo& band)>& take) {
    const std::size_t row_bytes = png_get_rowbytes(reader.png(), reader.info());
    if (!skip_rows(reader, photo.window.y, row_bytes)) throw damaged(reader, photo);
    const int last = photo.window.y + photo.window.size.height;
    for (int y = photo.window.y; y < last; y += kBandRows) {
        Photo band = band_of(photo, y, std::min(last, y + kBandRows));
        if (!read_rows(reader, band.window.size.height, row_bytes, band.pixels.data()))
            throw damaged(reader, photo);
        take(band);
    }
}

}  // namespace

std::optional<Photo> decode_png(const std::string& path, const FileProbe& probe,
                                const DecodeRequest& request) {
    if (const auto claimed = claimed_size(probe))
        check_size(path, claimed->first, claimed->second, request.max_pixels);
    if (!request.header_only) check_png_is_whole(path);
    Reader reader(path);
    if (!read_info(reader))
        throw failure(path, fmt::format("cannot be read as png: {}; damaged or truncated: copy or "
                                        "export it again",
                                        reader.complaint()));
    if (is_special(reader)) return std::nullopt;
    const Exif exif = exif_of(reader);
    Photo photo = describe(path, probe, reader, exif);
    const auto rows = stored_rows(request.rows, exif.orientation, photo.display.height);
    const auto [first, last] = wanted_rows(photo.window, rows);
    photo.window.y = first;
    photo.window.size.height = last - first;
    if (!request.header_only && first < last) {
        const bool upright = exif.orientation == 1 && !interlaced(reader);
        if (request.bands && upright) {
            read_bands(reader, photo, request.bands);
            return photo;
        }
        read_pixels(reader, photo);
    }
    make_upright(photo, exif.orientation);
    return photo;
}

}  // namespace chromeball::io
