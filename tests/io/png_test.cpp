#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <random>

#include "core/parallel.h"
#include "io/facts.h"
#include "io/files.h"
#include "io/png_rows.h"
#include "io/read.h"
#include "io/write.h"

namespace chromeball {
namespace {

using test::TempFolder;
using test::value_at;
using Byte = std::uint8_t;

std::vector<Byte> noise(std::size_t count) {
    std::mt19937 random(7);
    std::vector<Byte> bytes(count);
    for (Byte& byte : bytes) byte = static_cast<Byte>(random());
    return bytes;
}

/// What zlib makes of a stream; empty when it finds fault.
std::vector<Byte> inflated(const io::Bytes& stream, std::size_t length) {
    std::vector<Byte> out(length + 1);
    uLongf got = out.size();
    if (::uncompress(out.data(), &got, reinterpret_cast<const Bytef*>(stream.data()),
                     stream.size()) != Z_OK)
        return {};
    out.resize(got);
    return out;
}

io::Bytes joined(const std::vector<io::DeflatedPart>& parts) {
    io::Bytes stream = io::zlib_head();
    for (const io::DeflatedPart& part : parts)
        stream.insert(stream.end(), part.bytes.begin(), part.bytes.end());
    const io::Bytes tail = io::zlib_tail(parts);
    stream.insert(stream.end(), tail.begin(), tail.end());
    return stream;
}

TEST(DeflatedParts, OneBehindTheOtherAreOneStream) {
    const std::vector<Byte> random = noise(300'000);
    std::vector<Byte> even(300'000, 42);
    std::vector<Byte> pattern = random;
    for (std::size_t i = 5000; i < pattern.size(); ++i) pattern[i] = pattern[i - 5000];
    for (const auto& bytes : {random, even, pattern})
        for (const std::size_t length :
             {std::size_t{1}, std::size_t{777}, bytes.size() / 3, bytes.size() - 1, bytes.size()}) {
            std::vector<io::DeflatedPart> parts;
            for (std::size_t at = 0; at < bytes.size(); at += length) {
                if (length == 1 && at == 500) break;  // enough of the smallest
                const std::size_t count = std::min(length, bytes.size() - at);
                const bool last = at + count == bytes.size() || (length == 1 && at == 499);
                parts.push_back(
                    io::deflate_part(std::as_bytes(std::span(bytes)).subspan(at, count), last));
            }
            const std::size_t all = length == 1 ? 500 : bytes.size();
            const auto back = inflated(joined(parts), all);
            ASSERT_EQ(back.size(), all) << length;
            EXPECT_TRUE(std::equal(back.begin(), back.end(), bytes.begin())) << length;
        }
}

TEST(DeflatedParts, ShrinkWhatRepeatsAndHardlySwellNoise) {
    const std::vector<Byte> random = noise(500'000), even(500'000, 1);
    EXPECT_LT(io::deflate_part(std::as_bytes(std::span(even)), true).bytes.size(), 5000u);
    EXPECT_LT(io::deflate_part(std::as_bytes(std::span(random)), true).bytes.size(), 502'000u);
}

/// The row that a filtered one stands for, by the PNG specification's own words.
std::vector<Byte> unfiltered(const std::vector<std::byte>& filtered, const std::vector<Byte>& above,
                             std::size_t pixel) {
    const int filter = std::to_integer<int>(filtered[0]);
    std::vector<Byte> row(above.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
        const int a = i < pixel ? 0 : row[i - pixel], b = above[i],
                  c = i < pixel ? 0 : above[i - pixel];
        const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
        const int paeth = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
        const int guess = filter == 1 ? a : filter == 2 ? b : filter == 4 ? paeth : 1'000'000;
        EXPECT_LT(guess, 256) << "filter " << filter;
        row[i] = static_cast<Byte>(std::to_integer<int>(filtered[i + 1]) + guess);
    }
    return row;
}

/// Filters a row, checks that it can be undone, and gives the filter's number.
int filter_of(const std::vector<Byte>& row, const std::vector<Byte>& above, std::size_t pixel) {
    std::vector<std::byte> out(row.size() + 1);
    io::filter_row(std::as_bytes(std::span(row)), std::as_bytes(std::span(above)), pixel, out);
    EXPECT_EQ(unfiltered(out, above, pixel), row);
    return std::to_integer<int>(out[0]);
}

TEST(FilteredRows, CanBeUndoneForEveryWidthOfPixels) {
    const std::vector<Byte> random = noise(8192);
    for (std::size_t pixel = 1; pixel <= 8; ++pixel)
        for (const std::size_t count : {1u, 2u, 3u, 31u, 200u}) {
            const auto row = random.begin() + 1000, above = random.begin() + 2700;
            const auto length = static_cast<std::ptrdiff_t>(pixel * count);
            filter_of({row, row + length}, {above, above + length}, pixel);
        }
}

TEST(FilteredRows, TakeTheFilterThatFits) {
    const std::vector<Byte> random = noise(300);
    std::vector<Byte> slope(300), bars(300), half_bars(300);
    for (std::size_t i = 0; i < 300; ++i) {
        slope[i] = static_cast<Byte>(i / 3 * 2);
        bars[i] = static_cast<Byte>(i % 30 < 15 ? 20 : 120);
        half_bars[i] = static_cast<Byte>(i < 150 ? bars[i] : 120);
    }
    EXPECT_EQ(filter_of(random, random, 3), 2);   // as above
    EXPECT_EQ(filter_of(slope, random, 3), 1);    // as on the left
    EXPECT_EQ(filter_of(half_bars, bars, 3), 4);  // as above, then as on the left
}

Image picture(Size size, int channels) {
    Image image(size, channels);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> grain(-0.02F, 0.02F);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            for (int c = 0; c < channels; ++c)
                image.pixel(x, y)[c] =
                    0.5F + 0.4F * std::sin(0.01F * static_cast<float>(x + y * c)) + grain(random);
    if (channels == 4)
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x) image.pixel(x, y)[3] = 1;
    return image;
}

WriteOptions png(int bits) {
    WriteOptions options;
    options.format = FileFormat::png;
    options.bits = bits;
    return options;
}

TEST(Png, OfManyBandsIsReadByOthersAsByUs) {
    const TempFolder folder;
    for (const int channels : {1, 3, 4})
        for (const int bits : {8, 16}) {
            const Image image = picture({700, 410}, channels);
            write_image(folder / "x.png", image.view(), png(bits));
            auto input = OIIO::ImageInput::open(folder / "x.png");
            ASSERT_TRUE(input) << OIIO::geterror();
            ASSERT_EQ(input->spec().nchannels, channels);
            ASSERT_EQ(input->spec().format,
                      bits == 8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
            std::vector<float> theirs(700 * 410 * static_cast<std::size_t>(channels));
            ASSERT_TRUE(input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, theirs.data()))
                << input->geterror();
            const Photo ours = read_photo(folder / "x.png");
            ASSERT_EQ(ours.channels, channels);
            const double step = bits == 8 ? 1.0 / 255 : 1.0 / 65535;
            std::size_t at = 0;
            for (int y = 0; y < 410; ++y)
                for (int x = 0; x < 700; ++x)
                    for (int c = 0; c < channels; ++c, ++at) {
                        ASSERT_NEAR(theirs[at], image.pixel(x, y)[c], 0.51 * step);
                        ASSERT_NEAR(value_at(ours, x, y, c), theirs[at], 1e-6);
                    }
        }
}

TEST(Png, IsTheSameFromAnyNumberOfThreads) {
    const TempFolder folder;
    const Image image = picture({900, 700}, 3);
    for (const int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        write_image(folder / (std::to_string(threads) + ".png"), image.view(), png(16));
    }
    EXPECT_TRUE(test::read_bytes(folder / "1.png") == test::read_bytes(folder / "3.png"));
}

TEST(Png, OfAWidthBeyondEveryScreenIsWrittenAndRead) {
    const TempFolder folder;
    Image image({300'000, 3}, 3);
    image.pixel(299'999, 2)[1] = 1;
    write_image(folder / "x.png", image.view(), png(16));
    EXPECT_EQ(value_at(read_photo(folder / "x.png"), 299'999, 2, 1), 1);
}

/// A picture as libpng itself writes it: `kind` with `bits`, rows of one value a byte.
void write_foreign(const std::string& path, Size size, int kind, int bits, bool interlaced,
                   const std::vector<Byte>& values, bool transparent = false,
                   const char* key = nullptr, const char* text = nullptr) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, static_cast<png_uint_32>(size.width),
                 static_cast<png_uint_32>(size.height), bits, kind,
                 interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
    const png_color palette[] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 9, 9}};
    if (kind == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 4);
    const png_byte alphas[] = {255, 0};
    if (transparent) png_set_tRNS(png, info, alphas, 2, nullptr);
    png_text words{};
    if (key) {
        words.compression = PNG_TEXT_COMPRESSION_NONE;
        words.key = const_cast<char*>(key);
        words.text = const_cast<char*>(text);
        png_set_text(png, info, &words, 1);
    }
    png_write_info(png, info);
    png_set_packing(png);
    const std::size_t row = values.size() / static_cast<std::size_t>(size.height);
    std::vector<png_bytep> rows;
    for (int y = 0; y < size.height; ++y)
        rows.push_back(const_cast<png_bytep>(values.data()) + row * static_cast<std::size_t>(y));
    png_write_image(png, rows.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
}

TEST(Png, InPassesIsReadWholeAndInPart) {
    const TempFolder folder;
    const auto values = noise(13 * 11 * 3);
    write_foreign(folder / "x.png", {13, 11}, PNG_COLOR_TYPE_RGB, 8, true, values);
    const Photo whole = read_photo(folder / "x.png");
    for (int i = 0; i < 13 * 11 * 3; ++i)
        ASSERT_NEAR(value_at(whole, i / 3 % 13, i / 39, i % 3) * 255,
                    values[static_cast<std::size_t>(i)], 1e-3);
    const Photo part = read_photo(folder / "x.png", {.rows = std::pair{4, 7}});
    ASSERT_EQ(part.window, (Window{0, 4, {13, 3}}));
    ASSERT_EQ(part.pixels.size(), 13u * 3 * 3);
    EXPECT_TRUE(
        std::equal(part.pixels.begin(), part.pixels.end(), whole.pixels.begin() + 4 * 13 * 3));
}

TEST(Png, PalettesAndFewBitsAreExpanded) {
    const TempFolder folder;
    const std::vector<Byte> values{0, 1, 2, 3, 2, 1};
    write_foreign(folder / "p.png", {3, 2}, PNG_COLOR_TYPE_PALETTE, 2, false, values, true);
    const Photo photo = read_photo(folder / "p.png");
    ASSERT_EQ(photo.channels, 4);
    EXPECT_FALSE(photo.associated_alpha);
    EXPECT_EQ(value_at(photo, 0, 0, 0), 1);
    EXPECT_EQ(value_at(photo, 0, 0, 3), 1);
    EXPECT_EQ(value_at(photo, 1, 0, 1), 1);
    EXPECT_EQ(value_at(photo, 1, 0, 3), 0);  // the transparent entry
    EXPECT_EQ(value_at(photo, 1, 1, 2), 1);
    write_foreign(folder / "g.png", {3, 2}, PNG_COLOR_TYPE_GRAY, 2, false, values);
    const Photo grey = read_photo(folder / "g.png");
    ASSERT_EQ(grey.channels, 1);
    EXPECT_EQ(value_at(grey, 0, 1, 0), 1);
    EXPECT_NEAR(value_at(grey, 1, 0, 0), 1.0 / 3, 1e-9);
}

TEST(Png, TextsAndExifAreFacts) {
    const TempFolder folder;
    const std::vector<Byte> values(12);
    write_foreign(folder / "t.png", {2, 2}, PNG_COLOR_TYPE_RGB, 8, false, values, false, "Author",
                  "Ada");
    EXPECT_EQ(read_header(folder / "t.png").metadata.text("Artist"), "Ada");
    // "Exif", then a TIFF with one entry: Make is "Ada".
    constexpr char kExif[] =
        "\nexif\n      32\n"
        "457869660000"
        "49492a0008000000"
        "0100"
        "0f01"
        "0200"
        "04000000"
        "41646100"
        "00000000\n";
    write_foreign(folder / "e.png", {2, 2}, PNG_COLOR_TYPE_RGB, 8, false, values, false,
                  "Raw profile type exif", kExif);
    const Photo photo = read_photo(folder / "e.png");
    EXPECT_EQ(pass_through(photo.metadata).text("cameraMake"), "Ada");
    EXPECT_EQ(photo.pixels.size(), 12u);
}

TEST(Png, RowsBelowTheWantedOnesAreNotDecoded) {
    const TempFolder folder;
    write_image(folder / "x.png", picture({1200, 600}, 3).view(), png(16));
    std::string bytes = test::read_bytes(folder / "x.png");
    const Photo whole = read_photo(folder / "x.png");
    bytes[bytes.size() * 3 / 4] ^= 0x55;
    test::write_bytes(folder / "x.png", bytes);
    const Photo top = read_photo(folder / "x.png", {.rows = std::pair{10, 300}});
    EXPECT_TRUE(
        std::equal(top.pixels.begin(), top.pixels.end(), whole.pixels.begin() + 10 * 1200 * 6));
    EXPECT_NE(test::message_of([&] { read_photo(folder / "x.png"); }).find("damaged"),
              std::string::npos);
}

}  // namespace
}  // namespace chromeball
