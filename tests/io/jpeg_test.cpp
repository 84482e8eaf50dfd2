// JPEGs and PNGs with EXIF, which are read without OpenImageIO, against what that makes of them.
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <mutex>

#include "files.h"
#include "io/decoders.h"
#include "io/exif.h"
#include "io/facts.h"
#include "io/probe.h"
#include "io/read.h"

namespace chromeball {
namespace {

using test::TempFolder;

std::vector<std::uint8_t> grain(int width, int height, int channels) {
    std::vector<std::uint8_t> values(static_cast<std::size_t>(width * height * channels));
    std::uint32_t state = 1;
    for (auto& value : values) {
        state = state * 1664525U + 1013904223U;
        value = static_cast<std::uint8_t>(100 + (state >> 26));
    }
    return values;
}

/// A camera's JPEG: what OpenImageIO writes, without the XMP and the comment that it adds.
void write_camera_jpeg(const std::string& path, int channels, int orientation) {
    OIIO::ImageSpec spec(150, 200, channels, OIIO::TypeDesc::UINT8);
    spec.attribute("Make", "SONY");
    spec.attribute("Model", "ILCE-6400");
    spec.attribute("ExposureTime", 0.005F);
    spec.attribute("FNumber", 5.6F);
    spec.attribute("Orientation", orientation);
    spec.attribute("Exif:ColorSpace", 1);
    spec.attribute("Exif:FocalLength", 40.0F);
    spec.attribute("Exif:FocalLengthIn35mmFilm", 60);
    spec.attribute("Exif:PhotographicSensitivity", 400);
    spec.attribute("Exif:DateTimeOriginal", "2023:11:09 22:01:57");
    spec.attribute("Exif:LensModel", "E 18-135mm");
    spec.attribute("Exif:ExposureBiasValue", -0.7F);
    const auto output = OIIO::ImageOutput::create("jpeg");
    ASSERT_TRUE(output->open(path, spec));
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, grain(150, 200, channels).data()));
    ASSERT_TRUE(output->close());
    std::string bytes = test::read_bytes(path), kept = bytes.substr(0, 2);
    for (std::size_t at = 2; at + 4 <= bytes.size();) {
        const auto marker = static_cast<unsigned char>(bytes[at + 1]);
        const std::size_t length = 2 + 256 * static_cast<unsigned char>(bytes[at + 2]) +
                                   static_cast<unsigned char>(bytes[at + 3]);
        const bool exif = bytes.compare(at + 4, 4, "Exif") == 0;
        if (marker == 0xda) {
            kept += bytes.substr(at);
            break;
        }
        if ((marker != 0xe1 || exif) && marker != 0xfe && marker != 0xed)
            kept += bytes.substr(at, length);
        at += length;
    }
    test::write_bytes(path, kept);
}

Photo with_oiio(const std::string& path, io::DecodeRequest request) {
    request.max_pixels = 1'000'000;
    return io::decode_with_oiio(path, io::probe_file(path), request);
}

std::optional<Photo> without(const std::string& path, io::DecodeRequest request) {
    request.max_pixels = 1'000'000;
    return io::decode_jpeg(path, io::probe_file(path), request);
}

void expect_same(const Photo& one, const Photo& other) {
    EXPECT_EQ(one.type, other.type);
    EXPECT_EQ(one.channels, other.channels);
    EXPECT_EQ(one.window, other.window);
    EXPECT_EQ(one.display, other.display);
    EXPECT_EQ(one.color.space, other.color.space);
    EXPECT_TRUE(one.pixels == other.pixels);
    EXPECT_EQ(pass_through(one.metadata).all(), pass_through(other.metadata).all());
    for (const Attribute& fact : one.metadata.all()) {
        const Attribute* same = other.metadata.find(fact.name);
        ASSERT_TRUE(same) << fact.name;
        EXPECT_EQ(*same, fact) << fact.name;
    }
}

TEST(Jpeg, IsWhatOpenImageIOMakesOfIt) {
    const TempFolder folder;
    const std::string path = folder / "x.jpg";
    for (const int channels : {1, 3})
        for (int orientation = 1; orientation <= 8; ++orientation) {
            write_camera_jpeg(path, channels, orientation);
            for (const bool header_only : {true, false})
                for (const auto& rows : {std::optional<std::pair<int, int>>(), {{17, 93}}}) {
                    const io::DecodeRequest request{0, rows, header_only, nullptr};
                    const auto photo = without(path, request);
                    ASSERT_TRUE(photo);
                    expect_same(*photo, with_oiio(path, request));
                }
            const auto header = without(path, {0, {}, true, nullptr});
            EXPECT_EQ(header->metadata.text("Make"), "SONY");
            EXPECT_EQ(header->metadata.number("Exif:FocalLength"), 40);
            EXPECT_EQ(header->color.space, "sRGB");
        }
}

TEST(Jpeg, ComesInBandsThatAreThePicture) {
    const TempFolder folder;
    const std::string path = folder / "x.jpg";
    write_camera_jpeg(path, 3, 1);
    const Photo whole = read_photo(path, {.rows = {{30, 190}}});
    PixelBytes pixels(whole.pixels.size());
    int bands = 0;
    std::mutex lock;
    const Photo rest = read_photo(
        path, {.rows = {{30, 190}}, .bands = [&](const Photo& band) {
                   const std::lock_guard guard(lock);
                   ++bands;
                   EXPECT_FALSE(band.metadata.find("Make"));
                   const std::size_t row = static_cast<std::size_t>(band.window.size.width) * 3;
                   std::copy(
                       band.pixels.begin(), band.pixels.end(),
                       pixels.begin() + static_cast<std::ptrdiff_t>(
                                            static_cast<std::size_t>(band.window.y - 30) * row));
               }});
    EXPECT_GT(bands, 1);
    EXPECT_TRUE(rest.pixels.empty());
    EXPECT_TRUE(pixels == whole.pixels);
}

TEST(Jpeg, WithAPieceMissingIsCalledDamaged) {
    const TempFolder folder;
    const std::string path = folder / "x.jpg";
    write_camera_jpeg(path, 3, 1);
    EXPECT_EQ(read_photo(path).damage, "");
    EXPECT_EQ(read_photo(path, {.rows = {{30, 90}}}).damage, "");
    std::string bytes = test::read_bytes(path);
    test::write_bytes(path, bytes.erase(bytes.size() / 2, bytes.size() / 4));
    EXPECT_NE(read_photo(path).damage, "");
    // Whichever rows are wanted, at once or in bands.
    EXPECT_NE(read_photo(path, {.rows = {{30, 90}}}).damage, "");
    EXPECT_NE(read_photo(path, {.rows = {{30, 90}}, .bands = [](const Photo&) {}}).damage, "");
    EXPECT_EQ(read_header(path).damage, "");
}

TEST(Jpeg, WithMoreThanExifIsLeftToOpenImageIO) {
    const TempFolder folder;
    const std::string path = folder / "x.jpg";
    write_camera_jpeg(path, 3, 1);
    std::string bytes = test::read_bytes(path);
    bytes.insert(2, std::string("\xff\xfe\0\x07hello", 9));
    test::write_bytes(path, bytes);
    EXPECT_FALSE(without(path, {0, {}, true, nullptr}));
    EXPECT_EQ(read_header(path).metadata.text("ImageDescription"), "hello");
}

TEST(Exif, DamagedIsLeftOut) {
    const TempFolder folder;
    const std::string path = folder / "x.jpg";
    write_camera_jpeg(path, 3, 6);
    const std::string bytes = test::read_bytes(path);
    const std::size_t at = bytes.find("Exif") + 6;
    const std::string tiff = bytes.substr(at, 400);
    const auto all = std::as_bytes(std::span(tiff));
    EXPECT_EQ(io::read_exif(all).orientation, 6);
    for (std::size_t length = 0; length < all.size(); ++length) io::read_exif(all.first(length));
    std::uint32_t state = 7;
    for (int i = 0; i < 3000; ++i) {
        std::string broken = tiff;
        for (int k = 0; k < 4; ++k) {
            state = state * 1664525U + 1013904223U;
            broken[(state >> 8) % broken.size()] = static_cast<char>(state >> 24);
        }
        const io::Exif exif = io::read_exif(std::as_bytes(std::span(broken)));
        EXPECT_GE(exif.orientation, 1);
        EXPECT_LE(exif.orientation, 8);
    }
}

}  // namespace
}  // namespace chromeball
