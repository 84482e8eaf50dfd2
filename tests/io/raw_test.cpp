#include <gtest/gtest.h>

#include <algorithm>

#include "io/facts.h"
#include "io/files.h"
#include "io/read.h"

namespace chromeball {
namespace {

using test::TempFolder;
using test::value_at;

/// A small TIFF writer, little endian: just enough for an uncompressed DNG.
class TinyTiff {
public:
    enum Type { kByte = 1, kText = 2, kShort = 3, kLong = 4, kRational = 5, kSignedRational = 10 };

    void add(int tag, Type type, std::size_t count, std::string bytes) {
        entries_.push_back({tag, type, count, std::move(bytes)});
    }
    void shorts(int tag, const std::vector<int>& values) {
        std::string bytes;
        for (const int v : values) bytes += number(static_cast<std::uint32_t>(v), 2);
        add(tag, kShort, values.size(), bytes);
    }
    void rationals(int tag, Type type, const std::vector<double>& values) {
        std::string bytes;
        for (const double v : values)
            bytes +=
                number(static_cast<std::uint32_t>(std::lround(v * 10000)), 4) + number(10000, 4);
        add(tag, type, values.size(), bytes);
    }
    void text(int tag, std::string value) {
        value += '\0';
        add(tag, kText, value.size(), value);
    }
    /// The file, its pixels at the end.
    std::string file(const std::string& pixels) {
        add(279, kLong, 1, number(static_cast<std::uint32_t>(pixels.size()), 4));
        add(273, kLong, 1, std::string(4, '\0'));
        std::ranges::sort(entries_, {}, &Entry::tag);
        const std::size_t data_at = 8 + 2 + 12 * entries_.size() + 4;
        std::size_t total = data_at;
        for (const Entry& e : entries_)
            if (e.bytes.size() > 4) total += e.bytes.size() + e.bytes.size() % 2;
        std::string directory = number(static_cast<std::uint32_t>(entries_.size()), 2);
        std::string data;
        for (Entry& e : entries_) {
            if (e.tag == 273) e.bytes = number(static_cast<std::uint32_t>(total), 4);
            directory += number(static_cast<std::uint32_t>(e.tag), 2) + number(e.type, 2) +
                         number(static_cast<std::uint32_t>(e.count), 4);
            std::string value = e.bytes;
            if (value.size() > 4) {
                directory += number(static_cast<std::uint32_t>(data_at + data.size()), 4);
                data += value + std::string(value.size() % 2, '\0');
            } else {
                value.resize(4);
                directory += value;
            }
        }
        return "II*" + std::string(1, '\0') + number(8, 4) + directory + number(0, 4) + data +
               pixels;
    }
    static std::string number(std::uint32_t value, int bytes) {
        std::string text;
        for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
        return text;
    }

private:
    struct Entry {
        int tag;
        Type type;
        std::size_t count;
        std::string bytes;
    };
    std::vector<Entry> entries_;
};

/// A Bayer picture of a sensor whose colours are linear Rec.709 already, with a bright left half.
std::string dng(int width, int height, double left, double right, int orientation = 1) {
    TinyTiff tiff;
    tiff.add(254, TinyTiff::kLong, 1, TinyTiff::number(0, 4));
    tiff.shorts(256, {width});
    tiff.shorts(257, {height});
    tiff.shorts(258, {16});
    tiff.shorts(259, {1});
    tiff.shorts(262, {32803});
    tiff.text(271, "Acme");
    tiff.text(272, "Test");
    tiff.shorts(274, {orientation});
    tiff.shorts(277, {1});
    tiff.shorts(278, {height});
    tiff.shorts(284, {1});
    tiff.shorts(33421, {2, 2});
    tiff.add(33422, TinyTiff::kByte, 4, std::string("\0\1\1\2", 4));
    tiff.rationals(37386, TinyTiff::kRational, {50});  // FocalLength
    tiff.add(50706, TinyTiff::kByte, 4, std::string("\1\4\0\0", 4));
    tiff.text(50708, "Acme Test");
    tiff.shorts(50714, {0});
    tiff.shorts(50717, {65535});
    // XYZ to linear Rec.709 under D65, IEC 61966-2-1.
    tiff.rationals(50721, TinyTiff::kSignedRational,
                   {3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570});
    tiff.rationals(50728, TinyTiff::kRational, {1, 1, 1});
    tiff.shorts(50778, {21});
    std::string pixels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            pixels += TinyTiff::number(
                static_cast<std::uint32_t>(65535 * (2 * x < width ? left : right)), 2);
    return tiff.file(pixels);
}

TEST(CameraRaw, ComesSceneLinearAndNotBrightened) {
    const TempFolder folder;
    test::write_bytes(folder / "x.dng", dng(64, 48, 0.4, 0.1));
    const Photo photo = read_photo(folder / "x.dng");
    EXPECT_EQ(photo.type, PixelType::u16);
    EXPECT_EQ(photo.channels, 3);
    EXPECT_EQ(photo.color.space, "lin_rec709");
    ASSERT_EQ(photo.display, (Size{64, 48}));
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(value_at(photo, 10, 20, c), 0.4, 0.01) << c;
        EXPECT_NEAR(value_at(photo, 54, 20, c), 0.1, 0.005) << c;
    }
    EXPECT_EQ(pass_through(photo.metadata).text("cameraMake"), "Acme");
    const Photo part = read_photo(folder / "x.dng", {.rows = std::pair{8, 12}});
    EXPECT_EQ(part.window, (Window{0, 8, {64, 4}}));
    EXPECT_NEAR(value_at(part, 10, 2, 1), 0.4, 0.01);
}

TEST(CameraRaw, IsTurnedUprightOnce) {
    const TempFolder folder;
    test::write_bytes(folder / "x.dng", dng(64, 48, 0.4, 0.1, 6));
    const Photo photo = read_photo(folder / "x.dng");
    ASSERT_EQ(photo.display, (Size{48, 64}));
    // Turned clockwise the left half is on top.
    EXPECT_NEAR(value_at(photo, 20, 10, 1), 0.4, 0.01);
    EXPECT_NEAR(value_at(photo, 20, 54, 1), 0.1, 0.005);
}

TEST(CameraRaw, TruncatedIsRefused) {
    const TempFolder folder;
    const std::string bytes = dng(64, 48, 0.4, 0.1);
    for (const double part : {0.1, 0.5, 0.9}) {
        test::write_bytes(
            folder / "x.dng",
            bytes.substr(0, static_cast<std::size_t>(part * static_cast<double>(bytes.size()))));
        EXPECT_NE(test::message_of([&] { read_photo(folder / "x.dng"); }), "no error") << part;
    }
}

}  // namespace
}  // namespace chromeball
