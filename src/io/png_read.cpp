#include <fmt/format.h>
#include <png.h>

#include <array>
#include <bit>
#include <csetjmp>
#include <cstring>

#include "io/bytes.h"
#include "io/decoders.h"
#include "io/input_file.h"
#include "io/messages.h"

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

/// Whether there is EXIF or XMP, as a chunk or as a text: OpenImageIO knows their tags.
bool holds_exif(const Reader& reader) {
    if (png_get_valid(reader.png(), reader.info(), PNG_INFO_eXIf)) return true;
    const Texts texts = texts_of(reader);
    for (int i = 0; i < texts.count; ++i) {
        const std::string_view key = texts.first[i].key;
        if (key == "XML:com.adobe.xmp" || key == "Raw profile type exif") return true;
    }
    return false;
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

Photo describe(const std::string& path, const FileProbe& probe, const Reader& reader) {
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
    photo.metadata = metadata_of(reader);
    return photo;
}

/// Rows first to last; those above have to be decoded too, those below are not.
bool read_rows(Reader& reader, int first, int last, std::size_t row_bytes, std::byte* out) {
    std::vector<std::byte> skipped(first > 0 ? row_bytes : 0);
    png_bytep unwanted = reinterpret_cast<png_bytep>(skipped.data());
    return reader.run([=](png_structp png, png_infop) {
        for (int y = 0; y < first; ++y) png_read_row(png, unwanted, nullptr);
        for (int y = first; y < last; ++y)
            png_read_row(
                png,
                reinterpret_cast<png_bytep>(out + static_cast<std::size_t>(y - first) * row_bytes),
                nullptr);
    });
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

void read_pixels(Reader& reader, Photo& photo) {
    const int first = photo.window.y, last = first + photo.window.size.height;
    const std::size_t row_bytes = png_get_rowbytes(reader.png(), reader.info());
    const bool interlaced =
        png_get_interlace_type(reader.png(), reader.info()) != PNG_INTERLACE_NONE;
    photo.pixels.resize(static_cast<std::size_t>(last - first) * row_bytes);
    const bool good = interlaced ? read_interlaced(reader, photo.display.height, first, last,
                                                   row_bytes, photo.pixels)
                                 : read_rows(reader, first, last, row_bytes, photo.pixels.data());
    if (!good)
        throw failure(photo.name, fmt::format("truncated or damaged: {}; copy or export it again",
                                              reader.complaint()));
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
    if (holds_exif(reader)) return std::nullopt;
    Photo photo = describe(path, probe, reader);
    const auto [first, last] = wanted_rows(photo.window, request.rows);
    photo.window.y = first;
    photo.window.size.height = last - first;
    if (!request.header_only && first < last) read_pixels(reader, photo);
    return photo;
}

}  // namespace chromeball::io
