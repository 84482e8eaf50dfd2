#include <gtest/gtest.h>

#include "io/files.h"
#include "io/read.h"
#include "io/write.h"

namespace chromeball {
namespace {

using namespace std::string_literals;
using test::message_of;
using test::pattern;
using test::TempFolder;

class BadInput : public testing::Test {
protected:
    /// What reading a file with these bytes says; it must be one line that names the file.
    std::string message(const std::string& name, const std::string& bytes) {
        test::write_bytes(folder / name, bytes);
        return checked(name, {});
    }
    std::string checked(const std::string& name, const ReadOptions& options) {
        const std::string file = folder / name;
        const std::string text = message_of([&] { read_photo(file, options); });
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        EXPECT_TRUE(text == "no error" || text.starts_with(file + ": ")) << text;
        return text == "no error" ? text : text.substr(file.size() + 2);
    }
    std::string picture(FileFormat format, Size size = {64, 48}) {
        WriteOptions options;
        options.format = format;
        write_image(folder / "good", pattern(size, 3).view(), options);
        return test::read_bytes(folder / "good");
    }
    TempFolder folder;
};

TEST_F(BadInput, AMissingFileIsSaidToBeMissing) {
    EXPECT_EQ(checked("none.jpg", {}), "no such file; check the path");
    EXPECT_EQ(message_of([] { read_photo(""); }), ": no such file; check the path");
}

TEST_F(BadInput, AFolderIsNoPicture) {
    std::filesystem::create_directory(folder / "x.exr");
    EXPECT_EQ(checked("x.exr", {}), "is a folder; give a picture file");
    EXPECT_EQ(message_of([&] { read_header("/dev/null"); }),
              "/dev/null: is not a regular file; give a picture file");
}

TEST_F(BadInput, AnEmptyFileIsSaidToBeEmpty) {
    EXPECT_EQ(message("x.jpg", ""), "is empty (0 bytes); copy or export it again");
}

TEST_F(BadInput, TextUnderAPicturesNameIsFoundOut) {
    EXPECT_EQ(message("x.exr", "Dear all,\nhere is the picture.\n"),
              "not an OpenEXR file although it is named so: its content is plain text; give an "
              "EXR, JPEG, PNG, TIFF, HDR, DPX or camera RAW file");
    EXPECT_EQ(message("x.jpg", "hello"),
              "not a picture: its content is plain text; give an EXR, JPEG, PNG, TIFF, HDR, DPX or "
              "camera RAW file");
    EXPECT_NE(message("x.mov",
                      "\0\0\0\x14"
                      "ftypqt  \0\0\0\0"s)
                  .find("movie"),
              std::string::npos);
    EXPECT_NE(message("x", "\x01\x02\x03\x04"s).find("no known picture type"), std::string::npos);
    for (const char* name : {"x.tga", "x.dng", "x.nef", "x.cr2", "x.pic", "x.rla"})
        EXPECT_NE(message(name, "neither one nor the other, but long enough to be looked into"),
                  "no error");
}

TEST_F(BadInput, ATruncatedFileIsRefusedWhereverItEnds) {
    for (const auto format :
         {FileFormat::exr, FileFormat::hdr, FileFormat::tif, FileFormat::png, FileFormat::jpg}) {
        const std::string bytes = picture(format);
        for (const double part : {0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98}) {
            const auto length = static_cast<std::size_t>(part * static_cast<double>(bytes.size()));
            EXPECT_NE(message("x", bytes.substr(0, std::max<std::size_t>(length, 4))), "no error")
                << extension_of(format) << ' ' << part;
        }
        EXPECT_EQ(message("x", bytes), "no error");
    }
}

TEST_F(BadInput, EvenTheLastBytesOfAJpegAreMissed) {
    const std::string bytes = picture(FileFormat::jpg);
    for (const std::size_t missing : {1, 2, 3, 10})
        EXPECT_EQ(message("x.jpg", bytes.substr(0, bytes.size() - missing)),
                  "truncated: the JPEG data ends early; copy or export it again");
    EXPECT_EQ(message("x.jpg", bytes + "appended by a phone"), "no error");
}

TEST_F(BadInput, AnUnfinishedExrIsCalledTruncated) {
    // As a crashed renderer leaves it: later rows' places in the table of contents are still 0.
    std::string bytes = picture(FileFormat::exr);
    const std::size_t blocks = 2;  // of 32 rows each
    const auto header_end = bytes.find("screenWindowWidth");
    ASSERT_NE(header_end, std::string::npos);
    // name 0 type 0 size(4) float(4), then the header's final 0, then the table
    const std::size_t table = bytes.find('\0', bytes.find("float", header_end)) + 1 + 8 + 1;
    ASSERT_LT(table + 8 * blocks, bytes.size());
    bytes.replace(table + 8, 8, 8, '\0');
    const auto second_block = bytes.size() / 2;
    bytes.resize(second_block);
    EXPECT_EQ(message("x.exr", bytes),
              "truncated: rows of pixels are missing; copy or render it again");
}

std::string little_endian(std::uint32_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i));
    return bytes;
}

std::string big_endian(std::uint32_t value) {
    const std::string bytes = little_endian(value);
    return {bytes.rbegin(), bytes.rend()};
}

const std::string kTooLarge =
    "100000x100000 pixels are more than the 400000000 allowed; raise --max-pixels";

TEST_F(BadInput, AClaimOfAHugeSizeIsRefusedInExr) {
    std::string bytes = picture(FileFormat::exr);
    const std::string window =
        little_endian(0) + little_endian(0) + little_endian(63) + little_endian(47);
    const std::string huge =
        little_endian(0) + little_endian(0) + little_endian(99999) + little_endian(99999);
    for (std::size_t at; (at = bytes.find(window)) != std::string::npos;)
        bytes.replace(at, window.size(), huge);
    EXPECT_EQ(message("big.exr", bytes), kTooLarge);
}

TEST_F(BadInput, AClaimOfAHugeSizeIsRefusedInPng) {
    std::string bytes = picture(FileFormat::png);
    bytes.replace(16, 8, big_endian(100000) + big_endian(100000));
    EXPECT_EQ(message("big.png", bytes), kTooLarge);
    bytes.replace(16, 8, big_endian(0x7fffffff) + big_endian(0x7fffffff));
    EXPECT_NE(message("big.png", bytes).find("raise --max-pixels"), std::string::npos);
    bytes.replace(16, 8, big_endian(0) + big_endian(0));
    EXPECT_NE(message("big.png", bytes), "no error");
}

TEST_F(BadInput, AClaimOfAHugeSizeIsRefusedInHdr) {
    EXPECT_EQ(message("big.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n"),
              kTooLarge);
}

TEST_F(BadInput, AClaimOfAHugeSizeIsRefusedInJpeg) {
    std::string bytes = picture(FileFormat::jpg);
    const auto frame = bytes.find("\xff\xc0"s);
    ASSERT_NE(frame, std::string::npos);
    bytes.replace(frame + 5, 4, "\xff\xff\xff\xff");
    EXPECT_EQ(message("big.jpg", bytes),
              "65535x65535 pixels are more than the 400000000 allowed; raise --max-pixels");
}

TEST_F(BadInput, AClaimOfAHugeSizeIsRefusedInTiff) {
    const auto entry = [](int tag, int type, std::uint32_t value) {
        return little_endian(static_cast<std::uint32_t>(tag | type << 16)) + little_endian(1) +
               little_endian(value);
    };
    const std::string bytes = "II*\0"s + little_endian(8) + "\x05\0"s + entry(256, 4, 100000) +
                              entry(257, 4, 100000) + entry(258, 3, 8) + entry(259, 3, 1) +
                              entry(262, 3, 1) + little_endian(0);
    EXPECT_EQ(message("big.tif", bytes), kTooLarge);
}

TEST_F(BadInput, TheLimitOnSizesIsTheCallers) {
    picture(FileFormat::exr, {20, 10});
    EXPECT_EQ(checked("good", {.max_pixels = 199}),
              "20x10 pixels are more than the 199 allowed; raise --max-pixels");
    EXPECT_EQ(checked("good", {.max_pixels = 200}), "no error");
    // Also where few rows are wanted, and for the header alone.
    EXPECT_NE(checked("good", {.max_pixels = 199, .rows = std::pair{0, 1}}), "no error");
    EXPECT_NE(message_of([&] { read_header(folder / "good", {.max_pixels = 199}); }), "no error");
}

TEST_F(BadInput, EveryErrorIsOfTheKindFailed) {
    for (const char* name : {"none", "text"}) {
        test::write_bytes(folder / "text", "text");
        try {
            read_photo(folder / name);
            FAIL();
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), Error::Kind::failed);
        }
    }
}

}  // namespace
}  // namespace chromeball
